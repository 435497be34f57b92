"""Functions that several languages have under several names, in contin's."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from contin.exchange.formulas.contin_text import Call, Writer
from contin.exchange.formulas.parser import FormulaError
from contin.exchange.formulas.tree import Node, either, number, own

SAME: Final = frozenset(
    "sin cos tan asin acos atan atan2 sinh cosh tanh asinh acosh atanh exp expm1 log log1p log10 sqrt abs sign min max "
    "floor ceil mod factorial heaviside".split()
)
_ONE_OVER: Final = {"sec": "cos", "csc": "sin", "cot": "tan", "sech": "cosh", "csch": "sinh", "coth": "tanh"}


def as_it_is(writer: Writer, node: Node) -> str:
    """A function that contin has under the same name."""
    return writer.call(node.text, *node.args)


def named(function: str) -> Call:
    """A function that contin has under another name."""
    return lambda writer, node: writer.call(function, *node.args)


def one_over(function: str) -> Call:
    """1/function(x)."""
    return lambda writer, node: Node("/", (number(1), own(function, *node.args)))


def power(writer: Writer, node: Node) -> Node:
    """power(x, y)."""
    return Node("^", _two(node))


def choose(writer: Writer, node: Node) -> Node:
    """choose(condition, then, otherwise)."""
    condition, then, otherwise = _three(node)
    return either(condition, then, otherwise)


def merge(writer: Writer, node: Node) -> Node:
    """Fortran's merge(then, otherwise, condition)."""
    then, otherwise, condition = _three(node)
    return either(condition, then, otherwise)


def argument(writer: Writer, node: Node) -> Node:
    """A conversion of type, which changes nothing."""
    return node.args[0]


def remainder(writer: Writer, node: Node) -> Node:
    """Fortran's mod, MATLAB's rem: the remainder of the division towards zero, with the sign of x."""
    x, y = _two(node)
    size = own("mod", own("abs", x), own("abs", y))
    return either(Node(">=", (x, number(0))), size, Node("neg", (size,)))


def with_sign(writer: Writer, node: Node) -> Node:
    """Fortran's sign(a, b): |a| with the sign of b, + at 0."""
    a, b = _two(node)
    size = own("abs", a)
    return either(Node(">=", (b, number(0))), size, Node("neg", (size,)))


def hypotenuse(writer: Writer, node: Node) -> Node:
    """sqrt(x^2 + y^2)."""
    x, y = _two(node)
    return own("sqrt", Node("+", (Node("^", (x, number(2))), Node("^", (y, number(2))))))


def unknown(writer: Writer, node: Node) -> str:
    """A function that has no equal."""
    raise FormulaError(f"the function {node.text} has no equal here")


def _two(node: Node) -> tuple[Node, Node]:
    if len(node.args) != 2:
        raise FormulaError(f"{node.text} takes 2 arguments, got {len(node.args)}")
    return node.args[0], node.args[1]


def _three(node: Node) -> tuple[Node, Node, Node]:
    if len(node.args) != 3:
        raise FormulaError(f"{node.text} takes 3 arguments, got {len(node.args)}")
    return node.args[0], node.args[1], node.args[2]


_BOTH: Final[Mapping[str, Call]] = {
    **dict.fromkeys(SAME - {"sign", "mod", "heaviside", "factorial"}, as_it_is),
    **{name: one_over(other) for name, other in _ONE_OVER.items()},
    "hypot": hypotenuse,
}
MATLAB: Final[Mapping[str, Call]] = {
    **_BOTH,
    "sign": as_it_is,
    "mod": as_it_is,
    "heaviside": as_it_is,
    "factorial": as_it_is,
    "rem": remainder,
    "power": power,
    "choose": choose,
}
_FORTRAN: Final[Mapping[str, Call]] = {
    **_BOTH,
    "sign": with_sign,
    "mod": remainder,
    "modulo": named("mod"),
    "merge": merge,
    "dble": argument,
    "real": argument,
    "float": argument,
}
FORTRAN: Final[Mapping[str, Call]] = {  # with the names of single and double precision
    **_FORTRAN,
    **{f"d{name}": named(name) if found is as_it_is else found for name, found in _FORTRAN.items()},
    **{name: named("max") for name in ("amax1", "dmax1")},
    **{name: named("min") for name in ("amin1", "dmin1")},
    **{f"a{name}": named(name) for name in ("log", "log10")},
    "aint": unknown,
}
