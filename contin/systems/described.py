"""States in words: by name, or how many there are and their extremes where they have none (fields, large functions)."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from contin.abi import Array


def states_in_words(names: Sequence[str], u: Array, one: Callable[[int], str]) -> str:
    """`name` and `one(k)` of every state; of states u (..., n) without names, their number, least and largest value."""
    if names:
        return ", ".join(f"{name} {one(k)}" for k, name in enumerate(names))
    return f"of {u.shape[-1]} states in [{float(np.min(u)):.6g}, {float(np.max(u)):.6g}]"
