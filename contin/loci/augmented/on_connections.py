"""The equations of connecting orbits with both parameters among their unknowns, and how singular they are."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.homoclinic.connection_layout import Gauge
from contin.homoclinic.saddle_connections import ConnectionProblem
from contin.homoclinic.surfaces import surface_met
from contin.linalg.vectors import norm
from contin.loci.augmented.singular import STEP, Assembled, Borders, Singular, singular

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

KNOWN: Final = "normal"
SHORT: Final = 1e-5  # steps of differences along a null function that moves one front beside another


@dataclass(frozen=True, eq=False)
class Chosen:
    """For a stretch of a curve: what its connections refer to, borders, the metric, and its normal at the last point.

    <w, [F_q F_p]> is a normal in the plane of the parameters, at cusps too: by it w keeps its sense from point to point
    (taken on within one call, which has a copy).
    """

    gauge: Gauge
    borders: Borders
    scale: Array
    normal: dict[str, Array] = field(default_factory=dict)

    def sense(self, normal: Array) -> float:
        """Of a w with this scaled normal."""
        before = self.normal.get(KNOWN)
        sense = -1.0 if before is not None and float(normal @ before) < 0.0 else 1.0
        self.normal[KNOWN] = sense * normal
        return sense


@dataclass(frozen=True, eq=False)
class Cusp:
    """What vanishes at one, of unit null vectors v and w.

    value : <w, B(v, v)>.  terms : of <w, F_x v>, for v as large as a solution.  normal : <w, [F_q F_p]>.
    """

    value: float
    terms: float
    normal: Array


@dataclass(frozen=True, eq=False)
class OnConnections:
    """F and [F_x, F_q, F_p] at y = unknowns / scale, with interval and mesh of `like`."""

    problem: ConnectionProblem
    like: Array
    scale: Array

    def at(self, y: Array) -> Assembled | None:
        z, where = self.like.copy(), self.problem.curve.unknowns(self.like)
        z[where] = y * self.scale[where]
        here = linearised(self.problem, z, self.scale)
        return None if here is None else Assembled(here[1])

    @property
    def unknowns(self) -> Array:
        """y of `like`."""
        where = self.problem.curve.unknowns(self.like)
        return np.asarray(self.like[where] / self.scale[where])

    def singular(self, matrix: csc_matrix, borders: Borders, slopes: bool = True) -> Singular | None:
        """The scalar of F_x and its null vectors at `like`, where [F_x, F_q, F_p] is `matrix`."""
        own = Assembled(matrix[:, : matrix.shape[0]])
        return singular(self, self.unknowns, own, borders, slopes, SHORT)


def linearised(problem: ConnectionProblem, z: Array, scale: Array) -> tuple[Array, csc_matrix] | None:
    """Scaled F (k,) and its derivatives (k, k + 2); None where there are none."""
    if surface_met(problem.curve, z) is not None:
        return None
    try:
        f, matrix = problem.curve.linearise(z, scale, problem.sizes(z, scale))
    except (np.linalg.LinAlgError, ValueError):  # no step: the curve ends, in words
        return None
    return (f, matrix) if np.all(np.isfinite(f)) and np.all(np.isfinite(matrix.data)) else None


def cusp_at(there: OnConnections, borders: Borders, extrapolated: bool) -> Cusp | None:
    """A central difference, from two steps where a point is solved for: its error moves a cusp along the curve."""
    here = linearised(there.problem, there.like, there.scale)
    found = None if here is None else there.singular(here[1], borders, slopes=False)
    if here is None or found is None:
        return None
    matrix, count, y = here[1], len(found.left), there.unknowns
    v, w = found.right[:, 0] / norm(found.right[:, 0]), found.left / norm(found.left)

    def difference(step: float) -> float:
        ends = [there.at(y + side * step * np.append(v, [0.0, 0.0])) for side in (-1.0, 1.0)]
        behind, ahead = (float("nan") if end is None else float(end.pulled(w)[:count] @ v) for end in ends)
        return (behind - ahead) / (2.0 * step)

    value = difference(STEP)
    if extrapolated:
        value = (4.0 * value - difference(2.0 * STEP)) / 3.0
    terms = float(np.abs(w) @ (abs(matrix[:, :count]) @ np.abs(v))) * float(np.abs(v).max())
    return Cusp(value, terms, np.asarray(w @ matrix[:, count:]))
