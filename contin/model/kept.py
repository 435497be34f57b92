"""What is made once for an object and may refer to it: it is freed together with the object.

A weak dictionary whose values hold their own keys frees nothing; an attribute of the owner makes a cycle, which the
collector frees.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Final, TypeVar

T = TypeVar("T")

NAME: Final = "_kept"


class Kept:
    """Things by name; copies and pickles of the owner begin with none of them."""

    def __init__(self) -> None:
        self.things: dict[Hashable, object] = {}

    def __reduce__(self) -> tuple[type[Kept], tuple[()]]:
        return Kept, ()


def kept_with(owner: object, key: Hashable, make: Callable[[], T]) -> T:
    """`make()`, made when it is first asked for under this key, and kept for as long as `owner` lives.

    For an object that takes no attributes it is made anew each time.
    """
    kept: Kept | None = getattr(owner, "__dict__", {}).get(NAME)
    if kept is None:
        kept = Kept()
        try:
            object.__setattr__(owner, NAME, kept)
        except (AttributeError, TypeError):
            return make()
    if key not in kept.things:
        kept.things[key] = make()
    return kept.things[key]  # type: ignore[return-value]
