"""Expressions -> LaTeX mathematics (without the surrounding dollar signs)."""

from __future__ import annotations

import re
from collections.abc import Mapping
from fractions import Fraction
from typing import Final

from contin.model.binding import AND, ATOM, COMPARE, NOT, OR, POWER, PRODUCT, SIGN, SUM, TERNARY
from contin.model.expression import COMPARISONS, Expression, Number, number, numeric_value
from contin.model.printing import (
    Alphabet,
    Fragment,
    finite_decimal,
    is_division,
    joined,
    leading_number,
    summed,
    written,
)

_GREEK: Final = frozenset(
    "alpha beta gamma delta epsilon varepsilon zeta eta theta vartheta iota kappa lambda mu nu xi pi rho sigma tau "
    "upsilon phi varphi chi psi omega Gamma Delta Theta Lambda Xi Pi Sigma Upsilon Phi Psi Omega".split()
)
_OPERATORS: Final = {
    "asin": r"\arcsin", "acos": r"\arccos", "atan": r"\arctan", "log10": r"\log_{10}", "log": r"\ln",
    "asinh": r"\operatorname{arsinh}", "acosh": r"\operatorname{arcosh}", "atanh": r"\operatorname{artanh}",
}  # fmt: skip
_PLAIN: Final = frozenset("sin cos tan sinh cosh tanh min max".split())
_AROUND: Final = {
    "abs": (r"\left|", r"\right|"),
    "floor": (r"\left\lfloor ", r" \right\rfloor"),
    "ceil": (r"\left\lceil ", r" \right\rceil"),
}
_RELATIONS: Final = {"<": "<", "<=": r"\le", ">": ">", ">=": r"\ge", "==": "=", "!=": r"\ne"}


def to_latex(expression: Expression, names: Mapping[Expression, str] | None = None) -> str:
    """The formula in LaTeX; nodes that are keys of `names` are written by that name."""
    return written(expression, names, Alphabet(_parts, latex_name, (r"\left(", r"\right)")))


def latex_name(name: str) -> str:
    """beta -> \\beta, r1 -> r_{1}, v_x -> v_{x}, Vmax -> \\mathrm{Vmax}"""
    match = re.fullmatch(r"([^\W\d_]+)_?(\w*)", name)
    if match is None:
        return rf"\mathrm{{{_escaped(name)}}}"
    stem, index = match.groups()
    if stem in ("eps", "epsilon"):
        stem = "varepsilon"
    shown = f"\\{stem}" if stem in _GREEK else stem if len(stem) == 1 else rf"\mathrm{{{stem}}}"
    if not index:
        return shown
    short = len(index) == 1 or index.isdigit()
    below = f"\\{index}" if index in _GREEK else index if short else rf"\mathrm{{{_escaped(index)}}}"
    return f"{shown}_{{{below}}}"


def _escaped(text: str) -> str:
    return text.replace("_", r"\_")


def _number(value: Number) -> tuple[int, str]:
    sign, size = ("-", -value) if value < 0 else ("", value)
    level = SIGN if sign else ATOM
    if isinstance(size, Fraction):
        text = finite_decimal(size)
        if not text or (size.denominator in (2, 4, 8, 16, 32, 64)):
            if size.denominator == 1:
                return level, f"{sign}{size.numerator}"
            return level if sign else POWER, rf"{sign}\frac{{{size.numerator}}}{{{size.denominator}}}"
    else:
        text = repr(size)
    mantissa, e, exponent = text.partition("e")
    if e:
        power = f"10^{{{int(exponent)}}}"
        return POWER, sign + (power if mantissa == "1" else rf"{mantissa} \cdot {power}")
    return level, sign + text.replace("inf", r"\infty")


def _parts(node: Expression) -> tuple[int, list[Fragment]]:
    op, args = node.op, node.args
    if op == "number":
        level, text = _number(numeric_value(node))
        return level, [text]
    if op == "symbol":
        return ATOM, [latex_name(str(node.value))]
    if op == "pi":
        return ATOM, [r"\pi"]
    if op == "add":
        return SUM, summed(node)
    if op == "mul" or is_division(node):
        return _product(node)
    if op == "pow":
        return _power(*args)
    if op == "if":
        return TERNARY, _cases(node)
    if op in COMPARISONS:
        return COMPARE, [(args[0], SUM), f" {_RELATIONS[op]} ", (args[1], SUM)]
    if op == "not":
        return NOT, [r"\text{not } ", (args[0], NOT)]
    if op in ("and", "or"):
        level = AND if op == "and" else OR
        word = r" \text{ " + op + " } "
        return level, joined(args, word, level + 1)
    return _call(node)


def _call(node: Expression) -> tuple[int, list[Fragment]]:
    op, args = node.op, node.args
    if op == "sqrt":
        return ATOM, [r"\sqrt{", (args[0], TERNARY), "}"]
    if op == "exp":
        return POWER, ["e^{", (args[0], TERNARY), "}"]
    if op in _AROUND:
        before, after = _AROUND[op]
        return ATOM, [before, (args[0], TERNARY), after]
    if op == "factorial":
        return POWER, [(args[0], ATOM), "!"]
    if op == "mod":
        return PRODUCT, [(args[0], POWER), r" \bmod ", (args[1], POWER)]
    if op in _PLAIN:
        head = f"\\{op}"
    else:
        head = _OPERATORS.get(op, rf"\operatorname{{{op}}}")
    return ATOM, [head, r"\left(", *joined(args, ", ", TERNARY), r"\right)"]


def _cases(node: Expression) -> list[Fragment]:
    parts: list[Fragment] = [r"\begin{cases} "]
    while node.op == "if":
        condition, then, otherwise = node.args
        parts += [(then, TERNARY), r" & \text{if } ", (condition, TERNARY), r" \\ "]
        node = otherwise
    return [*parts, (node, TERNARY), r" & \text{otherwise} \end{cases}"]


def _product(node: Expression) -> tuple[int, list[Fragment]]:
    """Numerators over denominators; a single sum in the numerator or denominator needs no parentheses."""
    factors = node.args if node.op == "mul" else (node,)
    coefficient = leading_number(node)
    if factors[0].op == "number":
        factors = factors[1:]
    above = [f for f in factors if not is_division(f)]
    below = [_inverse(f) for f in factors if is_division(f)]
    sign = "-" if coefficient < 0 else ""
    size = -coefficient if coefficient < 0 else coefficient
    top: Number = size
    bottom = 1
    if isinstance(size, Fraction) and (below or not finite_decimal(size) or size.denominator in (2, 4, 8, 16, 32, 64)):
        top, bottom = Fraction(size.numerator), size.denominator
    if bottom != 1:
        below = [number(bottom), *below]
    if top != 1 or not above:
        above = [number(top), *above]
    if not below:
        return PRODUCT, [sign, *_factors(above)]
    return PRODUCT, [sign, r"\frac{", *_alone(above), "}{", *_alone(below), "}"]


def _inverse(node: Expression) -> Expression:
    base, exponent = node.args
    return base ** number(-numeric_value(exponent))


def _alone(factors: list[Expression]) -> list[Fragment]:
    return [(factors[0], TERNARY)] if len(factors) == 1 else _factors(factors)


def _factors(factors: list[Expression]) -> list[Fragment]:
    parts: list[Fragment] = []
    for i, factor in enumerate(factors):
        if i:
            parts.append(r" \cdot " if factor.op == "number" else " ")
        parts.append((factor, POWER))
    return parts


def _power(base: Expression, exponent: Expression) -> tuple[int, list[Fragment]]:
    if exponent.op == "number" and numeric_value(exponent) == Fraction(1, 2):
        return ATOM, [r"\sqrt{", (base, TERNARY), "}"]
    return POWER, [(base, ATOM), "^{", (exponent, TERNARY), "}"]
