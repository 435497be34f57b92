"""Values at time 0: of each symbol, as a formula in the parameters.

Assignment rules hold then, initial assignments come before the values of attributes; both may use any other symbol, so
values are worked out in the order in which they need each other.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from contin.errors import InputError
from contin.exchange.sbml import mathml
from contin.exchange.sbml.elements import Element
from contin.exchange.sbml.reactions import Rate
from contin.exchange.sbml.roles import FIXED, RULE
from contin.exchange.sbml.symbols import Symbol, Symbols


class Initial(Mapping[str, str]):
    """Identifier -> its value at time 0, a formula; a fixed symbol stands for itself.

    `value` gives the formula of a fixed symbol, too.
    """

    def __init__(
        self, symbols: Symbols, functions: Mapping[str, Element], rates: Mapping[str, Rate], where: str
    ) -> None:
        self.symbols, self.functions, self.rates, self.where = symbols, functions, rates, where
        self._known: dict[str, str] = {}
        self._open: list[str] = []

    def __iter__(self) -> Iterator[str]:
        return iter([*self.symbols.of, *self.symbols.reactions])

    def __len__(self) -> int:
        return len(self.symbols.of) + len(self.symbols.reactions)

    def __getitem__(self, identifier: str) -> str:
        symbol = self.symbols.of.get(identifier)
        if symbol is not None and symbol.role == FIXED and not self.varies(symbol):
            return symbol.name
        return self.value(identifier)

    def varies(self, symbol: Symbol) -> bool:
        """True for a fixed amount whose concentration changes with the size of its compartment."""
        if symbol.kind != "species" or self.symbols.is_amount(symbol.element):
            return False
        return not self.symbols.size_is_fixed(symbol.element)

    def value(self, identifier: str) -> str:
        """The formula of a symbol's value at time 0, in fixed symbols."""
        if identifier not in self._known:
            if identifier in self._open:
                circle = " -> ".join([*self._open[self._open.index(identifier) :], identifier])
                raise InputError(f"{self.where}: initial values are defined in a circle: {circle}")
            self._open.append(identifier)
            self._known[identifier] = f"({self._value(identifier)})"
            self._open.pop()
        return self._known[identifier]

    def _value(self, identifier: str) -> str:
        if identifier in self.symbols.reactions:
            return self.rates[identifier](self, "0")
        if identifier not in self.symbols.of:
            raise KeyError(identifier)
        symbol = self.symbols.of[identifier]
        math = symbol.math if symbol.role == RULE else symbol.initial
        if math is not None:
            scope = mathml.Scope(self, self.functions, "0", f"{self.where}, value of {identifier}")
            return mathml.number(math, scope)
        return self._attribute(symbol)

    def _attribute(self, symbol: Symbol) -> str:
        element = symbol.element
        if symbol.kind == "compartment":
            return mathml.literal(element.getSize() if element.isSetSize() or self.symbols.level == 1 else float("nan"))
        if symbol.kind == "parameter":
            return mathml.literal(element.getValue() if element.isSetValue() else float("nan"))
        if symbol.kind == "reference":
            return mathml.literal(element.getStoichiometry())
        return self._of_species(element)

    def _of_species(self, species: Element) -> str:
        amount = self.symbols.is_amount(species)
        compartment = species.getCompartment()
        if species.isSetInitialConcentration():
            value = mathml.literal(species.getInitialConcentration())
            return f"{value}*{self[compartment]}" if amount and not self.symbols.without_extent(compartment) else value
        if species.isSetInitialAmount():
            value = mathml.literal(species.getInitialAmount())
            return value if amount else f"{value}/{self[compartment]}"
        return mathml.NAN
