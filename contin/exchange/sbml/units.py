"""Units of SBML as labels: they are shown, never computed with."""

from __future__ import annotations

from typing import Final

import libsbml

from contin.exchange.sbml.elements import Element

_SHORT: Final = {"litre": "L", "liter": "L", "metre": "m", "meter": "m", "second": "s", "mole": "mol", "gram": "g",
    "kilogram": "kg", "item": "items", "dimensionless": "1", "kelvin": "K"}  # fmt: skip
_PREFIX: Final = {-15: "f", -12: "p", -9: "n", -6: "u", -3: "m", 0: "", 3: "k", 6: "M"}


def unit_of(model: Element, element: Element) -> str | None:
    """The unit of a parameter, a compartment or a species (of its amount), as text; None where none is given."""
    get = getattr(element, "getSubstanceUnits", None) or getattr(element, "getUnits", None)
    name = "" if get is None else str(get())
    if not name:
        return None
    definition = model.getUnitDefinition(name)
    if definition is None:
        return _SHORT.get(name, name)
    return "*".join(_factor(unit) for unit in definition.getListOfUnits()) or None


def _factor(unit: Element) -> str:
    kind = libsbml.UnitKind_toString(unit.getKind())
    text, scale = _SHORT.get(kind, kind), unit.getScale()
    multiplier, exponent = unit.getMultiplier(), unit.getExponentAsDouble()
    text = f"{_PREFIX[scale]}{text}" if scale in _PREFIX else f"10^{scale}*{text}"
    text = text if multiplier == 1 else f"({multiplier:g}*{text})"
    return text if exponent == 1 else f"{text}^{exponent:g}"
