"""XPP's formulas: what its program was seen to do (version 6.11), which its documentation leaves open.

Operators of one row are read from the left: 2^3^2 is 64. Comparisons bind as tightly as powers, so that x>2*y is
(x>2)*y and 1-x<2 is 1-(x<2); & binds like *, | like +; a sign binds less than a power and a comparison: -x^2 = -(x^2).
"""

from __future__ import annotations

import re
from typing import Final

from contin.exchange.formulas.parser import Binary, Dialect, Parser, Prefix
from contin.exchange.formulas.tree import ARITHMETIC, COMPARISONS, Node, walk

_SUM, _PRODUCT, _POWER = 1, 2, 3
INDEX: Final = "i'"  # of sum(..)of(..)

# what a formula may not contain, by the word that brings it
REFUSED: Final = {
    "delay": "delays",
    "del_shft": "delays",
    "delshft": "delays",
    "ran": "random numbers",
    "normal": "random numbers",
    "poisson": "random numbers",
    "erf": "the error function",
    "erfc": "the error function",
    "besselj": "Bessel functions",
    "bessely": "Bessel functions",
    "besseli": "Bessel functions",
    "bessel_j": "Bessel functions",
    "bessel_y": "Bessel functions",
    "lgamma": "the gamma function",
    "hom_bcs": "boundary conditions of connecting orbits",
}


def _if(parser: Parser) -> Node:
    condition = parser.bracketed()
    parser.expect("then")
    then = parser.bracketed()
    parser.expect("else")
    return Node("if", (condition, then, parser.bracketed()))


def _sum(parser: Parser) -> Node:
    limits = parser.arguments()
    if len(limits) != 2:
        raise parser.error("a sum is written sum(first,last)of(term)")
    parser.expect("of")
    return Node("sum", (*limits, parser.bracketed()))


XPP: Final = Dialect(
    tokens=re.compile(
        r"(?P<space>\s+)|(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|(?P<name>i'|[A-Za-z_][\w.$@]*)"
        r"|(?P<op>\*\*|<=|>=|==|!=|[-+*/^<>&|(),])",
        re.IGNORECASE | re.ASCII,
    ),
    binary={
        "+": Binary(_SUM, "+"),
        "-": Binary(_SUM, "-"),
        "|": Binary(_SUM, "or"),
        "*": Binary(_PRODUCT, "*"),
        "/": Binary(_PRODUCT, "/"),
        "&": Binary(_PRODUCT, "and"),
        "^": Binary(_POWER, "^"),
        "**": Binary(_POWER, "^"),
        **{op: Binary(_POWER, op) for op in COMPARISONS},
    },
    prefix={"-": Prefix(_POWER, "neg"), "+": Prefix(_POWER, ""), "not": Prefix(_POWER + 1, "not")},
    special={"if": _if, "sum": _sum},
)


def surprising(node: Node) -> Node | None:
    """A comparison that XPP takes for an operand of arithmetic though nothing is put in parentheses."""
    for found in walk(node):
        if found.kind in ARITHMETIC:
            for arg in found.args:
                if arg.kind in COMPARISONS and not arg.bracketed:
                    return arg
    return None
