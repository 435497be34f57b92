"""Which unknown functions of a connection with a cycle are the parts of one vector, and how small a part may count."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from contin.abi import Array

PART = 1e-3  # of a mode, in the states' sizes


def vectors(names: Sequence[str]) -> Iterator[tuple[int, list[tuple[int, int]]]]:
    """Functions that are the parts of one vector, with the places of the states that they belong to.

    Before them 1 where they are measured as the states are, -1 where in the inverse of that (adjoint modes).
    """
    groups: dict[tuple[int, str], list[tuple[int, int]]] = {}
    states = [name for name in names if ":" not in name]
    for k, name in enumerate(names):
        first, _, end = name.partition(":")
        if end.startswith("w"):
            groups.setdefault((-1, end), []).append((k, names.index(first)))
        elif end.startswith("saddle"):
            groups[1, name] = [(k, names.index(first)), (names.index(first), names.index(first))]
        elif first.startswith("v") and end in ("1", "2"):  # a basis's: nothing else is a number after the colon
            row, column = first[1:-1], first[-1]
            groups.setdefault((1, f"v{column}:{end}"), []).append((k, names.index(states[int(row)])))
    for (power, _), pairs in groups.items():
        yield power, pairs


def with_parts(sizes: Array, seen: Array, names: Sequence[str]) -> Array:
    """No part of a vector is smaller than a part of the whole, of which `seen` are the largest values."""
    sizes = sizes.copy()
    for power, pairs in vectors(names):
        own, of = np.array([k for k, _ in pairs]), np.array([j for _, j in pairs])
        units = sizes[of] ** power
        sizes[own] = np.maximum(sizes[own], PART * float(np.max(seen[own] / units)) * units)
    return sizes
