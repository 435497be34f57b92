"""The formulas of an .ode file that depend on each other: which of them are used, and which cannot be read."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from contin.exchange.formulas.parser import FormulaError
from contin.exchange.formulas.tree import Node, walk
from contin.exchange.xpp.declarations import Formula
from contin.exchange.xpp.formulas import Formulas
from contin.exchange.xpp.symbols import Symbols


@dataclass(frozen=True)
class Entry:
    """A formula with its tree, or with what is wrong with it; `uses` are the names (small letters) it contains."""

    formula: Formula
    key: str
    tree: Node | None
    uses: frozenset[str]
    wrong: str = ""


def entry(formula: Formula, formulas: Formulas, symbols: Symbols) -> Entry:
    """One formula, read."""
    key = formula.name.lower()
    try:
        tree = formulas.read(formula)
        formulas.text(tree, formula.arguments)
    except FormulaError as error:
        return Entry(formula, key, None, frozenset(), f"line {formula.line}: {error}")
    hidden = {arg.lower() for arg in formula.arguments}
    uses = set()
    for node in walk(tree):
        if node.kind == "call" or (node.kind == "name" and node.text not in hidden):
            uses.add(symbols.full(node.text))
    return Entry(formula, key, tree, frozenset(uses))


def reached(start: Iterable[Entry], table: Mapping[str, Entry]) -> set[str]:
    """Keys of the entries of `table` that `start` depends on."""
    found: set[str] = set()
    waiting = [key for item in start for key in item.uses]
    while waiting:
        key = waiting.pop()
        if key in table and key not in found:
            found.add(key)
            waiting.extend(table[key].uses)
    return found


def circular(table: Mapping[str, Entry]) -> set[str]:
    """Keys of the entries that depend on themselves."""
    return {key for key, item in table.items() if key in reached([item], table)}
