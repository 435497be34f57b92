"""The group that the declared symmetries of a model generate, as words: `a*b` is first b, then a.

Two words are one element where they move a generic state alike (angles modulo their periods). Of a group of more than
`MOST` elements, or an infinite one, only words of one and two letters are taken: `cut_off` tells.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.model.kept import kept_with

if TYPE_CHECKING:
    from contin.systems.protocol import System

MOST: Final = 120  # elements: all permutations of five
SAME: Final = 1e-9  # relative distance of two images that are one


def group_words(system: System) -> tuple[str, ...]:
    """Its elements but the identity: the declared symmetries, then shortest words in them."""
    return _group(system)[0]


def cut_off(system: System) -> bool:
    """True where there are more than `MOST` elements."""
    return _group(system)[1]


def moved(system: System, word: str, u: Array, p: Array) -> Array:
    """Images of rows u (N, n) under a word; p (p_size,) or (N, p_size)."""
    rows = np.ascontiguousarray(u)
    for part in reversed(word.split("*")):
        rows = np.ascontiguousarray(system.symmetry(part, rows, p))
    return rows


def group_note(system: System) -> tuple[str, ...]:
    """What to say where the group was cut off."""
    if not cut_off(system):
        return ()
    return (
        f"the declared symmetries generate more than {MOST} substitutions: images under products of more than "
        "two are not recognised, and may be computed and counted as states of their own",
    )


def _group(system: System) -> tuple[tuple[str, ...], bool]:
    if not system.model.symmetries:
        return (), False
    return kept_with(system.model, "symmetry group", lambda: _generated(system))


def _generated(system: System) -> tuple[tuple[str, ...], bool]:
    """Breadth first from the declared ones, those kept whatever they do."""
    names = tuple(s.name for s in system.model.symmetries)
    periods = np.asarray(system.model.periods(), dtype=float)
    values = system.model.default_parameters()
    p = np.zeros(system.p_size)
    p[: len(system.parameter_names)] = [values[name] for name in system.parameter_names]
    generic = np.random.default_rng(17).uniform(0.5, 1.5, (1, system.n))
    known = [generic[0]]
    words, layer = list(names), []
    for name in names:
        image = moved(system, name, generic, p)[0]
        layer.append((name, image))
        known.append(image)
    while layer:
        longer: list[tuple[str, Array]] = []
        for first in names:
            for word, at in layer:
                image = moved(system, first, at[None], p)[0]
                if any(_alike(image, other, periods) for other in known):
                    continue
                if len(words) >= MOST - 1:
                    return tuple(word for word in words if word.count("*") < 2), True
                known.append(image)
                words.append(f"{first}*{word}")
                longer.append((words[-1], image))
        layer = longer
    return tuple(words), False


def _alike(a: Array, b: Array, periods: Array) -> bool:
    gap = a - b
    angles = periods > 0.0
    gap[angles] -= periods[angles] * np.round(gap[angles] / periods[angles])
    return bool(np.all(np.abs(gap) <= SAME * np.maximum(1.0, np.abs(b))))
