"""Expressions -> text that `parse` reads back as the identical node.

Parentheses stand only where the grammar needs them; a negative integer power becomes a division and a negative term a
subtraction. The text is emitted bit by bit from an explicit stack: O(length of the text), no recursion.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Final, Union

from contin.errors import InputError
from contin.model.binding import AND, ATOM, COMPARE, NOT, OR, POWER, PRODUCT, SIGN, SUM, TERNARY
from contin.model.expression import COMPARISONS, MINUS_ONE, Expression, Number, number, numeric_value
from contin.model.folding import SHORT_DIGITS, significant_digits

MAX_TEXT: Final = 20_000_000  # characters; shared parts are written out wherever they occur

Fragment = Union[str, tuple[Expression, int]]  # text, or a node with the weakest level it may have without parentheses


@dataclass(frozen=True)
class Alphabet:
    """How formulas are written: a node's level and parts, a name, and what stands around a weaker part."""

    parts: Callable[[Expression], tuple[int, Sequence[Fragment]]]
    name: Callable[[str], str]
    brackets: tuple[str, str]


def to_text(expression: Expression, names: Mapping[Expression, str] | None = None) -> str:
    """The formula as text; nodes that are keys of `names` (definitions, say) are written by that name."""
    return written(expression, names, Alphabet(_parts, str, ("(", ")")))


def written(expression: Expression, names: Mapping[Expression, str] | None, alphabet: Alphabet) -> str:
    """The formula in an alphabet; nodes that are keys of `names` are written by that name."""
    texts: list[str] = []
    length = 0
    stack: list[Fragment] = [(expression, TERNARY)]
    while stack:
        fragment = stack.pop()
        if isinstance(fragment, str):
            texts.append(fragment)
            length += len(fragment)
            if length > MAX_TEXT:
                raise InputError(f"the formula is longer than {MAX_TEXT} characters when it is written out")
            continue
        node, weakest = fragment
        if names and node in names:
            texts.append(alphabet.name(names[node]))
            continue
        level, parts = alphabet.parts(node)
        if level < weakest:
            opening, closing = alphabet.brackets
            parts = [opening, *parts, closing]
        stack.extend(reversed(parts))
    return "".join(texts)


def number_text(value: Number) -> tuple[int, str]:
    """A constant as text, and its level."""
    sign = "-" if value < 0 else ""
    level = SIGN if sign else ATOM
    if isinstance(value, float):
        if value != value:
            return SUM, "1e308*10 - 1e308*10"
        if value in (float("inf"), float("-inf")):
            return PRODUCT, f"{sign}1e308*10"
        return level, repr(value)
    text = finite_decimal(value)
    return (level, text) if text else (PRODUCT, f"{value.numerator}/{value.denominator}")


def finite_decimal(value: Fraction) -> str:
    """The decimal that is exactly `value` if it is short, otherwise an empty text."""
    if value.denominator == 1:
        return str(value.numerator)
    try:
        text = repr(float(value))
    except OverflowError:
        return ""
    return text if significant_digits(text) <= SHORT_DIGITS and Fraction(text) == value else ""


def is_division(node: Expression) -> bool:
    """True for base^-k with a positive integer k, which is written as a division; of a number only where k = 1, since
    1/1e-300^2 would fold to a division by zero."""
    if node.op != "pow" or node.args[1].op != "number":
        return False
    exponent = numeric_value(node.args[1])
    if not isinstance(exponent, Fraction) or exponent.denominator != 1:
        return False
    return exponent == -1 or (exponent < 0 and node.args[0].op != "number")


def signed_terms(node: Expression) -> Iterator[tuple[bool, Expression]]:
    """Terms of a sum as (is it subtracted, what then is added or subtracted)."""
    for term in node.args:
        negative = leading_number(term) < 0
        yield negative, (_negated(term) if negative else term)


def leading_number(node: Expression) -> Number:
    """The numeric factor of a term."""
    if node.op == "number":
        return numeric_value(node)
    if node.op == "mul" and node.args[0].op == "number":
        return numeric_value(node.args[0])
    return Fraction(1)


def _negated(term: Expression) -> Expression:
    return -term


def _parts(node: Expression) -> tuple[int, list[Fragment]]:
    op, args = node.op, node.args
    if op == "number":
        level, text = number_text(numeric_value(node))
        return level, [text]
    if op == "symbol":
        return ATOM, [str(node.value)]
    if op == "pi":
        return ATOM, ["pi"]
    if op == "add":
        return SUM, summed(node)
    if op == "mul":
        negated = len(args) == 2 and args[0] is MINUS_ONE and not is_division(args[1])
        return SIGN if negated else PRODUCT, _product(node)
    if op == "pow":
        return (PRODUCT, ["1", *_factor(node)]) if is_division(node) else (POWER, _power(*args))
    if op == "if":
        condition, then, otherwise = args
        return TERNARY, [(then, OR), " if ", (condition, OR), " else ", (otherwise, TERNARY)]
    if op in COMPARISONS:
        return COMPARE, [(args[0], SUM), f" {op} ", (args[1], SUM)]
    if op == "not":
        return NOT, ["not ", (args[0], NOT)]
    if op in ("and", "or"):
        level = AND if op == "and" else OR
        return level, joined(args, f" {op} ", level + 1)
    return ATOM, [f"{op}(", *joined(_arguments(node), ", ", TERNARY), ")"]


def joined(nodes: Sequence[Expression], separator: str, weakest: int) -> list[Fragment]:
    """Nodes with a separator between them."""
    parts: list[Fragment] = [(nodes[0], weakest)]
    for node in nodes[1:]:
        parts += [separator, (node, weakest)]
    return parts


def _arguments(node: Expression) -> list[Expression]:
    """min(min(a, b), c) is how min(a, b, c) is stored."""
    arguments: list[Expression] = []
    while node.op in ("min", "max") and node.args[0].op == node.op:
        arguments.append(node.args[1])
        node = node.args[0]
    return [*node.args, *reversed(arguments)]


def summed(node: Expression) -> list[Fragment]:
    """A sum with its signs."""
    parts: list[Fragment] = []
    for negative, term in signed_terms(node):
        if parts:
            parts.append(" - " if negative else " + ")
        elif negative:
            parts.append("-")
        parts.append((term, PRODUCT))
    return parts


def _product(node: Expression) -> list[Fragment]:
    coefficient = leading_number(node)
    factors = node.args[1:] if node.args[0].op == "number" else node.args
    parts: list[Fragment] = ["-"] if coefficient < 0 else []
    lead, divisor = _split(-coefficient if coefficient < 0 else coefficient)
    if lead or is_division(factors[0]):
        parts.append(lead or "1")
    for factor in factors:
        part = _factor(factor)
        starts = len(parts) == (1 if coefficient < 0 else 0)
        parts += part if starts or is_division(factor) else ["*", *part]
    return [*parts, f"/{divisor}"] if divisor else parts


def _split(value: Number) -> tuple[str, str]:
    """A positive coefficient as (what stands in front, what divides at the end), each empty if it is 1."""
    if value == 1:
        return "", ""
    if isinstance(value, float):
        text = number_text(value)[1]
        return text, ""
    decimal = finite_decimal(value)
    numerator, denominator = value.numerator, value.denominator
    halves = denominator & (denominator - 1) == 0 and denominator <= 1024
    if decimal and not (halves and denominator > 1 and (numerator == 1 or len(decimal) > 4)):
        return decimal, ""
    return ("" if numerator == 1 else str(numerator)), str(denominator)


def _factor(node: Expression) -> list[Fragment]:
    """A factor, with its '/' where it divides."""
    if not is_division(node):
        return [(node, POWER)]
    base, exponent = node.args
    positive = -numeric_value(exponent)
    if positive == 1:
        return ["/", (base, POWER)]
    return ["/", *_power(base, number(positive))]


def _power(base: Expression, exponent: Expression) -> list[Fragment]:
    return [(base, ATOM), "^", (exponent, SIGN)]
