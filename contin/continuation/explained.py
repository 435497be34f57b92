"""Whether steps are those of one smooth curve: the way from row to row is what the tangents at both rows explain.

The change over a step h of a curve u(s) is h (u'(0) + u'(h))/2, up to h^3 u'''/12 (trapezoid rule). A corrector that
has landed on another branch leaves a change that this does not explain, also where the two are nearly parallel in the
metric and no test changes its sign: past the top of a pitchfork, the trivial branch. Each state is asked by itself, in
its own size: along a needle of a curve the others say nothing. Where the change is explained by chance (half of what
the slope before foretold, and none after), the slope itself is not what the two before it lead to.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.sample import Chunk, Sample

UNEXPLAINED: Final = 0.2  # part of a state's change, or of its slopes' (of resolved steps: 1e-3)
STRAY: Final = 0.6  # part of a state's largest slope by which it differs from the line through the two before
ASIDE: Final = 0.09  # sine of the angle between chord and mean tangent (of resolved steps: 1e-2)
VANISHED: Final = 1e-6  # part of a state and its slope that a step leaves of both: it is zero on another branch
COUNTS: Final = 3e-4  # of its scale: a state that changes less in a step is not asked by itself (a cubic's flat middle)
SHORT: Final = 1e-6  # arclength of a step that is not asked: at a corner none is explained


def first_unexplained(
    chunk: Chunk, before: Sample | None, length: float, scale: Array, angle_periods: Array, noise: float, each: bool
) -> int | None:
    """The first row from which a step is not that of one smooth curve; None: all are.

    before, length : the sample before row 0, where there is one, and the step from it.  noise : what the corrector
    leaves in scaled unknowns.  each : whether every unknown is asked, not only all together (values on a mesh, of which
    some change fast anywhere).
    """
    h = chunk.lengths[1:, None]
    moved = np.diff(chunk.z, axis=0) / scale
    chord = np.sqrt(np.einsum("ij,ij->i", moved, moved))[:, None]
    here, after = chunk.tangents[:-1], chunk.tangents[1:]
    left = np.abs(moved - 0.5 * chord * (here + after))
    strange = np.sqrt(np.einsum("ij,ij->i", left, left))[:, None] > ASIDE * chord + noise
    if each:
        known = before is not None and length > 0.0
        first, h_first = (before.tangent, length) if before is not None and known else (here[0], np.inf)
        earlier, h_before = np.vstack([first, here[:-1]]), np.concatenate([[h_first], chunk.lengths[1:-1]])[:, None]
        steepest = np.maximum(np.abs(here), np.abs(after))
        foretold = here + (here - earlier) * (h / h_before)
        strays = np.abs(after - foretold) > STRAY * np.maximum(steepest, np.abs(earlier))
        strays[0] &= known
        apart = left > UNEXPLAINED * np.maximum(steepest * chord, np.abs(moved))
        y = np.abs(chunk.z / scale)
        vanished = (y[1:] < VANISHED * y[:-1]) & (np.abs(after) < VANISHED * np.abs(here)) & (np.abs(moved) > noise)
        apart = (apart | strays) & (np.abs(moved) > max(noise, COUNTS)) | vanished
        apart[:, :-1] &= angle_periods == 0.0
        strange = strange | apart.any(axis=1)[:, None]
    rows = np.flatnonzero(strange & (h > SHORT))
    return int(rows[0]) if rows.size else None
