"""What formulas look like in another language."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final

COMMON: Final[Mapping[str, str]] = {
    "expm1": "(exp({0}) - {one})",
    "log1p": "log({one} + ({0}))",
}  # where a language has no function of its own


@dataclass(frozen=True)
class Language:
    """Templates with {0}, {1} for the arguments, each a whole formula (so in parentheses where it may need them).

    number : a decimal literal of a non-negative double.  functions : functions whose template is not name({0}, ...).
    compare : comparisons.  longest : characters of one formula; a longer one is split.  named : intermediate results
    can be assigned to names before they are used; False in a language of single formulas.
    """

    number: Callable[[float], str]
    power: str
    conditional: str
    compare: Mapping[str, str]
    logic: Mapping[str, str]
    functions: Mapping[str, str]
    pi: str
    longest: int = 2_000
    missing: frozenset[str] = frozenset()


def decimal(value: float) -> str:
    """The shortest decimal that is this double."""
    text = repr(value)
    return text.removesuffix(".0") if "e" not in text else text


def fifteen(value: float) -> str:
    """The same in decimals of 15 digits, which is what libSBML writes: the second term is what the first leaves."""
    short = float(f"{value:.15g}")
    return decimal(value) if short == value else f"({short:.15g} + ({value - short:.15g}))"


PLAIN_COMPARE: Final = {op: f"({{0}}) {op} ({{1}})" for op in ("<", "<=", ">", ">=", "==", "!=")}

XPP: Final = Language(  # comparisons bind like powers there, so that everything stands in parentheses
    number=decimal,
    power="{0}^{1}",
    conditional="if({0})then({1})else({2})",
    compare={op: f"(({{0}}){op}({{1}}))" for op in ("<", "<=", ">", ">=", "==", "!=")},
    logic={"and": "(({0})&({1}))", "or": "(({0})|({1}))", "not": "not({0})"},
    functions={
        **COMMON,
        "log1p": "ln({one} + ({0}))",
        "log": "ln({0})",
        "heaviside": "(heav({0}) - .5*(1 - abs(sign({0}))))",
        "floor": "flr({0})",
        "ceil": "(-flr(-({0})))",
        "mod": "(({0}) - ({1})*flr(({0})/({1})))",
        "asinh": "ln(({0}) + sqrt(({0})^2 + 1))",
        "acosh": "ln(({0}) + sqrt(({0})^2 - 1))",
        "atanh": "(.5*ln((1 + ({0}))/(1 - ({0}))))",
    },
    pi="pi",
    longest=400,
    missing=frozenset({"factorial"}),
)

FORTRAN: Final = Language(
    number=lambda value: decimal(value).replace("e", "d") + ("" if "e" in decimal(value) else "d0"),
    power="{0}**{1}",
    conditional="merge({1}, {2}, {0})",
    compare={**PLAIN_COMPARE, "!=": "({0}) /= ({1})"},
    logic={"and": "({0}) .and. ({1})", "or": "({0}) .or. ({1})", "not": ".not. ({0})"},
    functions={
        **COMMON,
        "sign": "(merge(1d0, 0d0, ({0}) > 0d0) - merge(1d0, 0d0, ({0}) < 0d0))",
        "heaviside": "(0.5d0*(merge(1d0, 0d0, ({0}) > 0d0) + merge(1d0, 0d0, ({0}) >= 0d0)))",
        "floor": "(({0}) - modulo({0}, 1d0))",
        "ceil": "(({0}) + modulo(-({0}), 1d0))",
        "mod": "modulo({0}, {1})",
        "factorial": "anint(gamma(({0}) + 1d0))",
    },
    pi="3.141592653589793d0",
    longest=1_500,
)

MATLAB: Final = Language(
    number=decimal,
    power="{0}^{1}",
    conditional="choose({0}, {1}, {2})",
    compare={**PLAIN_COMPARE, "!=": "({0}) ~= ({1})"},
    logic={"and": "(({0}) && ({1}))", "or": "(({0}) || ({1}))", "not": "~({0})"},
    functions={"heaviside": "(0.5*(1 + sign({0})))"},
    pi="pi",
)

JULIA: Final = Language(
    number=lambda value: repr(value),
    power="{0}^{1}",
    conditional="(({0}) ? ({1}) : ({2}))",
    compare=PLAIN_COMPARE,
    logic={"and": "(({0}) && ({1}))", "or": "(({0}) || ({1}))", "not": "!({0})"},
    functions={"heaviside": "(0.5*(1 + sign({0})))", "atan2": "atan({0}, {1})", "factorial": "prod(1.0:({0}))"},
    pi="π",
)

SBML: Final = Language(  # formulas of libSBML's level 3 grammar
    number=fifteen,
    power="pow({0}, {1})",
    conditional="piecewise({1}, {0}, {2})",
    compare=PLAIN_COMPARE,
    logic={"and": "({0}) && ({1})", "or": "({0}) || ({1})", "not": "!({0})"},
    functions={
        "expm1": "(exp({0}) - 1)",
        "log1p": "ln(1 + ({0}))",
        "log": "ln({0})",
        "asin": "arcsin({0})",
        "acos": "arccos({0})",
        "atan": "arctan({0})",
        "asinh": "arcsinh({0})",
        "acosh": "arccosh({0})",
        "atanh": "arctanh({0})",
        "sign": "piecewise(1, ({0}) > 0, -1, ({0}) < 0, 0)",
        "heaviside": "piecewise(1, ({0}) > 0, 0, ({0}) < 0, 0.5)",
        "min": "piecewise({0}, ({0}) < ({1}), {1})",
        "max": "piecewise({0}, ({0}) > ({1}), {1})",
        "mod": "(({0}) - ({1})*floor(({0})/({1})))",
        "atan2": "piecewise(arctan(({0})/({1})), ({1}) > 0, arctan(({0})/({1})) + pi, (({1}) < 0) && (({0}) >= 0), "
        "arctan(({0})/({1})) - pi, ({1}) < 0, pi/2, ({0}) > 0, -pi/2, ({0}) < 0, 0)",
    },
    pi="pi",
    longest=20_000,
)
