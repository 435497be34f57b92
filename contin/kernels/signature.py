"""The types of kernels, written as text beside each of them: "i, b, f, f1, i2, Points -> i".

    i  int64      u  uint64      f  float64      b  bool      c  complex128
    i1, f2, ...   C-contiguous arrays with that many axes
    Points, ...   a structure: a named tuple whose class was declared by `structure`
    (i, f)        a tuple, as a result

What follows the arrow is the result; a kernel without an arrow returns nothing. Stated types let every kernel be
compiled by itself, in any order and in several processes at once: what calls it needs its text alone.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any, Final

SCALARS: Final = "iufbc"


@dataclass(frozen=True)
class Scalar:
    code: str


@dataclass(frozen=True)
class Array:
    code: str  # of an entry
    axes: int


@dataclass(frozen=True)
class Tuple:
    items: tuple[Type, ...]
    kind: type | None = None
    """The class, where it is a named tuple."""


Type = Scalar | Array | Tuple


@dataclass(frozen=True)
class Signature:
    arguments: tuple[Type, ...]
    result: Type | None


_structures: dict[str, Tuple] = {}


def structure(kind: type, fields: str) -> None:
    """Declare the types of a named tuple's fields, in order. Its name then stands for it in signatures."""
    items = parse(fields).arguments
    names: tuple[str, ...] = kind._fields  # type: ignore[attr-defined]
    if len(names) != len(items):
        raise TypeError(f"{kind.__name__} has {len(names)} fields and {len(items)} types")
    if kind.__name__ in _structures:
        raise TypeError(f"two structures are called {kind.__name__}")
    _structures[kind.__name__] = Tuple(items, kind)


def parse(text: str) -> Signature:
    """The types that a signature's text states."""
    left, arrow, right = text.partition("->")
    result = _one(right.strip()) if arrow else None
    return Signature(tuple(_one(word) for word in _split(left)), result)


def _split(text: str) -> list[str]:
    return [word for word in (part.strip() for part in re.split(r",(?![^(]*\))", text)) if word]


def _one(word: str) -> Type:
    if word.startswith("("):
        return Tuple(tuple(_one(item) for item in _split(word[1:-1])))
    if word in _structures:
        return _structures[word]
    if len(word) == 1 and word in SCALARS:
        return Scalar(word)
    if len(word) == 2 and word[0] in SCALARS and word[1].isdigit():
        return Array(word[0], int(word[1]))
    raise TypeError(f"no kernel has an argument of type {word!r}; structures: {', '.join(_structures)}")


def words(kind: Type) -> int:
    """64-bit words that a value takes in a call: an array its address, its shape and its strides."""
    if isinstance(kind, Scalar):
        return 2 if kind.code == "c" else 1
    if isinstance(kind, Array):
        return 1 + 2 * kind.axes
    return sum(words(item) for item in kind.items)


def describe(value: Any) -> str:
    """What a value is, in the words of a signature, for messages."""
    dtype = getattr(value, "dtype", None)
    if dtype is not None and value.ndim:
        order = "" if value.flags.c_contiguous else ", not contiguous"
        return f"array of {dtype}, {value.ndim} axes{order}"
    return type(value).__name__
