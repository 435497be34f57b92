"""Solutions of boundary-value problems, their folds and their branch points as a base of curves, on a mesh in z.

z = (u at the nodes, 1, mesh, [unfolding of branch points], parameters, the last one first).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.bvp.functionals import columns_of
from contin.continuation.outcome import Outcome, Verified
from contin.continuation.problem import Problem
from contin.continuation.sample import Frame, Sample
from contin.loci.augmented import boundary_degeneracies as degeneracies
from contin.loci.augmented.block_bordered import BlockBordered
from contin.loci.augmented.boundary_remarks import is_unfolded, remarks_on
from contin.loci.augmented.degenerate_solutions import critical_at, described, scalar
from contin.loci.augmented.elimination import Bordered, Scalars
from contin.loci.augmented.fold_ends_of_boundary import at_fold
from contin.loci.augmented.one_event import one_event, test_of
from contin.loci.augmented.singular import singular
from contin.loci.augmented.singular_solutions import SingularSolutions
from contin.loci.augmented.sparse import SparseBordered
from contin.problems.orbits.mesh.layout import make_scale

if TYPE_CHECKING:
    from contin.loci.augmented.adaptive import AdaptiveCurve


ROUNDING = 1e-8  # of the largest: null functions below this are none
ROUNDED = 1e-8  # of the branch's metric: a function that is smaller at a special point may be its rounding error


@dataclass(frozen=True, eq=False)
class BoundaryBase(SingularSolutions):
    """Columns, tests and special points of these curves."""

    def linearise(self, z: Array, scale: Array, rows: Array) -> Bordered | None:
        where = self.where(z)
        on_mesh = self.on_mesh(self.profile(z).h, np.delete(scale[where], self.unfolding(z)))
        y = np.delete(z[where] / scale[where], self.unfolding(z))
        here = on_mesh.at(y)
        if here is None:
            return None
        f, still = here.residual, np.zeros(z.size - len(where))
        if not self.type:
            return SparseBordered(np.append(f, still), here.with_borders(here.columns, rows[:, where]), where, z.size)
        borders = self.borders_at(z, scale)
        found = singular(on_mesh, y, here.critical(self.extra == 1), borders)
        if found is None:
            return None
        if self.extra:
            f = f + float(z[-self.behind]) * borders.left
            found = replace(found, gradient=np.insert(found.gradient, here.size, 0.0, axis=1))
        equations = np.concatenate([f, found.values, still])
        return BlockBordered(equations, found, here.columns, rows[:, where], where, z.size)

    def null_functions(self, z: Array) -> Array | None:
        """Along a trivial solution they are all that needs a mesh."""
        if not self.type:
            return None
        profile, where = self.profile(z), np.delete(self.where(z), self.unfolding(z))
        on_mesh = self.on_mesh(profile.h, np.ones(len(where)))
        here = on_mesh.at(z[where])
        found = None
        if here is not None:
            own = here.critical(self.extra == 1)
            found = singular(on_mesh, z[where], own, self.borders_at(z, np.ones(z.size)), slopes=False)
        if found is None:
            return None
        functions = np.hstack([v[: profile.u.size].reshape(profile.u.shape) for v in found.right.T])
        largest = np.abs(functions).max(axis=0)
        known = largest > ROUNDING * largest.max()
        return np.asarray(functions[:, known] / largest[known])

    def stability(self, type_: str, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        none = np.zeros(0, complex)
        names = self.types(type_)
        at = critical_at(self, z) if names else None
        if at is None:
            return np.full(len(names), np.nan), 0, none
        return np.array([degeneracies.VALUES[degeneracies.name_in(name, self.kind)](at) for name in names]), 0, none

    def explain(self, type_: str, a: Sample, b: Sample) -> tuple[str, ...] | None:
        known = self.types(type_)
        return one_event(known, [0] * len(known), a, b)

    def test_of(self, curve: str, type_: str) -> int | None:
        return test_of(self.types(curve), type_)

    def types(self, curve: str) -> Sequence[str]:
        return degeneracies.types(curve, len(self.places) > 2)

    def degeneracy(self, curve: str, type_: str, near: Sample) -> Scalars | str:
        if type_ not in self.types(curve):
            return f"{type_} is not looked for on curves of {curve}"
        if self.extra and len(self.places) == 2 and is_unfolded(self, near.z):
            return "the unfolding is not zero there: it is no branch point"
        return scalar(self, type_, near.z)

    def described(self, type_: str, point: Verified, scale: Array) -> Outcome:
        return described(self, point, scale) if self.extra else point

    def touching(self, curve: AdaptiveCurve, z: Array, frame: Frame) -> Verified | None:
        return at_fold(curve, z, frame)

    def remarks(self, curve: Problem, z: Array) -> Sequence[str]:
        return remarks_on(self, curve, z) if self.type else []

    def scales(self, z: Array, ranges: Sequence[tuple[float, float]]) -> Array:
        """Of functions that are zero but for rounding where the curve begins, the size that they had on its branch."""
        scale = super().scales(z, ranges)
        if not self.usual.size:
            return scale
        inner, profile = self.inner(scale), self.profile(z)
        sizes = self.problem.sizes(self.inner(z), inner)
        sizes = np.where(sizes < ROUNDED * self.usual, self.usual, sizes)
        own = make_scale(profile.h, profile.m, sizes, float(inner[profile.u.size]), float(inner[-1]))
        return self.joined(own, self.rest(scale))

    def columns(self, z: Array) -> dict[str, Array]:
        found = self._of_solutions(z)
        varying = np.array([self.values(row) for row in z])
        found.update({name: varying[:, k] for k, name in enumerate(self.names)})
        if self.extra:
            found["unfolding"] = z[:, -self.behind].copy()  # rows are padded on the left
        return found

    def column(self, name: str, z: Array) -> Array:
        known = name in (*self.names, "unfolding")
        return self.columns(z)[name] if known else self._of_solutions(z, [name])[name]

    def _of_solutions(self, z: Array, wanted: Sequence[str] | None = None) -> dict[str, Array]:
        """`columns_of` their problem, where more parameters vary than in it."""
        if len(z) and not np.isnan(z[:, 0]).any():  # rows of one size
            p = np.tile(np.append(self.problem.base, 0.0), (len(z), 1))
            p[:, list(self.places)] = z[:, : -1 - len(self.places) : -1]
            return columns_of(self.problem, np.column_stack([z[:, : -self.behind], z[:, -1]]), p, wanted)
        inner = [self.inner(row) for row in z]
        padded = np.full((len(z), max(map(len, inner))), np.nan)
        for row, values in zip(padded, inner, strict=True):
            row[len(row) - len(values) :] = values
        p = np.array([self.at(row).full_parameters(values) for row, values in zip(z, inner, strict=True)])
        return columns_of(self.problem, padded, p, wanted)

    def column_names(self) -> tuple[str, ...]:
        return (*self.names, *self.problem.column_names()[1:])

    def describe_failure(self, z: Array) -> str:
        return self.at(z).trouble(self.inner(z))
