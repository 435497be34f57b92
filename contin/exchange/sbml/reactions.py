"""Reactions: their rates, and what they add to the rates of change of amounts."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from contin.exchange.sbml import mathml
from contin.exchange.sbml.elements import Element
from contin.exchange.sbml.roles import REACTIONS
from contin.exchange.sbml.symbols import Symbols

Rate = Callable[[Mapping[str, str], str], str]
"""(names of symbols, time) -> the formula of a reaction's rate."""


def rates_of(
    model: Element, symbols: Symbols, functions: Mapping[str, Element], where: str
) -> tuple[dict[str, Rate], dict[str, str]]:
    """The rate of each reaction that has one, and the values of local parameters under names of their own."""
    rates: dict[str, Rate] = {}
    local: dict[str, str] = {}
    for reaction in model.getListOfReactions():
        law = reaction.getKineticLaw()
        identifier = reaction.getIdAttribute() or reaction.getId()
        if law is None or not law.isSetMath():
            continue
        own = {}
        for parameter in law.getListOfParameters() if symbols.level < 3 else law.getListOfLocalParameters():
            key = parameter.getIdAttribute() or parameter.getId()
            own[key] = symbols.names.take(f"{identifier}_{key}")
            local[own[key]] = mathml.literal(parameter.getValue() if parameter.isSetValue() else float("nan"))
        rates[identifier] = _rate(law.getMath(), own, functions, f"{where}, reaction {identifier}")
    return rates, local


def _rate(math: Element, own: Mapping[str, str], functions: Mapping[str, Element], where: str) -> Rate:
    def formula(names: Mapping[str, str], time: str) -> str:
        return mathml.number(math, mathml.Scope(_Over(own, names), functions, time, where))

    return formula


class _Over(dict[str, str]):
    """Names of a reaction's own parameters over those of the model."""

    def __init__(self, own: Mapping[str, str], names: Mapping[str, str]) -> None:
        super().__init__(own)
        self.names = names

    def __contains__(self, key: object) -> bool:
        return super().__contains__(key) or key in self.names

    def __missing__(self, key: str) -> str:
        return self.names[key]


def changes(
    model: Element, symbols: Symbols, functions: Mapping[str, Element], names: Mapping[str, str],
    named: Mapping[str, str], where: str,
) -> dict[str, list[str]]:  # fmt: skip
    """Species -> the terms of the rate of change of its amount; `named`: what stands for the rate of a reaction."""
    terms: dict[str, list[str]] = {}
    for reaction in model.getListOfReactions():
        rate = named.get(reaction.getIdAttribute() or reaction.getId())
        if rate is None:
            continue
        scope = mathml.Scope(names, functions, where=f"{where}, reaction {reaction.getId()}")
        sides = (("-", reaction.getListOfReactants()), ("", reaction.getListOfProducts()))
        for sign, references in sides:
            for reference in references:
                symbol = symbols.of.get(reference.getSpecies())
                if symbol is not None and symbol.role == REACTIONS:
                    factor = _stoichiometry(reference, symbols, scope)
                    terms.setdefault(symbol.id, []).append(f"({sign}{factor}*{rate})")
    return terms


def _stoichiometry(reference: Element, symbols: Symbols, scope: mathml.Scope) -> str:
    if symbols.level >= 3:
        if reference.isSetIdAttribute():
            return symbols.of[reference.getIdAttribute()].name
        return mathml.literal(reference.getStoichiometry())
    if reference.isSetStoichiometryMath() and reference.getStoichiometryMath().isSetMath():
        return mathml.number(reference.getStoichiometryMath().getMath(), scope)
    value = mathml.literal(reference.getStoichiometry())
    return f"({value}/{reference.getDenominator()})" if reference.getDenominator() != 1 else value


def conversion(model: Element, species: Element, symbols: Symbols) -> str | None:
    """The name of the factor from extent to the species' amount, of level 3."""
    if symbols.level < 3:
        return None
    key = species.getConversionFactor() if species.isSetConversionFactor() else model.getConversionFactor()
    return symbols.of[key].name if key else None
