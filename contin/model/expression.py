"""Formulas as a hash-consed graph: equal formulas are the same object, so common subexpressions cost nothing to find.

Nodes are immutable and interned: `a is b` exactly when a and b are built alike. Numbers are exact rationals where the
text was exact ("0.1" is 1/10), so passes can hand them to a computer algebra system and back without rounding. Building
a node applies only rules that hold for all real arguments where both sides are defined (0*x = 0, x - x = 0, x*x = x^2,
numbers folded); nothing is expanded, nothing sorted, so a printed formula stays close to what its author wrote.
"""

from __future__ import annotations

import atexit
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from functools import lru_cache
from typing import Final, Union
from weakref import WeakValueDictionary

from contin import lazy
from contin.model.folding import Number as Number
from contin.model.folding import constant, folded_call, folded_power, holds
from contin.model.symbol_masks import distinct, symbol_bit
from contin.model.symbol_masks import mask_of as mask_of
from contin.model.vocabulary import BINARY_FUNCTIONS, FUNCTIONS, LOGICAL, VARIADIC_FUNCTIONS
from contin.model.vocabulary import COMPARISONS as COMPARISONS

ExpressionLike = Union["Expression", int, float, Fraction]


class Expression:
    """One node: `op` is 'number', 'pi', 'symbol', 'add', 'mul', 'pow', 'if', a comparison, 'and', 'or', 'not' or a
    function of the grammar.

    `args` are the operands ('if' has condition, then, else); `value` is the number or the symbol's name, otherwise
    None; `mask` has one bit per symbol that occurs below (see `symbol_bit`), so "does it depend on x" is one integer
    operation.
    """

    __slots__ = ("__weakref__", "args", "mask", "op", "value")
    op: str
    args: tuple[Expression, ...]
    value: Number | str | None
    mask: int

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError("expressions are immutable")

    # No __eq__ and __hash__: interning makes identity the right equality.

    def __reduce__(self) -> tuple[object, ...]:
        return _make, (self.op, self.args, self.value)

    def __copy__(self) -> Expression:
        return self

    def __deepcopy__(self, memo: object) -> Expression:
        return self

    def __repr__(self) -> str:
        return f"Expression({lazy.module('printing').to_text(self)!r})"

    def __add__(self, other: ExpressionLike) -> Expression:
        return add(self, other)

    def __radd__(self, other: ExpressionLike) -> Expression:
        return add(other, self)

    def __sub__(self, other: ExpressionLike) -> Expression:
        return add(self, neg(other))

    def __rsub__(self, other: ExpressionLike) -> Expression:
        return add(other, neg(self))

    def __mul__(self, other: ExpressionLike) -> Expression:
        return mul(self, other)

    def __rmul__(self, other: ExpressionLike) -> Expression:
        return mul(other, self)

    def __truediv__(self, other: ExpressionLike) -> Expression:
        return div(self, other)

    def __rtruediv__(self, other: ExpressionLike) -> Expression:
        return div(other, self)

    def __pow__(self, other: ExpressionLike) -> Expression:
        return power(self, other)

    def __neg__(self) -> Expression:
        return neg(self)

    @property
    def is_number(self) -> bool:
        return self.op == "number"


_interned: WeakValueDictionary[tuple[object, ...], Expression] = WeakValueDictionary()
# else nodes that die while the interpreter does compare half-dismantled numbers
atexit.register(_interned.data.clear)  # type: ignore[attr-defined]


def depends_on(expression: Expression, names: Iterable[str]) -> bool:
    """True where a symbol of `names` occurs in the expression."""
    wanted = set(names)
    common = expression.mask & mask_of(wanted)
    if distinct(common) or not common:
        return bool(common)
    return any(node.op == "symbol" and node.value in wanted for node in postorder([expression]))


def _make(op: str, args: tuple[Expression, ...], value: Number | str | None = None) -> Expression:
    # type(value) keeps 1/2 (exact) and 0.5 (a rounded result) apart, although Python calls them equal
    key = (op, args, value, type(value))
    node = _interned.get(key)
    if node is None:
        node = object.__new__(Expression)
        mask = symbol_bit(value) if op == "symbol" and isinstance(value, str) else 0
        for argument in args:
            mask |= argument.mask
        put = object.__setattr__
        put(node, "op", op)
        put(node, "args", args)
        put(node, "value", value)
        put(node, "mask", mask)
        _interned[key] = node
    return node


def exactly(op: str, args: tuple[Expression, ...], value: Number | str | None = None) -> Expression:
    """A node as it is, without any rule: for those who read back what was built before."""
    return _make(op, args, value)


def number(value: int | float | Fraction) -> Expression:
    """A constant, exact where it can be (`folding.constant`)."""
    if type(value) is Fraction:
        return _ratio(value.numerator, value.denominator)
    return _ratio(value, 1) if type(value) is int else _make("number", (), constant(value))


@lru_cache(4096)  # a few numbers are asked for again and again: looking for a fraction's node takes ten times as long
def _ratio(numerator: int, denominator: int) -> Expression:
    return _make("number", (), constant(Fraction(numerator, denominator)))


def symbol(name: str) -> Expression:
    """A named quantity: state, parameter, direction component, ..."""
    return _make("symbol", (), name)


ZERO: Final = number(0)
ONE: Final = number(1)
MINUS_ONE: Final = number(-1)
PI: Final = _make("pi", ())


_NONE: Final = Fraction(0)
_UNIT: Final = Fraction(1)  # one object, so that "is it 1" is most often answered without arithmetic


def as_expression(value: ExpressionLike) -> Expression:
    """Numbers become constant nodes; expressions pass."""
    return value if isinstance(value, Expression) else number(value)


def numeric_value(node: Expression) -> Number:
    """The value of a 'number' node."""
    value = node.value
    if node.op != "number" or value is None or isinstance(value, str):
        raise TypeError(f"not a number node: {node.op}")
    return value


def add(*terms: ExpressionLike) -> Expression:
    """Sum; like terms (equal up to a numeric factor) and numbers are collected, nested sums are left as they are."""
    constant: Number = _NONE
    collected: dict[Expression, Number] = {}
    for term in terms:
        node = as_expression(term)
        if node.op == "number":
            constant = constant + numeric_value(node)
            continue
        coefficient, rest = split_coefficient(node)
        known = collected.get(rest)
        collected[rest] = coefficient if known is None else known + coefficient
    nodes = [_scaled(c, rest) for rest, c in collected.items() if c]
    if constant or not nodes:
        folded = number(constant)
        first = as_expression(terms[0]) if terms else folded
        nodes = [folded, *nodes] if first.op == "number" else [*nodes, folded]
    return nodes[0] if len(nodes) == 1 else _make("add", tuple(nodes))


def split_coefficient(node: Expression) -> tuple[Number, Expression]:
    """`node` as (numeric factor, the rest)."""
    if node.op == "mul" and node.args[0].op == "number":
        rest = node.args[1:]
        return numeric_value(node.args[0]), rest[0] if len(rest) == 1 else _make("mul", rest)
    return _UNIT, node


def _scaled(coefficient: Number, rest: Expression) -> Expression:
    if coefficient is _UNIT or coefficient == 1:
        return rest
    factors = rest.args if rest.op == "mul" else (rest,)
    return _make("mul", (number(coefficient), *factors))


def mul(*factors: ExpressionLike) -> Expression:
    """Product; numbers go in front, equal bases with numeric exponents are collected, nested products are flattened."""
    coefficient: Number = _UNIT
    powers: dict[Expression, Number] = {}
    stack = [as_expression(f) for f in reversed(factors)]
    while stack:
        node = stack.pop()
        if node.op == "number":
            coefficient = coefficient * numeric_value(node)
        elif node.op == "mul":
            stack.extend(reversed(node.args))
        elif node.op == "pow" and node.args[1].op == "number":
            base, exponent = node.args[0], numeric_value(node.args[1])
            known = powers.get(base)
            powers[base] = exponent if known is None else known + exponent
        else:
            known = powers.get(node)
            powers[node] = _UNIT if known is None else known + 1
    if coefficient == 0:
        return ZERO
    nodes: list[Expression] = []
    settled = True
    for base, e in powers.items():
        if e:
            node = base if e is _UNIT or e == 1 else power(base, number(e))
            settled = settled and node.op not in ("number", "mul") and _base(node) is base
            nodes.append(node)
    if not settled:  # a collected power folded, or became a power of something else
        return mul(number(coefficient), *nodes)
    if (coefficient is not _UNIT and coefficient != 1) or not nodes:
        nodes.insert(0, number(coefficient))
    return nodes[0] if len(nodes) == 1 else _make("mul", tuple(nodes))


def _base(node: Expression) -> Expression:
    """What `mul` collects `node` under: the base of a numeric power, otherwise the node itself."""
    return node.args[0] if node.op == "pow" and node.args[1].op == "number" else node


def power(base: ExpressionLike, exponent: ExpressionLike) -> Expression:
    """base^exponent; folds numbers, x^0 = 1, x^1 = x and (x^i)^j with integers i, j."""
    b, e = as_expression(base), as_expression(exponent)
    if e.op == "number":
        value = numeric_value(e)
        if value == 0:
            return ONE
        if value == 1:
            return b
        if isinstance(value, Fraction) and value.denominator == 1:
            if b.op == "number":
                folded = folded_power(numeric_value(b), int(value))
                if folded is not None:
                    return number(folded)
            if b.op == "pow" and b.args[1].op == "number":
                inner = numeric_value(b.args[1])
                if isinstance(inner, Fraction) and inner.denominator == 1:
                    return power(b.args[0], number(inner * value))
    if b is ONE:
        return ONE
    return _make("pow", (b, e))


def neg(value: ExpressionLike) -> Expression:
    """-value"""
    return mul(MINUS_ONE, value)


def sub(a: ExpressionLike, b: ExpressionLike) -> Expression:
    """a - b"""
    return add(a, neg(b))


def div(a: ExpressionLike, b: ExpressionLike) -> Expression:
    """a / b, kept as a product with a negative power; the lowering makes it one division again."""
    return mul(a, power(b, MINUS_ONE))


def call(name: str, *args: ExpressionLike) -> Expression:
    """A function of the grammar. min and max of several arguments nest to two at a time."""
    nodes = tuple(as_expression(a) for a in args)
    if name in VARIADIC_FUNCTIONS:
        if len(nodes) < 2:
            raise TypeError(f"{name} takes two or more arguments; got {len(nodes)}")
        if len(nodes) > 2:
            return call(name, call(name, *nodes[:-1]), nodes[-1])
    elif len(nodes) != (2 if name in BINARY_FUNCTIONS else 1) or name not in FUNCTIONS:
        raise TypeError(f"no function {name} with {len(nodes)} arguments")
    if all(n.op == "number" for n in nodes):
        folded = folded_call(name, [numeric_value(n) for n in nodes])
        if folded is not None:
            return number(folded)
    return _make(name, nodes)


def compare(op: str, a: ExpressionLike, b: ExpressionLike) -> Expression:
    """A condition a < b, a <= b, ...; of two numbers it folds to the number 1 (true) or 0 (false)."""
    if op not in COMPARISONS:
        raise TypeError(f"no comparison {op!r}")
    left, right = as_expression(a), as_expression(b)
    if left.op == "number" and right.op == "number":
        return ONE if holds(op, numeric_value(left), numeric_value(right)) else ZERO
    return _make(op, (left, right))


def logical(op: str, *args: Expression) -> Expression:
    """'and', 'or' (two operands or more) and 'not' of conditions; constant operands fold."""
    if op == "not":
        (inner,) = args
        return (ZERO if inner is not ZERO else ONE) if inner.op == "number" else _make("not", args)
    absorbing, neutral = (ZERO, ONE) if op == "and" else (ONE, ZERO)
    if absorbing in args:
        return absorbing
    kept = tuple(a for a in args if a is not neutral)
    if not kept:
        return neutral
    return kept[0] if len(kept) == 1 else _make(op, kept)


def if_(condition: Expression, then: ExpressionLike, otherwise: ExpressionLike) -> Expression:
    """`then if condition else otherwise`"""
    a, b = as_expression(then), as_expression(otherwise)
    if a is b:
        return a
    if condition.op == "number":
        return b if condition is ZERO else a
    return _make("if", (condition, a, b))


def is_condition(node: Expression) -> bool:
    """True for comparisons and logical nodes, whose value is a truth value and not a number."""
    return node.op in COMPARISONS or node.op in LOGICAL


def rebuild(node: Expression, args: tuple[Expression, ...]) -> Expression:
    """The same operation on other operands, through the simplifying constructors."""
    if args == node.args:
        return node
    op = node.op
    if op == "add":
        return add(*args)
    if op == "mul":
        return mul(*args)
    if op == "pow":
        return power(*args)
    if op == "if":
        return if_(*args)
    if op in COMPARISONS:
        return compare(op, *args)
    if op in LOGICAL:
        return logical(op, *args)
    return call(op, *args)


def postorder(roots: Iterable[Expression]) -> list[Expression]:
    """Every node below `roots` once, operands before their users; no recursion, so depth is no limit."""
    seen: set[Expression] = set()
    order: list[Expression] = []
    stack: list[tuple[Expression, bool]] = [(root, False) for root in reversed(list(roots))]
    while stack:
        node, done = stack.pop()
        if done:
            order.append(node)
        elif node not in seen:
            seen.add(node)
            stack.append((node, True))
            stack.extend((a, False) for a in reversed(node.args) if a not in seen)
    return order


def substitute(roots: Iterable[Expression], mapping: Mapping[Expression, Expression]) -> list[Expression]:
    """Replace nodes (usually symbols) everywhere, all at once; one pass over the graph."""
    roots = list(roots)
    done: dict[Expression, Expression] = dict(mapping)
    for node in postorder(roots):
        if node not in done:
            done[node] = rebuild(node, tuple(done[a] for a in node.args)) if node.args else node
    return [done[root] for root in roots]


def renamed(nodes: Sequence[Expression], names: Mapping[str, Expression]) -> Expression:
    """The last of `nodes` (a `postorder`) with other symbols in place of its own, none of them twice.

    No rule of the constructors can apply that did not apply before, so nodes are made as they are.
    """
    done: dict[Expression, Expression] = {}
    for node in nodes:
        if node.op == "symbol":
            done[node] = names.get(str(node.value), node)
        elif not node.args:
            done[node] = node
        else:
            done[node] = _make(node.op, tuple([done[a] for a in node.args]), node.value)
    return done[nodes[-1]]


def symbols_in(roots: Iterable[Expression]) -> list[str]:
    """Names of the symbols that occur, in order of first occurrence."""
    return [str(node.value) for node in postorder(roots) if node.op == "symbol"]
