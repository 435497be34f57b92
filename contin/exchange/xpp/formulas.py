"""The formulas of an .ode file as text in contin's grammar."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Final

from contin.exchange.formulas.contin_text import Call, Writer
from contin.exchange.formulas.parser import FormulaError, parse
from contin.exchange.formulas.tree import Node, either, name, number, own, rebuilt, substituted, total, walk
from contin.exchange.naming import cleaned
from contin.exchange.xpp.constants import constant, folded
from contin.exchange.xpp.declarations import Formula, Table
from contin.exchange.xpp.grammar import INDEX, REFUSED, XPP, surprising
from contin.exchange.xpp.symbols import Symbols

MOST_TERMS: Final = 20_000  # of one sum
_SAME: Final = frozenset("sin cos tan asin acos atan atan2 sinh cosh tanh exp sqrt abs sign max min log10".split())
_OTHER: Final = {"ln": "log", "log": "log", "flr": "floor", "ceil": "ceil"}


class Unknown(FormulaError):
    """A formula uses what contin has no equal for."""


class Formulas:
    """Reads formulas; `time` is the text of t, `values` are numbers known beforehand, `defaults` parameters."""

    def __init__(
        self, symbols: Symbols, time: str, values: Mapping[str, float], defaults: Mapping[str, float], notes: list[str]
    ) -> None:
        self.symbols, self.time, self.values, self.notes = symbols, time, values, notes
        self.defaults = {**values, **defaults}
        self.uses_time = False
        self.tables: dict[str, Table] = {}
        self._tabulated: dict[str, Node] = {}
        self.noisy = {key for key, s in symbols.table.items() if s.kind == "noise"}  # and what contains noise

    def read(self, formula: Formula) -> Node:
        """The tree of a formula, sums and shifts written out, at the values of declared numbers."""
        node = self._expanded(parse(formula.text, XPP))
        odd = surprising(node)
        if odd is not None:
            self.notes.append(
                f"line {formula.line}: XPP compares before it calculates, so that x > 2*y means (x > 2)*y; "
                f"{formula.text} is read so"
            )
        return node

    def has_noise(self, node: Node) -> bool:
        """True where noise remains at the parameters' values."""
        if not self.noisy:
            return False
        return any(self.symbols.full(n.text) in self.noisy for n in walk(folded(node, self.defaults)))

    def text(self, node: Node, arguments: tuple[str, ...] = ()) -> str:
        """The formula in contin's grammar; `arguments` are those of the function it defines."""
        own = {arg.lower(): cleaned(arg) for arg in arguments}

        def spelled(key: str) -> str:
            return own[key] if key in own else self._name(key)

        return Writer(spelled, _CALLS, self._call).number(node)

    def _name(self, key: str) -> str:
        if key == "t":
            self.uses_time = True
            return self.time
        if key == "pi":
            return "pi"
        found = self.symbols.find(key)
        if found is None:
            raise Unknown(f"{key} is not declared")
        if found.kind == "function":
            raise Unknown(f"{key} is a function and needs its arguments")
        return "0" if found.kind == "noise" else found.name

    def _call(self, writer: Writer, node: Node) -> Node | str:
        found = self.symbols.find(node.text)
        if found is not None and found.kind == "function":
            return writer.call(found.name, *node.args)
        if node.text in _SAME:
            return writer.call(node.text, *node.args)
        if node.text in _OTHER:
            return writer.call(_OTHER[node.text], *node.args)
        if node.text in REFUSED:
            raise Unknown(f"{node.text}(...): there is no equal here for {REFUSED[node.text]}")
        raise Unknown(f"{node.text} is not a function")

    # Sums and shifts --------------------------------------------------------------------------------------------------

    def _expanded(self, node: Node) -> Node:
        def change(found: Node) -> Node | None:
            if found.kind == "sum":
                return self._sum(found)
            if found.kind == "call" and found.text == "shift":
                return self._shift(found)
            if found.kind == "call" and found.text in self.tables:
                return self._interpolated(found, self.tables[found.text])
            return None

        return rebuilt(node, change)

    def _sum(self, node: Node) -> Node:
        first, last = (constant(arg, self.values) for arg in node.args[:2])
        if first is None or last is None:
            raise Unknown("the limits of a sum are not numbers here: a parameter may change them")
        low, high = math.trunc(first), math.trunc(last)
        if high - low >= MOST_TERMS:
            raise Unknown(f"a sum of {high - low + 1} terms; {MOST_TERMS} are allowed")
        term = node.args[2]
        return total([self._expanded(substituted(term, {INDEX: number(k)})) for k in range(low, high + 1)])

    def _interpolated(self, node: Node, table: Table) -> Node:
        """A table at a place that is known; in between a table is no formula."""
        place = constant(node.args[0], self.values) if len(node.args) == 1 else None
        if place is None:
            raise Unknown(f"the table {node.text} at what is no number here: tables have no equal but at numbers")
        if node.text not in self._tabulated:
            self._tabulated[node.text] = self._expanded(parse(table.formula.text, XPP))
        return _between(table, self._tabulated[node.text], place)

    def _shift(self, node: Node) -> Node | None:
        if len(node.args) != 2 or node.args[0].kind != "name":
            raise Unknown("shift needs a name and a number")
        key = node.args[0].text
        step = constant(node.args[1], self.values)
        if step is None:
            if any(n.text == INDEX for n in walk(node.args[1])):
                return node  # inside a sum that is written out later
            raise Unknown(f"shift({key}, ...) by what is no number here: a parameter or a state may change it")
        for order in (self.symbols.order, self.symbols.constants):
            if key in order:
                place = order.index(key) + math.trunc(step)
                if not 0 <= place < len(order):
                    raise Unknown(f"shift({key}, {step:g}) leaves the declared names")
                return name(order[place])
        raise Unknown(f"shift({key}, ...): {key} is no variable and no parameter")


def _between(table: Table, node: Node, place: float) -> Node:
    """The straight line through the two values beside `place`, or beyond the end nearest to it."""
    step = (table.high - table.low) / (table.points - 1)
    k = min(max(math.floor((place - table.low) / step), 0), table.points - 2)
    part = (place - table.low) / step - k
    ends = [substituted(node, {"t": number(table.low + i * step)}) for i in (k, k + 1)]
    if part in (0.0, 1.0):
        return ends[int(part)]
    weighted = (Node("*", (number(w), end)) for w, end in zip((1 - part, part), ends, strict=True))
    return Node("+", tuple(weighted))


def _heaviside(writer: Writer, node: Node) -> Node:
    """heav(0) is 1 in XPP."""
    return either(Node(">=", (node.args[0], number(0))), number(1), number(0))


def _remainder(writer: Writer, node: Node) -> Node | str:
    """XPP's mod(x, y): the remainder of the division towards zero, plus y where that is negative."""
    x, y = node.args
    if y.kind == "number" and float(y.text) > 0:
        return writer.call("mod", x, y)
    absolute = own("abs", y)
    towards = own("mod", own("abs", x), absolute)
    below = either(Node(">", (towards, number(0))), Node("-", (y, towards)), number(0))
    return either(Node(">=", (x, number(0))), towards, below)


_CALLS: Final[Mapping[str, Call]] = {"heav": _heaviside, "mod": _remainder}
