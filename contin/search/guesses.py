"""Guesses of further solutions, made of those that are known: moved, mirrored, or with a window of another one.

Solutions with layers and spikes differ from each other by what happens in a part of the domain. Where two known ones
are put together, a window of one inside the other, Newton's method often leads to a third one within ten steps, to
which neither of the two leads. Windows are intervals of the numbering of unknowns: parts of an interval, strips of a
rectangle.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from contin.abi import Array
from contin.linalg.vectors import norm
from contin.machine import elementary

MOVED: Final = (1e-2, 0.1, -0.1, 0.5, -0.5, 0.5)  # sizes, by which guesses are moved off what is deflated
WAVES: Final = 5
PART_MOVED: Final = 0.3  # of the guesses with a window, and sizes by which they are moved besides


def moved(guess: Array, size: float, rng: np.random.Generator) -> Iterator[Array]:
    """A guess moved a little in several directions."""
    for part in MOVED:
        yield guess + part * size * _smooth(rng, len(guess)) / np.sqrt(len(guess))


def images(guess: Array) -> Iterator[Array]:
    """Its mirror image in the numbering of unknowns, its negative, and both: solutions of symmetric equations."""
    yield guess[::-1].copy()
    yield -guess
    yield -guess[::-1]


def with_window(known: Sequence[Array], size: float, rng: np.random.Generator) -> Array:
    """A known solution, or its mirror image, with a window of another one."""
    outside, inside = (_either_way(known[k], rng) for k in rng.integers(len(known), size=2))
    n = len(outside)
    first, last = np.sort(rng.integers(n + 1, size=2))
    guess = outside.copy()
    guess[first:last] = inside[first:last]
    if rng.random() < PART_MOVED or len(known) == 1:
        guess = guess + PART_MOVED * size * _smooth(rng, n) / np.sqrt(n)
    return guess


def _either_way(u: Array, rng: np.random.Generator) -> Array:
    return u[::-1] if rng.random() < 0.5 else u


def _smooth(rng: np.random.Generator, n: int) -> Array:
    """A direction that is no symmetry's: a few random waves over the numbering of unknowns, of root mean square 1."""
    k = np.arange(1.0, n + 1.0) / (n + 1.0)
    total = np.zeros(n)
    for mode in np.arange(1, WAVES + 1):
        total += rng.normal() * elementary.sin(np.pi * mode * k)
    return np.asarray(total / max(norm(total) / np.sqrt(n), 1e-300))
