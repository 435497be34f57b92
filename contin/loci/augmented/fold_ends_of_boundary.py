"""DP where a curve of folds of a boundary-value problem touches that of branch points: what a cusp may be instead."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.outcome import Verified
from contin.continuation.sample import Frame, Sample
from contin.loci.augmented import boundary_degeneracies as degeneracies
from contin.loci.augmented.boundary_remarks import is_unfolded
from contin.loci.augmented.degenerate_solutions import kind_at
from contin.loci.augmented.singular import null_vectors
from contin.loci.codim2.fold_ends import ASIDE, BESIDE, NEARLY

if TYPE_CHECKING:
    from contin.loci.augmented.adaptive import AdaptiveCurve

SIDES: Final = ((-2, 1.0), (-2, -1.0), (-1, 1.0), (-1, -1.0))  # unknowns from the end of z, and ways to move them
ALONE: Final = np.zeros(0, complex)


def at_fold(curve: AdaptiveCurve, z: Array, frame: Frame) -> Verified | None:
    """The DP that a supposed cusp z on a curve of folds is where no parameter unfolds it, <w, F_p> = 0; else None.

    Folds of the branches that cross at branch points end there, and the defining system of folds is singular: near a
    pitchfork's DP Newton's method stalls. The point is solved for on the curve of branch points instead.
    """
    if _slope(curve, z, frame.scale) > NEARLY:
        return None
    count = len(curve.base.places)
    start = np.insert(z, z.size - count, 0.0)
    scale = np.insert(frame.scale, z.size - count, 1.0)
    base = replace(curve.base, type="BP", chosen=None, kind="")
    points = replace(curve, base=base, type="BP")
    for index, side in SIDES:
        aside = points.at_unknown(index, start, start[index] + side * ASIDE * scale[index], scale)
        if aside is not None and not is_unfolded(base, aside):
            break
    else:
        return None
    points = replace(points, base=replace(base, kind=kind_at(base, aside, scale)))
    near = Sample(start, np.full(start.size, 1.0 / np.sqrt(start.size)), np.zeros(0), 0, ALONE)
    found = points.verify("DP", near, Frame(scale))
    if not isinstance(found, Verified):
        return None
    there = np.delete(found.z, found.z.size - 1 - count)
    if not np.linalg.norm((there - z) / frame.scale) < BESIDE:
        return None
    mirrored = points.base.kind == degeneracies.PITCHFORK
    return replace(found, z=there, vectors={**found.vectors, "mirrored": mirrored})


def _slope(curve: AdaptiveCurve, z: Array, scale: Array) -> float:
    """The larger of the slopes <w, F_p> in all parameters, relative to the largest entry of F'."""
    base = curve.base
    where = base.where(z)
    here = base.on_mesh(base.profile(z).h, scale[where]).at(z[where] / scale[where])
    if here is None:
        return np.inf
    w, slopes = null_vectors(here.critical(False), 1).left, here.columns
    largest = max(float(abs(here.slope).max()), float(np.abs(slopes).max()))
    return float(np.abs(w @ slopes).max() / (np.abs(w).max() * largest))
