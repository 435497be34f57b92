"""Whether steps are those of one smooth curve: the way from row to row is what the tangents at both rows explain.

The change over a step h of a curve u(s) is h (u'(0) + u'(h))/2, up to h^3 u'''/12 (trapezoid rule). A corrector that
has landed on another branch leaves a change that this does not explain, also where the two are nearly parallel in the
metric and no test changes its sign: past the top of a pitchfork, the trivial branch. Each state is asked by itself, in
its own size: along a needle of a curve the others say nothing. Where the change is explained by chance (half of what
the slope before foretold, and none after), the slope itself is not what the two before it lead to.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.sample import Chunk, Sample
from contin.kernels.rows_in_doubt import ASIDE, COUNTS, LEVEL, STRAY, UNEXPLAINED, VANISHED, are_explained

CORNERED: Final = 1e-3  # arclength of a step in which a corner is looked for
SHORT: Final = 1e-6  # arclength of a step that is not asked: at a corner none is explained


@dataclass(frozen=True)
class Unexplained:
    """The first rows from which a step is not that of one smooth curve, None where there is none.

    long : that can be halved.
    over : that leads to where a state is constant, and is so short that a corner may explain it.
    """

    long: int | None
    over: int | None


def first_unexplained(
    chunk: Chunk, before: Sample | None, length: float, scale: Array, angle_periods: Array, noise: float, least: float,
    alone: Callable[[Array], Array | None],
) -> Unexplained | None:  # fmt: skip
    """Steps that are not those of one smooth curve; None: there are none.

    before, length : the sample before row 0, where there is one, and the step from it.  noise : what the corrector
    leaves in scaled unknowns.  least : the smallest step.  alone : `Problem.asked_alone`, of what is asked in its own
    size, not only in the step's.
    """
    if _are_explained(chunk, before, length, scale, noise, alone):
        return None
    y, t, h = chunk.z / scale, chunk.tangents, chunk.lengths[1:, None]
    step, bend = y[1:] - y[:-1], (t[1:] - t[:-1]) / h
    rest = step - 0.5 * h * (t[:-1] + t[1:])
    strange = (np.abs(rest) > ASIDE * h + noise).any(axis=1)
    vanished = np.zeros_like(strange)
    size = alone(y)
    if size is not None:
        slopes, moved, left = (np.asarray(alone(values)) for values in (t, step, rest))
        steepest = np.maximum(slopes[:-1], slopes[1:])
        apart = left > UNEXPLAINED * np.maximum(steepest * h, moved)
        if len(bend) > 1:
            turned = np.asarray(alone(bend[1:] - bend[:-1]))
            apart[1:] |= turned * h[1:] > STRAY * np.maximum(steepest[1:], slopes[:-2])
        if before is not None and length > 0.0:
            change = np.asarray(alone((bend[0] - (t[0] - before.tangent) / length)[None]))[0] * h[0]
            foretold = np.asarray(alone(before.tangent[None]))[0]
            apart[0] |= change > STRAY * np.maximum(steepest[0], foretold)
        fixed = np.append(angle_periods == 0.0, True) if angle_periods.size else np.ones(size.shape[1], dtype=np.bool_)
        level = (slopes[1:] < LEVEL * slopes[:-1]) & (moved > noise)
        gone = level & (apart | (size[1:] < VANISHED * size[:-1])) & fixed
        strange |= (apart & (moved > max(noise, COUNTS)) & fixed).any(axis=1)
        vanished = gone[:, :-1].any(axis=1)
        strange |= vanished
    if not strange.any():
        return None
    long, over = h[:, 0] > max(SHORT, 2.0 * least), vanished & (h[:, 0] < CORNERED)
    return Unexplained(_first(strange & long), _first(over))


def _are_explained(
    chunk: Chunk, before: Sample | None, length: float, scale: Array, noise: float,
    alone: Callable[[Array], Array | None],
) -> bool:  # fmt: skip
    """True where all are, for one pass over the rows; false, too, where lengths of several unknowns are asked."""
    asked = alone(chunk.z[:1])
    each = asked is not None and asked.shape == (1, len(scale))
    if asked is not None and not each:
        return False
    known = each and before is not None and length > 0.0
    earlier, length = (before.tangent, length) if known and before is not None else (chunk.tangents[0], 0.0)
    rows = map(np.ascontiguousarray, (chunk.z, chunk.tangents, chunk.lengths))
    return bool(are_explained(*rows, scale, earlier, length, noise, each))


def _first(rows: NDArray[np.bool_]) -> int | None:
    """The first true one."""
    return int(np.argmax(rows)) if rows.any() else None
