"""The scalars that vanish on curves of branch points of large orbits, with their derivatives along a direction.

    [E' b; C 0] [V; g] = [0; I]

E' with both parameters free and C three rows; b is the jump by which orbits need not close. E' has rank 1 less at a
branch point that is forced, and all three g vanish. Their derivatives there are a symmetric matrix (3, 3) of rank 2,
whose null vector is the tangent of the curve: two combinations across it are held. None of the two parameters is
distinguished, so that a curve may run along either. E' dV + b dg = -dE' V.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from contin.abi import Array
from contin.continuation.sample import Chunk, Stop
from contin.loci.augmented.change_of_image import ChangeOfEquations, ChangeOfImage
from contin.loci.augmented.elimination import Scalars, first_rows, null_space, orthonormal
from contin.loci.augmented.large_orbits import BEHIND, LargeOrbitBase
from contin.problems.large_orbits.linearised import OrbitLinearisation

COUNT = 3  # rows across the null space: one state's direction, two of families
TWO = 2
FEW_ROWS = 6  # of a curve before the combinations are chosen anew, ...
ALONG = 0.7  # ... and the cosine of their tangents up to which they are not


@dataclass(frozen=True, eq=False)
class AtOrbit:
    """g (2,), scaled, and how E' V changes, of each."""

    linear: OrbitLinearisation
    values: Array
    changes: Sequence[ChangeOfEquations]


@dataclass(eq=False)
class Crossing:
    """g of the combinations `chosen` (3, k) of null vectors, with border `rows` (3, unknowns)."""

    base: LargeOrbitBase
    scale: Array
    rows: Array
    chosen: Array
    _last: tuple[Array, AtOrbit | None] | None = field(default=None)

    def _at(self, z: Array) -> AtOrbit | None:
        if self._last is None or not np.array_equal(self._last[0], z):
            self._last = z.copy(), self._made(z)
        return self._last[1]

    def _made(self, z: Array) -> AtOrbit | None:
        here = self.base.linearise(z, self.scale, self.rows)
        solvers = self.base.at(z).solvers(self.base.inner(z))
        if here is None or solvers is None:
            return None
        plain, closed = self.base.folded, self.base.closed
        beside, found = np.zeros(len(z) - COUNT), []
        vectors = [here.solve(np.append(beside, column)) for column in self.chosen.T]
        if not np.all(np.isfinite(vectors)):
            return None
        for v in vectors:
            raw = closed(v * self.scale)
            empty = ChangeOfImage(plain, closed(z), closed(self.scale), solvers, np.zeros(0))
            image = replace(empty, d=empty.stages(raw), q=raw[-2:])
            found.append(ChangeOfEquations(image, float(raw[-BEHIND])))
        return AtOrbit(here, np.array([v[-BEHIND] for v in vectors]), found)

    def __call__(self, z: Array) -> Array:
        here = self._at(z)
        return np.full(self.chosen.shape[1], np.nan) if here is None else here.values

    def along(self, z: Array, x: Array) -> Array:
        here = self._at(z)
        changes = [] if here is None else [change.along(self.base.closed(x)) for change in here.changes]
        made = [change for change in changes if change is not None]
        if here is None or len(made) < self.chosen.shape[1]:
            return np.full(self.chosen.shape[1], np.nan)
        return np.array([here.linear.response(change)[-BEHIND] for change in made])


def crossing(base: LargeOrbitBase, z: Array, scale: Array) -> Scalars:
    """The two scalars near a branch point, with borders from there."""
    here = base.linearise(z, scale, first_rows(COUNT, z.size))
    vectors = np.full((z.size, COUNT), np.nan) if here is None or here.sign == 0.0 else null_space(here, COUNT)
    if not np.all(np.isfinite(vectors)):
        return lambda at: np.full(TWO, np.nan)
    rows = orthonormal(vectors.T)
    whole = Crossing(base, scale, rows, np.eye(COUNT))
    slopes = np.array([whole.along(z, scale * row) for row in rows])
    if not np.all(np.isfinite(slopes)):
        return lambda at: np.full(TWO, np.nan)
    sizes, directions = np.linalg.eigh(0.5 * (slopes + slopes.T))
    return Crossing(base, scale, rows, directions[:, np.argsort(-np.abs(sizes))[:TWO]])


def while_across(chunk: Chunk) -> Chunk:
    """Rows up to where the tangent has turned far towards the combinations, which were chosen across that of the first.

    Where it lies among them, the equations are singular without a branch point.
    """
    turned = np.einsum("ij,j->i", chunk.tangents, chunk.tangents[0]) < ALONG
    if not turned.any():
        return chunk
    rows = max(2, int(np.argmax(turned)))
    crossed = tuple(row for row in chunk.crossed if row < rows)
    return replace(chunk, crossed=crossed).cut(rows, Stop.LIMIT, float(chunk.lengths[rows - 1]))
