"""The identifiers of an SBML model that have a value: what each is, and what determines it.

Roles: `rule` (an assignment rule holds always), `rate` (a rate rule), `reactions` (a species that reactions change),
`events` (nothing but these), `fixed` (nothing changes it). A species' value is its amount where it has only substance
units or its compartment has no extent, else its concentration; reactions and conversions work on amounts, amount =
concentration * size.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from contin.exchange.naming import Names
from contin.exchange.sbml.elements import Element, assigned
from contin.exchange.sbml.roles import EVENTS, FIXED, RATE, REACTIONS, RULE


@dataclass(frozen=True)
class Symbol:
    """One identifier; `element` is libsbml's, `math` that of its rule, `initial` that of its initial assignment."""

    id: str
    kind: str  # species, compartment, parameter, reference
    name: str
    role: str
    element: Element
    math: Element = None
    initial: Element = None


@dataclass(frozen=True)
class Symbols:
    """All symbols by identifier, and the names of reactions."""

    of: Mapping[str, Symbol]
    reactions: Mapping[str, str]
    names: Names
    level: int

    def is_amount(self, species: Element) -> bool:
        """True where the species' identifier stands for its amount."""
        if species.getHasOnlySubstanceUnits() or self.level == 1:
            return bool(species.getHasOnlySubstanceUnits())
        return self.without_extent(species.getCompartment())

    def without_extent(self, compartment: str) -> bool:
        """True for a compartment without dimensions and size: what is in it has an amount only."""
        element = self.of[compartment].element
        return bool(element.getSpatialDimensionsAsDouble() == 0 and not element.isSetSize())

    def size_is_fixed(self, species: Element) -> bool:
        """True where the size of the species' compartment does not change."""
        return self.of[species.getCompartment()].role == FIXED


def symbols_of(model: Element, notes: list[str]) -> Symbols:
    """The identifiers with values, each with a name of its own in the formulas."""
    level = model.getLevel()
    rules = {r.getVariable(): r for r in model.getListOfRules() if not r.isAlgebraic() and r.isSetMath()}
    initial = {a.getSymbol(): a.getMath() for a in model.getListOfInitialAssignments() if a.isSetMath()}
    changed, jumping = _changed(model), assigned(model)
    names = Names(notes)
    found = list(_elements(model, level))
    ids = [element_id for element_id, _, _ in found]
    reactions = [r.getIdAttribute() for r in model.getListOfReactions() if level > 1]
    given = {i: names.take(i) for i in [*ids, *reactions]}
    symbols = {}
    for element_id, kind, element in found:
        rule = rules.get(element_id)
        if rule is not None:
            role = RATE if rule.isRate() else RULE
        else:
            role = REACTIONS if element_id in changed else EVENTS if element_id in jumping else FIXED
        math = None if rule is None else rule.getMath()
        symbols[element_id] = Symbol(element_id, kind, given[element_id], role, element, math, initial.get(element_id))
    return Symbols(symbols, {r: given[r] for r in reactions}, names, level)


def _elements(model: Element, level: int) -> Iterator[tuple[str, str, Element]]:
    for kind, elements in (
        ("compartment", model.getListOfCompartments()),
        ("species", model.getListOfSpecies()),
        ("parameter", model.getListOfParameters()),
    ):
        for element in elements:
            yield element.getIdAttribute() or element.getId(), kind, element
    if level >= 3:
        for reaction in model.getListOfReactions():
            for reference in references(reaction):
                if reference.isSetIdAttribute():
                    yield reference.getIdAttribute(), "reference", reference


def references(reaction: Element) -> list[Element]:
    """Reactants, then products."""
    return [*reaction.getListOfReactants(), *reaction.getListOfProducts()]


def _changed(model: Element) -> set[str]:
    """Species that reactions change, where no rule determines them."""
    changed = set()
    for reaction in model.getListOfReactions():
        for reference in references(reaction):
            species = model.getSpecies(reference.getSpecies())
            if species is not None and not species.getBoundaryCondition() and not species.getConstant():
                changed.add(reference.getSpecies())
    return changed
