"""Which steps of a branch the slopes at their rows do not explain, or leave next to nothing of a state.

Of resolved steps a thousandth of a change is not explained, of those to another branch a fifth and more.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.kernels.rows_in_doubt import EPSILON, NEXT, REMNANT, STRAY, UNEXPLAINED
from contin.linalg.vectors import norm

SHORT: Final = 1024  # unknowns: differences of all rows at once; longer ones row by row, in less memory


@dataclass(frozen=True, eq=False)
class Lengths:
    """Of rows y with tangents t as a whole, where some of their unknowns are looked at."""

    tangents: Array  # (K,)
    steps: Array  # (K - 1,) to the next row, ...
    ways: Array  # ... and to the one that a few steps lead to
    slopes: Array  # (K,) of the parameter

    @classmethod
    def of(cls, y: Array, t: Array) -> Lengths:
        far, slopes = _ahead(len(y)), t[:, -1:].copy()
        if y.shape[1] <= SHORT:
            steps, ways = np.linalg.norm(np.diff(y, axis=0), axis=1), np.linalg.norm(y[far] - y[:-1], axis=1)
            return cls(np.linalg.norm(t, axis=1), steps, ways, slopes)
        ways = np.array([norm(y[there] - y[k]) for k, there in enumerate(far.tolist())])
        steps = np.array([norm(b - a) for a, b in pairwise(y)])
        return cls(np.array([norm(row) for row in t]), steps, ways, slopes)


def _ahead(rows: int) -> NDArray[np.intp]:
    return np.minimum(np.arange(rows - 1) + NEXT, rows - 1)


def suspicious(
    y: Array, t: Array, noise: float | Array, alone: Callable[[Array], Array] = np.abs, whole: Lengths | None = None
) -> Array:
    """(K - 1, k), of rows y with tangents t: which part of a step is not what slopes lead to, 0 where it may pass.

    noise : what is not known of rows, or (K - 1, 1) of steps.
    alone : lengths (K, k) of what is asked by itself, of values (K, N): each unknown, or each function.
    whole : where y and t are a part of all unknowns.
    """
    far, whole = _ahead(len(y)), whole or Lengths.of(y, t)
    return np.maximum(_unexplained(y, t, noise, alone, whole), _vanishing(y, t, far, noise, alone, whole))


def _unexplained(y: Array, t: Array, noise: float | Array, alone: Callable[[Array], Array], whole: Lengths) -> Array:
    """Where the parameter goes one way, and an unknown not as its slopes say."""
    t = t / whole.tangents[:, None]
    step, slopes = y[1:] - y[:-1], alone(t)
    h, moved, steep = whole.steps[:, None], alone(step), np.maximum(slopes[1:], slopes[:-1])
    apart = _part(alone(step - 0.5 * h * (t[1:] + t[:-1])), np.maximum(steep * h, moved), UNEXPLAINED)
    bend = (t[1:] - t[:-1]) / np.where(h > 0.0, h, 1.0)
    if len(bend) > 1:
        turned = _part(alone(bend[1:] - bend[:-1]) * h[1:], steep[1:], STRAY)
        apart[1:] = np.maximum(apart[1:], UNEXPLAINED / STRAY * turned)
    return np.asarray(apart * ((moved > noise) & (whole.slopes[1:] * whole.slopes[:-1] > 0.0)))


def _part(left: Array, whole: Array, least: float) -> Array:
    """left / whole, 0 where that is less than `least`."""
    sure = left > least * whole
    return np.asarray(np.where(sure, left / np.where(sure & (whole > 0.0), whole, 1.0), 0.0))


def _vanishing(
    y: Array, t: Array, ahead: NDArray[np.intp], noise: float | Array, alone: Callable[[Array], Array], whole: Lengths
) -> Array:  # fmt: skip
    """Of points and others a few rows on: where the slopes do not lead to how little is left, of unknowns or of slopes
    that would have changed them by more than noise."""
    near, far, t_near, t_far = y[:-1], y[ahead], t[:-1], t[ahead]
    moved, before, steep, level = far - near, alone(near), alone(t_near), alone(t_far)
    length = whole.ways[:, None]
    left = np.maximum(alone(moved - length * t_far), alone(moved - 0.5 * length * (t_near + t_far)))
    little = _part(left, before, UNEXPLAINED) * ((alone(far) < REMNANT * before) & (before > EPSILON))
    flat = _part(left, length * steep, UNEXPLAINED) * (level < REMNANT * steep)
    flat *= (length * steep > noise) & (whole.slopes[ahead] * whole.slopes[:-1] > 0.0)
    return np.maximum(little, flat)
