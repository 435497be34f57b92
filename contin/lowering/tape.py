"""Formulas as a straight list of machine operations, each written once.

The tape sits between the formula graph and LLVM: it decides *how* a node is computed (one division for a product with
negative powers, powers by squaring, conditionals as selects of two values that are both computed), so what a system
costs can be counted in statements. Equal statements share one number. No rule here relies on "fast math": every
rewrite gives the same bits as the plain formula, except that a rational factor is one rounded constant and long sums
are added in pairs.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import Final

from contin.model.expression import COMPARISONS, Expression, numeric_value

Statement = tuple[object, ...]
"""(operation, operands): operands are statement numbers, except for 'const' (a float) and 'load' (array, index)."""

LARGEST_SQUARED_POWER: Final = 64  # beyond this, repeated multiplication loses more digits than pow does
PAIRWISE_FROM: Final = 8  # sums of more terms are added in pairs: shorter dependency chains, smaller rounding error
ODD: Final = frozenset("sin tan asin atan sinh tanh asinh atanh".split())
EVEN: Final = frozenset({"cos", "cosh", "abs"})
PREDICATES: Final = {"<": "olt", "<=": "ole", ">": "ogt", ">=": "oge", "==": "oeq", "!=": "une"}


class Tape:
    """Statements in order of computation; `inputs` says which array element each symbol is loaded from."""

    def __init__(self, inputs: dict[str, tuple[int, int]]) -> None:
        self.statements: list[Statement] = []
        self._numbers: dict[Statement, int] = {}
        self._inputs = inputs
        self._done: dict[Expression, int] = {}

    def __len__(self) -> int:
        return len(self.statements)

    def statement(self, *parts: object) -> int:
        """Number of this statement, appended unless an equal one exists."""
        known = self._numbers.get(parts)
        if known is None:
            known = self._numbers[parts] = len(self.statements)
            self.statements.append(parts)
        return known

    def constant(self, value: float) -> int:
        # the text keeps 0.0 and -0.0 apart, which compare equal
        return self.statement("const", float(value).hex())

    def evaluate(self, expression: Expression) -> int:
        """Append what `expression` needs and return the number of its value."""
        done = self._done
        stack = [expression]
        while stack:
            node = stack[-1]
            missing = [a for a in node.args if a not in done]
            if missing:
                stack.extend(reversed(missing))
                continue
            stack.pop()
            if node not in done:
                done[node] = self._node(node)
        return done[expression]

    def pruned(self, outputs: Sequence[int]) -> tuple[list[Statement], list[int]]:
        """The statements that `outputs` need, renumbered, and the outputs' new numbers."""
        needed = bytearray(len(self.statements))
        for output in outputs:
            needed[output] = 1
        for index in range(len(self.statements) - 1, -1, -1):
            if needed[index]:
                for operand in operands(self.statements[index]):
                    needed[operand] = 1
        renumbered: dict[int, int] = {}
        kept: list[Statement] = []
        for first in range(len(self.statements)):
            for index in (first, self._partner(first)):
                if not needed[index] or index in renumbered:
                    continue
                renumbered[index] = len(kept)
                statement = self.statements[index]
                read = operands(statement)
                kept.append((*statement[: len(statement) - len(read)], *(renumbered[o] for o in read)))
        return kept, [renumbered[o] for o in outputs]

    def _partner(self, index: int) -> int:
        """The cosine of the angle whose sine this is, or the reverse: side by side, LLVM computes them in one call."""
        statement = self.statements[index]
        if statement[0] != "call" or statement[1] not in ("sin", "cos"):
            return index
        return self._numbers.get(("call", "cos" if statement[1] == "sin" else "sin", statement[2]), index)

    def _node(self, node: Expression) -> int:
        op, done = node.op, self._done
        if op == "symbol":
            return self.statement("load", *self._inputs[str(node.value)])
        if op == "number":
            return self.constant(as_float(node))
        if op == "pi":
            return self.constant(math.pi)
        if op == "add":
            return self._sum(node)
        if op == "mul":
            return self._product(node)
        if op == "pow":
            return self._product_of([], [node])
        if op == "if":
            return self.statement("select", *(done[a] for a in node.args))
        if op in COMPARISONS:
            return self.statement("fcmp " + PREDICATES[op], *(done[a] for a in node.args))
        if op in ("and", "or"):
            value = done[node.args[0]]
            for argument in node.args[1:]:
                value = self.statement(op, value, done[argument])
            return value
        if op == "not":
            return self.statement("not", done[node.args[0]])
        return self._call(op, [done[a] for a in node.args])

    # sums

    def _sum(self, node: Expression) -> int:
        terms = [self._sign_split(self._done[term]) for term in node.args]
        if len(terms) > PAIRWISE_FROM:
            return self._signed(self._pairwise(terms))
        total = terms[0]
        for term in terms[1:]:
            total = self._plus(total, term)
        return self._signed(total)

    def _pairwise(self, terms: Sequence[tuple[bool, int]]) -> tuple[bool, int]:
        while len(terms) > 1:
            pairs = [self._plus(terms[i], terms[i + 1]) for i in range(0, len(terms) - 1, 2)]
            terms = pairs + list(terms[2 * len(pairs) :])
        return terms[0]

    def _plus(self, a: tuple[bool, int], b: tuple[bool, int]) -> tuple[bool, int]:
        if a[0] == b[0]:
            return a[0], self.statement("fadd", a[1], b[1])
        return True, self.statement("fsub", a[1], b[1]) if a[0] else self.statement("fsub", b[1], a[1])

    def _signed(self, term: tuple[bool, int]) -> int:
        return term[1] if term[0] else self._negated(term[1])

    def _sign_split(self, value: int) -> tuple[bool, int]:
        statement = self.statements[value]
        return (False, operands(statement)[0]) if statement[0] == "fneg" else (True, value)

    def _negated(self, value: int) -> int:
        positive, rest = self._sign_split(value)
        return self.statement("fneg", value) if positive else rest

    # products and powers

    def _product(self, node: Expression) -> int:
        factors = list(node.args)
        negative = False
        constants = []
        if factors[0].op == "number":
            coefficient = numeric_value(factors.pop(0))
            negative = coefficient < 0
            if coefficient not in (1, -1):
                constants.append(self.constant(_rounded(-coefficient if negative else coefficient)))
        value = self._product_of(constants, factors)
        return self._negated(value) if negative else value

    def _product_of(self, values: list[int], factors: Sequence[Expression]) -> int:
        """Product of `values` and `factors`, all negative powers gathered into one division."""
        top: list[int] = list(values)
        bottom: list[int] = []
        for factor in factors:
            if factor.op != "pow":
                top.append(self._done[factor])
                continue
            base, exponent = self._done[factor.args[0]], factor.args[1]
            if not exponent.is_number:
                top.append(self.statement("call", "pow", base, self._done[exponent]))
                continue
            size = numeric_value(exponent)
            if size < 0 and _by_squaring(size):
                bottom.extend(self._power(base, -size))
            else:
                top.extend(self._power(base, size))
        numerator = self._chain(top)
        if not bottom:
            return self.constant(1.0) if numerator is None else numerator
        denominator = self._chain(bottom)
        assert denominator is not None
        return self.statement("fdiv", self.constant(1.0) if numerator is None else numerator, denominator)

    def _chain(self, values: Sequence[int]) -> int | None:
        if not values:
            return None
        product = values[0]
        for value in values[1:]:
            product = self.statement("fmul", product, value)
        return product

    def _power(self, base: int, exponent: Fraction | float) -> list[int]:
        """Factors whose product is base^exponent."""
        if not _by_squaring(exponent) or exponent < 0:
            return [self.statement("call", "pow", base, self.constant(_rounded(exponent)))]
        whole, half = int(exponent), exponent != int(exponent)
        factors = [self.integer_power(base, whole)] if whole else []
        return [*factors, self.statement("call", "sqrt", base)] if half else factors

    def integer_power(self, base: int, exponent: int) -> int:
        """base^exponent, exponent >= 1, by squaring; lower powers are shared between all that need them."""
        if exponent == 1:
            return base
        half = self.integer_power(base, exponent // 2)
        if exponent % 2 == 0:
            return self.statement("fmul", half, half)
        return self.statement("fmul", self.integer_power(base, exponent - 1), base)

    # functions

    def _call(self, name: str, args: list[int]) -> int:
        if name == "sign":
            return self._by_sign(args[0], 1.0, -1.0, args[0])
        if name == "heaviside":
            return self._by_sign(args[0], 1.0, 0.0, self.constant(0.5))
        if name == "mod":
            return self._remainder(*args)
        if name == "factorial":
            return self._factorial(args[0])
        if name in ODD or name in EVEN:
            flipped = self._mirror(args[0])
            if flipped is not None:
                value = self.statement("call", name, flipped)
                return self._negated(value) if name in ODD else value
        return self.statement("call", name, *args)

    def _remainder(self, a: int, b: int) -> int:
        """a - b floor(a/b), put back between 0 and b where rounding of a/b left that: error below an ulp of a."""
        whole = self.statement("call", "floor", self.statement("fdiv", a, b))
        rest = self.statement("fsub", a, self.statement("fmul", b, whole))
        share = self.statement("fdiv", rest, b)
        below = self.statement("fcmp olt", share, self.constant(0.0))
        beyond = self.statement("fcmp oge", share, self.constant(1.0))
        rest = self.statement("select", below, self.statement("fadd", rest, b), rest)
        return self.statement("select", beyond, self.statement("fsub", rest, b), rest)

    def _factorial(self, x: int) -> int:
        """x! of whole numbers, infinite beyond 170; NaN elsewhere."""
        whole = self.statement("fcmp oeq", x, self.statement("call", "floor", x))
        beyond = self.statement("and", whole, self.statement("fcmp ogt", x, self.constant(170.0)))
        value = self.statement("select", beyond, self.constant(math.inf), self.constant(math.nan))
        for n in range(171):
            is_n = self.statement("fcmp oeq", x, self.constant(float(n)))
            value = self.statement("select", is_n, self.constant(float(math.factorial(n))), value)
        return value

    def _mirror(self, value: int) -> int | None:
        """-value where that is already there or cheaper, so that sin(x - y) and sin(y - x) are computed once."""
        statement = self.statements[value]
        if statement[0] == "fneg":
            return operands(statement)[0]
        if statement[0] == "fsub":
            return self._numbers.get(("fsub", statement[2], statement[1]))
        return None

    def _by_sign(self, x: int, positive: float, negative: float, at_zero: int) -> int:
        zero = self.constant(0.0)
        middle = self.statement("select", self.statement("fcmp oeq", x, zero), at_zero, x)  # NaN stays NaN
        below = self.statement("select", self.statement("fcmp olt", x, zero), self.constant(negative), middle)
        return self.statement("select", self.statement("fcmp ogt", x, zero), self.constant(positive), below)


def as_float(node: Expression) -> float:
    """A number node in double precision; exact numbers too large for it become infinite."""
    return _rounded(numeric_value(node))


def _rounded(value: Fraction | float) -> float:
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf


def _by_squaring(exponent: Fraction | float) -> bool:
    """Integers and half-integers of moderate size are powers by multiplication (and one square root)."""
    return -LARGEST_SQUARED_POWER <= exponent <= LARGEST_SQUARED_POWER and (2 * exponent) % 1 == 0


def operands(statement: Statement) -> tuple[int, ...]:
    """The statement numbers that a statement reads."""
    operation = statement[0]
    if operation in ("const", "load"):
        return ()
    return statement[2 if operation == "call" else 1 :]  # type: ignore[return-value]
