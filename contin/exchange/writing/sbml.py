"""Flows as SBML (level 3, version 2): rate rules for states, assignment rules for definitions and observables."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

import libsbml

from contin.errors import InputError
from contin.exchange.imported import Exported
from contin.exchange.writing.language import SBML
from contin.exchange.writing.names import ForeignNames
from contin.exchange.writing.parts import checked, values, without_mass, written

if TYPE_CHECKING:
    from contin.model.model import Model

_VALUE: Final = re.compile(r'(<parameter id="(\w+)" value=")[^"]*(")')
_RESERVED: Final = frozenset(
    "time avogadro pi exponentiale true false infinity notanumber delay rateOf piecewise and or not xor pow exp ln log "
    "log10 sqrt root abs floor ceil ceiling factorial sin cos tan sec csc cot sinh cosh tanh asin acos atan arcsin "
    "arccos arctan arcsinh arccosh arctanh acosh asinh atanh min max rem quotient implies lambda inf nan".split()
)


def write(model: Model) -> Exported:
    """The SBML document of a flow."""
    model, _ = without_mass(model, "SBML")
    notes = checked(model, ("flow",), "SBML")
    names = ForeignNames(_RESERVED)
    symbols = {**names.all(model.state_names), **names.all(model.parameter_names), "t": "time"}
    observed = names.all(model.observables)

    def defined(name: str) -> str:
        """A definition that is observed under its own name is one rule."""
        same = name in observed and model.observables[name] is model.definitions[name]
        return observed[name] if same else names.take(name, quiet=True)

    text = written(model, SBML, symbols, defined, None)
    numbers = values(model)
    document = libsbml.SBMLDocument(3, 2)
    target = document.createModel()
    target.setId(names.take(model.name, quiet=True))
    if model.title:
        target.setName(model.title)
    for name, value in numbers.parameters.items():
        _quantity(target, symbols[name], value, constant=True)
    for name, value in numbers.states.items():
        _quantity(target, symbols[name], value, constant=False)
    rules = dict(text.before)
    rules.update((observed[name], formula) for name, formula in text.observables.items() if observed[name] not in rules)
    for name, formula in rules.items():
        _quantity(target, name, None, constant=False)
        _rule(target.createAssignmentRule(), name, formula)
    for name, formula in zip(model.state_names, text.equations, strict=True):
        _rule(target.createRateRule(), symbols[name], formula)
    exact = {symbols[name]: value for name, value in {**numbers.parameters, **numbers.states}.items()}
    return Exported(_with_digits(libsbml.writeSBMLToString(document), exact), (*notes, *names.notes))


def _with_digits(text: str, exact: Mapping[str, float]) -> str:
    """libSBML writes 15 digits of a value; here are all that make the double."""
    return _VALUE.sub(lambda found: f"{found[1]}{exact[found[2]]!r}{found[3]}", text)


def _quantity(target: libsbml.Model, name: str, value: float | None, *, constant: bool) -> None:
    found = target.createParameter()
    found.setId(name)
    found.setConstant(constant)
    if value is not None:
        found.setValue(value)


def _rule(rule: libsbml.Rule, name: str, formula: str) -> None:
    math = libsbml.parseL3Formula(formula)
    if math is None:
        raise InputError(f"libSBML does not read {formula[:80]}: {libsbml.getLastParseL3Error()}")
    rule.setVariable(name)
    rule.setMath(math)
