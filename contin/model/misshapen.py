"""What pydantic says about data of another shape, in the words of this project: where, what, what to write instead."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Final

from contin.model.advice import closest
from contin.model.schema import TAGS, shown
from contin.model.source import Path, Problems
from contin.records import Json

_LIMITS: Final = {
    "greater_than_equal": "not below", "less_than_equal": "not above", "greater_than": "above", "less_than": "below",
}  # fmt: skip


def place_of(item: Json) -> Path:
    """Keys and positions that lead to the mistake, without names of variants."""
    return tuple(part for part in item["loc"] if part not in TAGS)


def unknown_key(name: str, allowed: Sequence[str]) -> str:
    """What is said of a key that an entry does not have."""
    advice = closest(name, allowed) or f"allowed are {', '.join(allowed)}"
    return f"unknown key: {advice}"


def note(
    item: Json, problems: Problems, allowed: Callable[[Path], Sequence[str]], examples: Mapping[str, str],
    own: Mapping[str, str] | None = None,
) -> None:  # fmt: skip
    """Add one mistake to `problems`.

    allowed : the keys that the entry at a path may have.  examples : by missing key.  own : words of this shape by the
    kind of mistake, instead of the usual ones.
    """
    path, kind, value = place_of(item), item["type"], item.get("input")
    if own is not None and kind in own:
        problems.add(path, own[kind], key=kind == "extra_forbidden")
    elif kind == "extra_forbidden":
        problems.add(path, unknown_key(str(path[-1]), allowed(path[:-1])), key=True)
    elif kind == "missing":
        example = examples.get(str(path[-1]), "add it")
        problems.add(path[:-1], f"{path[-1]!r} is missing; {example}")
    else:
        problems.add(path, _words(kind, value, str(item["msg"])))


def _words(kind: str, value: Json, message: str) -> str:
    if kind in ("dict_type", "model_type", "model_attributes_type"):
        return f"expected a mapping {{name: value}}, got {shown(value)}"
    if kind == "list_type":
        return f"expected a list [ ... ], got {shown(value)}"
    if kind == "literal_error":
        return f"expected {message.removeprefix('Input should be ')}, got {shown(value)}"
    if kind == "bool_type":
        return f"expected true or false, got {shown(value)}"
    if kind == "too_short":
        return "is empty; at least one entry is needed"
    if kind in _LIMITS:
        return f"expected a number {_LIMITS[kind]} {message.rsplit(' ', 1)[1]}, got {shown(value)}"
    return message
