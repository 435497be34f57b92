"""Text of a formula -> tokens: numbers, names and operators, each with its position."""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass
from fractions import Fraction
from typing import Final

from contin.errors import ExpressionError
from contin.model import features
from contin.model.expression import Expression, number
from contin.model.folding import SHORT_DIGITS, significant_digits

MAX_LENGTH: Final = 1_000_000  # characters of one formula
MAX_NUMBER_LENGTH: Final = 400  # characters of one number
RESERVED: Final = frozenset({"if", "else", "and", "or", "not", "pi"})

_TOKEN: Final = re.compile(
    r"(?P<space>\s+)"
    r"|(?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)"
    r"|(?P<name>[^\W\d]\w*)"
    r"|(?P<op>\*\*|<=|>=|==|!=|[-+*/^<>(),])"
)
_ADVICE: Final = {
    "=": "'=' does not compare; write '=='",
    "&": "write 'and'",
    "|": "write 'or', or abs(x) for an absolute value",
    "!": "write 'not'",
    "%": "write mod(x, y) for a remainder",
    "?": "write 'u if c else v'",
    ":": "write 'u if c else v'",
    ";": "one formula at a time",
    "[": "group with ( )",
    "]": "group with ( )",
    "{": "group with ( )",
    "}": "group with ( )",
    "'": f"formulas have no strings and no primes; {features.RATE}",
    '"': "formulas have no strings",
    "\\": "write names without a backslash: alpha",
    "$": "write names without '$'",
    "@": "write '*'",
    "~": "write 'not'",
    ".": "a name or a number cannot hold a dot here",
    "−": "write '-'",
    "–": "write '-'",
    "×": "write '*'",
    "·": "write '*'",
    "⋅": "write '*'",
    "÷": "write '/'",
    "≤": "write '<='",
    "≥": "write '>='",
    "≠": "write '!='",
    "√": "write sqrt(x)",
    "²": "write ^2",
    "³": "write ^3",
    "∞": "infinity is not a number here",
    "#": "a comment needs a space before '#'",
}


@dataclass(frozen=True, slots=True)
class Token:
    """`kind` is 'number', 'name', 'op' or 'end'; `value` is the node of a number."""

    kind: str
    text: str
    position: int
    value: Expression | None = None


def canonical_name(text: str) -> str:
    """The one spelling of a name that has several in Unicode (the micro sign and the Greek mu are the same letter)."""
    return text if text.isascii() else unicodedata.normalize("NFKC", text)


def is_name(text: str) -> bool:
    """True where `text` is one name: letters, digits and underscores, not starting with a digit, not reserved."""
    return text.isidentifier() and canonical_name(text) == text and text not in RESERVED


def tokenize(text: str) -> list[Token]:
    """Tokens of a formula, closed by one of kind 'end'. Linear in the length of the text."""
    if len(text) > MAX_LENGTH:
        raise ExpressionError(f"{len(text)} characters in one formula; {MAX_LENGTH} are allowed: use definitions")
    tokens: list[Token] = []
    position = 0
    while position < len(text):
        match = _TOKEN.match(text, position)
        if match is None:
            raise _unknown_character(text, position)
        kind, word = str(match.lastgroup), match.group()
        if kind == "number":
            tokens.append(Token(kind, word, position, decimal(word, position)))
        elif kind == "name":
            tokens.append(Token(kind, _checked_name(word, position), position))
        elif kind == "op":
            tokens.append(Token(kind, "^" if word == "**" else word, position))
        position = match.end()
    tokens.append(Token("end", "", len(text)))
    return tokens


def decimal(text: str, position: int = 0) -> Expression:
    """The node of a decimal literal: exact up to `SHORT_DIGITS` significant digits and for integers, else a double."""
    if len(text) > MAX_NUMBER_LENGTH:
        raise ExpressionError(f"a number of {len(text)} characters; {MAX_NUMBER_LENGTH} are allowed", position)
    rounded = float(text)
    if rounded in (float("inf"), float("-inf")):
        shown = text if len(text) <= 40 else f"a number of {len(text)} characters"
        raise ExpressionError(f"{shown} is too large for double precision (largest: 1.8e308)", position)
    if rounded == 0.0:
        if significant_digits(text):
            raise ExpressionError(f"{text} is too small for double precision (smallest: 4.9e-324); write 0", position)
        return number(0)
    if text.isdigit():
        return number(int(text))
    if significant_digits(text) <= SHORT_DIGITS:
        return number(Fraction(text))
    return number(rounded)


_OF_LIBRARIES: Final = re.compile(r"(?<![\w.])(np|numpy|math|scipy|sympy|sp|cmath|torch|jnp|jax)\Z")
_NO_NUMBER: Final = re.compile(r"\.(inf|nan)\b", re.IGNORECASE)  # as YAML writes infinity
_WORD: Final = re.compile(r"[^\W\d]\w*\(?")


def _checked_name(word: str, position: int) -> str:
    if not word.isidentifier():  # \w also matches superscripts and the like
        bad = next(i for i in range(1, len(word) + 1) if not word[:i].isidentifier()) - 1
        raise _unknown_character(word, bad, position)
    return canonical_name(word)


def _unknown_character(text: str, position: int, offset: int = 0) -> ExpressionError:
    character = text[position]
    shown = character if character.isprintable() else f"U+{ord(character):04X}"
    before = text[:position]
    if character == "." and before and (before[-1].isalnum() or before[-1] == "_"):
        after = _WORD.match(text[position + 1 :])
        if after and _OF_LIBRARIES.search(before):
            instead = f"{after[0]}x)" if after[0].endswith("(") else after[0]
            return ExpressionError(f"functions stand without their library: write {instead}", offset + position)
        return ExpressionError("names may not contain a dot; write an underscore: a_b", offset + position)
    if _NO_NUMBER.match(text[position:]):
        shown = text[position : position + 4]
        return ExpressionError(f"{shown} is no number here: write a finite one", offset + position)
    past = features.of_brackets(text[position:])
    if past:
        return ExpressionError(f"a value at another time: {past}", offset + position)
    advice = _ADVICE.get(character, "allowed are numbers, names, + - * / ^ ( ) , < <= > >= == != and or not if else")
    return ExpressionError(f"unexpected character {shown!r}: {advice}", offset + position)
