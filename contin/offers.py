"""Which optional members a class has."""

from __future__ import annotations

from functools import cache


@cache
def offers(kind: type, name: str) -> bool:
    """Whether a class has a member of this name; asked once a class: `isinstance` of a protocol takes 0.1 ms a time."""
    return any(name in base.__dict__ for base in kind.__mro__)
