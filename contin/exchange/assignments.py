"""Assignments in their order -> definitions that do not depend on it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from contin.exchange.formulas.contin_text import Call, Writer
from contin.exchange.formulas.parser import FormulaError
from contin.exchange.formulas.tree import Node
from contin.exchange.naming import Names


@dataclass
class Assignments:
    """The state of a straight program: `current` is what a variable (as it is keyed) is called now, `elements` names
    of array elements by array and index, `words` texts that names stand for in any case."""

    names: Names
    calls: Mapping[str, Call]
    otherwise: Call
    words: Mapping[str, str] = field(default_factory=dict)
    current: dict[str, str] = field(default_factory=dict)
    elements: dict[tuple[str, int], str] = field(default_factory=dict)
    definitions: dict[str, str] = field(default_factory=dict)

    def text(self, node: Node) -> str:
        """A formula in contin's grammar, with the present values of variables."""
        arrays = {array: self._element for array, _ in self.elements}
        return Writer(self._name, {**self.calls, **arrays}, self.otherwise).number(node)

    def assign(self, variable: str, node: Node) -> None:
        """variable = node; a variable that is assigned again has a new name from then on."""
        text = self.text(node)
        if text in self.elements.values() or text in self.current.values():  # another name of the same thing
            self.current[variable] = text
            return
        name = self.names.take(variable, quiet=True)
        self.definitions[name] = text
        self.current[variable] = name

    def _name(self, key: str) -> str:
        if key in self.current:
            return self.current[key]
        if key in self.words:
            return self.words[key]
        raise FormulaError(f"{key} has no value yet")

    def _element(self, writer: Writer, node: Node) -> str:
        index = element(node)
        found = None if index is None else self.elements.get((node.text, index))
        if found is None:
            raise FormulaError(f"an element of {node.text} that is not known by a number")
        return found


def element(node: Node) -> int | None:
    """The index of array(3); None of anything else."""
    if node.kind != "call" or len(node.args) != 1 or node.args[0].kind != "number" or not node.args[0].text.isdigit():
        return None
    return int(node.args[0].text)
