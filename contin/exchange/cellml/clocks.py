"""The unit in which each component of a CellML model measures time, which Myokit does not convert in derivatives."""

from __future__ import annotations

from typing import Final

from contin.exchange.cellml.library import myokit, v1, v2
from contin.exchange.formulas.parser import FormulaError

_SAME: Final = 1e-12


def clocks(model: v1.Model | v2.Model, version: int) -> dict[str, float]:
    """By component: units of its own time in one unit of the model's time; d/dt is d/d(own time) times that."""
    free = model.variable_of_integration() if version == 2 else model.free_variable()
    if free is None:
        return {}
    found: dict[str, float] = {}
    for component in model:
        for variable in component:
            source = variable if variable is free or version == 2 else variable.value_source()
            if not (source is free if version == 1 else variable.is_free()):
                continue
            factor = _factor(free, variable)
            if abs(found.setdefault(component.name(), factor) - factor) > _SAME * factor:
                raise FormulaError(f"component {component.name()} measures time in two units")
    return found


def _factor(free: v1.Variable | v2.Variable, variable: v1.Variable | v2.Variable) -> float:
    try:
        factor = myokit.Unit.conversion_factor(free.units().myokit_unit(), variable.units().myokit_unit())
    except myokit.IncompatibleUnitError as error:
        raise FormulaError(f"time in {variable.component().name()}: {error}") from None
    return float(factor.value())


def unit_names(model: v1.Model | v2.Model) -> dict[str, str]:
    """What the file calls the unit of each variable, by component.variable; not of those without a unit."""
    named = {f"{c.name()}.{v.name()}": v.units().name() for c in model for v in c}
    return {key: str(name) for key, name in named.items() if name and name != "dimensionless"}
