"""Solutions of boundary-value problems, their folds and their branch points as a base of curves, on a mesh in z.

z = (u at the nodes, 1, mesh, [unfolding of branch points], parameters, the last one first).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.bvp.boundary_problem import BoundaryProblem
from contin.bvp.functionals import columns_of
from contin.bvp.on_mesh import OnMesh
from contin.continuation.sample import Sample
from contin.linalg.csc import scaled_columns, with_columns, with_rows
from contin.loci.augmented.elimination import Scalars
from contin.loci.augmented.meshed import Chosen, MeshedBase
from contin.loci.augmented.singular import Borders, critical, null_vectors, singular
from contin.loci.augmented.sparse import SparseBordered

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

    from contin.model.model import Model


ROUNDING = 1e-8  # of the largest: null functions below this are none
CUSP = 2  # place of the test of cusps among those of a sample


@dataclass(frozen=True, eq=False)
class BoundaryBase(MeshedBase[BoundaryProblem]):
    """`type` is LP or BP."""

    type: str = ""

    has_stability = False

    @property
    def model(self) -> Model:
        return self.problem.two.model

    def based(self, base: Array) -> BoundaryProblem:
        return replace(self.problem, base=base)

    def where(self, z: Array) -> NDArray[np.intp]:
        """Places in z of (u, [unfolding], parameters)."""
        nodes = self.profile(z).u.size
        return np.concatenate([np.arange(nodes), np.arange(z.size - self.behind, z.size)])

    # -- the base's contract -------------------------------------------------------------------------------------------

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(self.problem.two.parameters[place] for place in self.places)

    def settled(self, z: Array, scale: Array) -> Self:
        mesh = self.profile(z).h
        own = self._fitting(z, mesh, np.ones(z.size)) if self.type else None
        return replace(self, chosen=Chosen(mesh, own, np.zeros(0)))

    def linearise(self, z: Array, scale: Array, rows: Array) -> SparseBordered | None:
        where = self.where(z)
        on_mesh = _OnMesh(self, self.profile(z).h, z, np.delete(scale[where], self._unfolding(z)))
        y = np.delete(z[where] / scale[where], self._unfolding(z))
        here = on_mesh.at(y)
        if here is None:
            return None
        f, matrix = here
        columns: Any = matrix
        equations = f
        if self.type:
            borders = self._borders(z, scale)
            found = singular(on_mesh, y, matrix, borders)
            if found is None:
                return None
            gradient = found.gradient
            if self.extra:
                nodes = matrix.shape[0]
                beta = float(z[-self.behind])
                f = f + beta * borders.left
                columns = with_columns(matrix, borders.left[:, None], nodes)
                gradient = np.insert(gradient, nodes, 0.0, axis=1)
            equations = np.append(f, found.values)
            columns = with_rows(columns, gradient)
        whole = with_rows(columns, rows[:, where])
        still = z.size - len(where)
        return SparseBordered(np.append(equations, np.zeros(still)), whole, where, z.size)

    def _unfolding(self, z: Array) -> list[int]:
        """Its place among (u, [unfolding], parameters)."""
        return [self.profile(z).u.size] if self.extra else []

    def _borders(self, z: Array, scale: Array) -> Borders:
        """Those chosen, where they are of this mesh."""
        mesh = self.profile(z).h
        known = None if self.chosen is None else self.chosen.borders_on(mesh)
        return self._fitting(z, mesh, scale) if known is None else known

    def _fitting(self, z: Array, mesh: Array, scale: Array) -> Borders:
        """Borders that fit at z, with the sense of those chosen before."""
        where = np.delete(self.where(z), self._unfolding(z))
        on_mesh = _OnMesh(self, mesh, z, scale[where])
        here = on_mesh.at(z[where] / scale[where])
        if here is None:
            raise FloatingPointError("the equations are not finite where a curve is to be followed")
        found = null_vectors(critical(here[1], here[1].shape[0], self.extra == 1), 1 + self.extra)
        old, n = None if self.chosen is None else self.chosen.borders, self.problem.n
        if old is not None and float(_sums(found.left, n) @ _sums(old.left, n)) < 0.0:
            found = Borders(-found.left, found.right)
        return found

    def null_functions(self, z: Array) -> Array | None:
        """Along a trivial solution they are all that needs a mesh."""
        if not self.type:
            return None
        profile, where = self.profile(z), np.delete(self.where(z), self._unfolding(z))
        on_mesh = _OnMesh(self, profile.h, z, np.ones(len(where)))
        here = on_mesh.at(z[where])
        found = None
        if here is not None:
            found = singular(on_mesh, z[where], here[1], self._borders(z, np.ones(z.size)), slopes=False)
        if found is None:
            return None
        functions = np.hstack([v[: profile.u.size].reshape(profile.u.shape) for v in found.right.T])
        largest = np.abs(functions).max(axis=0)
        known = largest > ROUNDING * largest.max()
        return np.asarray(functions[:, known] / largest[known])

    def stability(self, type_: str, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        tests = np.zeros(0)
        if self.type == "LP" and type_ == "LP":
            tests = self.cusp(z)(z)
        return tests, 0, np.zeros(0, complex)

    def explain(self, type_: str, a: Sample, b: Sample) -> tuple[str, ...] | None:
        return ("CP",) if self.test_of(type_, "CP") and a.tests[CUSP] * b.tests[CUSP] < 0.0 else ()

    def test_of(self, curve: str, type_: str) -> int | None:
        return CUSP if curve == "LP" and type_ == "CP" else None

    def types(self, curve: str) -> Sequence[str]:
        return ("CP",) if curve == "LP" else ()

    def cusp(self, z0: Array) -> Scalars:
        """<w, F_xx(v, v)> with the null vectors from the borders in use, near z0."""
        unit = np.ones(z0.size)

        def value(z: Array) -> Array:
            where = np.delete(self.where(z), self._unfolding(z))
            mesh = OnMesh(self.at(z), self.profile(z).h)
            on_mesh = _OnMesh(self, mesh.h, z, unit[where])
            here = on_mesh.at(z[where])
            if here is None:
                return np.full(1, np.nan)
            borders = self._borders(z, unit)
            found = singular(on_mesh, z[where], here[1], borders, slopes=False)
            if found is None:
                return np.full(1, np.nan)
            v = np.append(found.right[:, 0], 0.0)
            x = mesh.unknowns(self.inner(z))
            return np.array([float(found.left @ mesh.form(x, v, v))])

        return value

    def degeneracy(self, curve: str, type_: str, near: Sample) -> Scalars | str:
        if curve == "LP" and type_ == "CP":
            return self.cusp(near.z)
        return f"{type_} is not looked for on curves of {curve}"

    def columns(self, z: Array) -> dict[str, Array]:
        inner = [self.inner(row) for row in z]
        padded = np.full((len(z), max(map(len, inner))), np.nan)
        for row, values in zip(padded, inner, strict=True):
            row[len(row) - len(values) :] = values
        p = np.array([self.at(row).full_parameters(values) for row, values in zip(z, inner, strict=True)])
        found = columns_of(self.problem, padded, p)
        varying = np.array([self.values(row) for row in z])
        found.update({name: varying[:, k] for k, name in enumerate(self.names)})
        if self.extra:
            found["unfolding"] = z[:, -self.behind].copy()  # rows are padded on the left
        return found

    def column_names(self) -> tuple[str, ...]:
        return (*self.names, *self.problem.column_names()[1:])

    def describe_failure(self, z: Array) -> str:
        return self.at(z).trouble(self.inner(z))


@dataclass(frozen=True, eq=False)
class _OnMesh:
    """F and [F_x, F_p] in scaled unknowns y = (u, parameters) / scale; rows divided by nothing."""

    base: BoundaryBase
    h: Array
    like: Array
    scale: Array

    @cached_property
    def _nodes(self) -> int:
        return len(self.scale) - len(self.base.places)

    def at(self, y: Array) -> tuple[Array, csc_matrix] | None:
        values, base = y * self.scale, self.base
        parameters = values[self._nodes :]
        p = base.problem.base.copy()
        p[list(base.places)] = parameters[::-1]
        slopes, mesh, x = [], None, values[: self._nodes]
        for place, value in zip(base.places[::-1], parameters, strict=True):
            mesh = OnMesh(replace(base.problem, base=p, active=place, spaces={}), self.h)
            x = np.append(values[: self._nodes], value)
            slopes.append(mesh.parameter_slope(x))
        here = None if mesh is None else mesh.at(x)
        if here is None or not np.all(np.isfinite(slopes)):
            return None
        return here.residual, scaled_columns(with_columns(here.linear.matrix, np.array(slopes).T), self.scale)


def _sums(left: Array, n: int) -> Array:
    """Numbers of a left vector that do not depend on the mesh: sums over it by equation, and the conditions' part."""
    return np.concatenate([left[:-n].reshape(-1, n).sum(axis=0), left[-n:]])
