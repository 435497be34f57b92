"""Expressions -> statements of another language: shared parts and long formulas become assignments of their own."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Container, Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Final

from contin.exchange.imported import UnsupportedError
from contin.exchange.writing.language import Language
from contin.model.binding import ATOM, POWER, PRODUCT, SUM
from contin.model.expression import COMPARISONS, Expression, Number, numeric_value
from contin.model.printing import finite_decimal
from contin.model.vocabulary import LOGICAL

SHORT: Final = 24  # characters of a shared part that is written again rather than named


@dataclass(frozen=True, slots=True)
class WrittenNode:
    """The text of a node, without its sign."""

    negative: bool
    body: str
    level: int

    def at(self, level: int) -> str:
        """The text, in parentheses unless it binds as strongly as `level`."""
        if self.negative:
            return f"(-{self.product()})" if level > SUM else f"-{self.product()}"
        return self.body if self.level >= level else f"({self.body})"

    def product(self) -> str:
        """The text without its sign, as part of a product or a sum."""
        return self.body if self.level >= PRODUCT else f"({self.body})"


class Code:
    """Writes expressions. `symbols` gives the text of each symbol, `fresh` names for intermediate results (None: the
    language has none); `assigned` collects (name, formula) in the order in which they must stand."""

    def __init__(self, language: Language, symbols: Mapping[str, str], fresh: Callable[[], str] | None) -> None:
        self.language, self.symbols, self.fresh = language, symbols, fresh
        self.assigned: list[tuple[str, str]] = []
        self.known: dict[Expression, WrittenNode] = {}
        self.shared: Counter[Expression] = Counter()

    def share(self, roots: Iterable[Expression]) -> None:
        """Count how often each part of `roots` is used, before they are written."""
        for node in postorder(list(roots), self.shared):
            self.shared.setdefault(node, 0)
            self.shared.update(node.args)

    def assign(self, name: str, node: Expression) -> None:
        """Write name = node; from now on the node is called so."""
        text = self.text(node)
        self.assigned.append((name, text))
        if node.args and not _condition(node):
            self.known[node] = WrittenNode(False, name, ATOM)

    def text(self, node: Expression) -> str:
        """The formula of a node."""
        for part in postorder([node], self.known):
            self.known[part] = self._kept(part, self._written(part))
        return self.known[node].at(SUM)

    def _kept(self, node: Expression, written: WrittenNode) -> WrittenNode:
        """What is written, or a name that is assigned to it where it is long, or used often."""
        if self.fresh is None or not node.args or _condition(node):
            return written
        often = self.shared[node] > 1 and len(written.body) > SHORT
        if not often and len(written.body) <= self.language.longest:
            return written
        return self._named(written.at(SUM))

    def _named(self, text: str) -> WrittenNode:
        if self.fresh is None:
            raise UnsupportedError(f"a formula of {len(text)} characters is too long")
        name = self.fresh()
        self.assigned.append((name, text))
        return WrittenNode(False, name, ATOM)

    def _written(self, node: Expression) -> WrittenNode:
        op = node.op
        if op == "number":
            return self._number(numeric_value(node))
        if op == "symbol":
            return WrittenNode(False, self.symbols[str(node.value)], ATOM)
        if op == "pi":
            return WrittenNode(False, self.language.pi, ATOM)
        args = [self.known[arg] for arg in node.args]
        if op == "add":
            return self._sum(args)
        if op == "mul":
            return self._product(node, args)
        if op == "pow":
            return self._power(node)
        return WrittenNode(False, self._call(op, [arg.at(SUM) for arg in args]), ATOM)

    def _number(self, value: Number) -> WrittenNode:
        literal = self.language.number
        if isinstance(value, Fraction):
            exact = abs(value)
            if not finite_decimal(exact) and Fraction(float(exact)) != exact:
                top, bottom = literal(float(exact.numerator)), literal(float(exact.denominator))
                return WrittenNode(value < 0, f"{top}/{bottom}", PRODUCT)
        if not math.isfinite(value):
            raise UnsupportedError(f"the number {value} cannot be written")
        return WrittenNode(value < 0, literal(abs(float(value))), ATOM)

    def _sum(self, args: list[WrittenNode]) -> WrittenNode:
        text = args[0].at(SUM)
        for term in args[1:]:
            if self.fresh is not None and len(text) > self.language.longest:
                text = self._named(text).body
            text += f" {'-' if term.negative else '+'} {term.product()}"
        return WrittenNode(False, text, SUM)

    def _product(self, node: Expression, args: list[WrittenNode]) -> WrittenNode:
        """Factors, and behind them divisors."""
        negative = args[0].negative
        above: list[str] = []
        below: list[str] = []
        for factor, written in zip(node.args, args, strict=True):
            divisor = _divisor(factor)
            if divisor is not None:
                below.append(self._reciprocal(factor, divisor))
            elif written.negative and factor is node.args[0]:
                above += [] if written.body == self.language.number(1.0) else [written.product()]
            else:
                above.append(written.at(POWER))
        text = "*".join(above) or self.language.number(1.0)
        return WrittenNode(negative, text + "".join(f"/{part}" for part in below), PRODUCT)

    def _reciprocal(self, factor: Expression, exponent: Fraction) -> str:
        base = self.known[factor.args[0]].at(ATOM)
        return base if exponent == 1 else self.language.power.format(base, _integer(exponent, self.language))

    def _power(self, node: Expression) -> WrittenNode:
        base, exponent = node.args
        divisor = _divisor(node)
        if divisor is not None:
            return WrittenNode(False, f"{self.language.number(1.0)}/{self._reciprocal(node, divisor)}", PRODUCT)
        value = numeric_value(exponent) if exponent.op == "number" else None
        whole = isinstance(value, Fraction) and value.denominator == 1
        shown = _integer(value, self.language) if whole and value is not None else self.known[exponent].at(ATOM)
        return WrittenNode(False, self.language.power.format(self.known[base].at(ATOM), shown), POWER)

    def _call(self, op: str, args: list[str]) -> str:
        language = self.language
        if op == "if":
            return language.conditional.format(*args)
        if op in COMPARISONS:
            return language.compare[op].format(*args)
        if op in LOGICAL:
            text = args[0]
            if op == "not":
                return language.logic["not"].format(text)
            for other in args[1:]:
                text = language.logic[op].format(text, other)
            return text
        if op in language.missing:
            raise UnsupportedError(f"{op}(...) has no equal there")
        template = language.functions.get(op, f"{op}({', '.join(f'{{{i}}}' for i in range(len(args)))})")
        return template.format(*args, one=language.number(1.0))


def _condition(node: Expression) -> bool:
    return node.op in COMPARISONS or node.op in LOGICAL


def _divisor(node: Expression) -> Fraction | None:
    """k of base^-k with a positive integer k."""
    if node.op != "pow" or node.args[1].op != "number":
        return None
    value = numeric_value(node.args[1])
    return -value if isinstance(value, Fraction) and value.denominator == 1 and value < 0 else None


def _integer(value: Number, language: Language) -> str:
    if value < 0:
        return f"(-{_integer(-value, language)})"
    return str(int(value)) if value < 1_000 else language.number(float(value))


def postorder(roots: list[Expression], done: Container[Expression]) -> list[Expression]:
    """Every node below `roots`, after its arguments; not those in `done`, and not what only they contain."""
    found: dict[Expression, None] = {}
    waiting = [(root, False) for root in reversed(roots)]
    while waiting:
        node, ready = waiting.pop()
        if node in done or node in found:
            continue
        if ready:
            found[node] = None
        else:
            waiting.append((node, True))
            waiting.extend((arg, False) for arg in reversed(node.args))
    return list(found)
