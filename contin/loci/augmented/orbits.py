"""Periodic orbits by collocation, their folds, branch points and period doublings as a base of curves, on a mesh in z.

z = (u at the nodes, T, mesh, [unfolding of branch points], parameters, the last one first).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final, Self

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.outcome import Outcome, Verified
from contin.continuation.sample import Sample
from contin.linalg.csc import with_columns, with_rows
from contin.loci.augmented.elimination import Scalars
from contin.loci.augmented.meshed import Chosen, MeshedBase
from contin.loci.augmented.one_event import one_event, test_of
from contin.loci.augmented.singular import Assembled, Borders, null_vectors, singular
from contin.loci.augmented.sparse import SparseBordered
from contin.loci.tolerances import REAL
from contin.loci.without_coefficients import with_remark
from contin.problems.conditioned.under_conditions import product_of
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.problems.orbits.linearised.linear import OrbitLinear
from contin.problems.orbits.linearised.multipliers import nontrivial, without
from contin.problems.orbits.measured.columns import names_of, norms, orbit_columns, with_observables
from contin.problems.orbits.measured.measures import standard_columns, standard_names
from contin.problems.orbits.normal_forms.codimension_two import has_coefficients, with_coefficients
from contin.problems.orbits.special_orbits.defining import special_on_finer_mesh

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

    from contin.model.model import Model

CRITICAL: Final = {"LPC": [1.0 + 0.0j], "BPC": [1.0 + 0.0j], "PD": [-1.0 + 0.0j]}
TYPES: Final = {"LPC": ("R1", "LPPD", "LPNS"), "PD": ("LPPD", "R2", "PDNS"), "BPC": ()}  # by tests: at 1, at -1, a pair
MOVED: Final = (1, 1, 2)
WITHOUT: Final = "cycles with algebraic states, on curves of BPC, or that are not found on a finer mesh"


@dataclass(frozen=True, eq=False)
class OrbitBase(MeshedBase[OrbitProblem]):
    """`type` is LPC, BPC or PD."""

    @property
    def model(self) -> Model:
        found: Model = self.system.model
        return found

    def based(self, base: Array) -> OrbitProblem:
        return replace(self.problem, base=base)

    def where(self, z: Array) -> NDArray[np.intp]:
        """Places in z of (u, T, [unfolding], parameters)."""
        return np.concatenate([np.arange(self.profile(z).u.size + 1), np.arange(z.size - self.behind, z.size)])

    # -- the base's contract -------------------------------------------------------------------------------------------

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(self.system.parameter_names[place] for place in self.places)

    def settled(self, z: Array, scale: Array) -> Self:
        """With z as the orbit that the phase refers to."""
        chosen = Chosen(self.profile(z).h, None, self.inner(z))
        own = replace(self, chosen=chosen)
        here = own.equations(z, scale) if self.type else None
        if here is None:
            return own
        return replace(own, chosen=replace(chosen, borders=own._borders(z, own._critical(here[1], z))))

    def _linear(self, z: Array, scale: Array, place: int) -> OrbitLinear:
        """The orbit's equations with the parameter at `place` among the unknowns as the last one."""
        index = -1 - self.places.index(place)
        problem, inner, metric = replace(self.at(z), active=place), self.inner(z), self.inner(scale)
        inner[-1], metric[-1] = z[index], scale[index]
        kept = inner if self.chosen is None else self.chosen.reference
        same = kept.size == inner.size and np.array_equal(problem.profile(kept).h, self.profile(z).h)
        return OrbitLinear(problem, inner, metric, kept if same else inner)

    def equations(self, z: Array, scale: Array) -> tuple[Array, csc_matrix] | None:
        """Scaled F and [F_x, F_p]."""
        columns, own = [], None
        for place in self.places[::-1]:
            own = self._linear(z, scale, place)
            if not np.all(np.isfinite(own.residual)):
                return None
            columns.append(own.last_column)
        assert own is not None
        return own.residual, with_columns(own.jacobian[:, :-1], np.column_stack(columns))

    def _critical(self, matrix: csc_matrix, z: Array) -> csc_matrix:
        """M: of period doublings that of perturbations which close with the other sign."""
        n, nodes = self.problem.n, self.profile(z).u.size
        if self.type != "PD":
            kept = [*range(matrix.shape[0]), *([matrix.shape[1] - 1] if self.extra else [])]
            return matrix[:, kept]
        own = matrix[:nodes, :nodes].tolil()
        own[nodes - n : nodes, :n] = -own[nodes - n : nodes, :n]
        return own.tocsc()

    def linearise(self, z: Array, scale: Array, rows: Array) -> SparseBordered | None:
        where = self.where(z)
        on_mesh = _OnMesh(self, z, scale)
        y = on_mesh.unknowns(z)
        here = self.equations(z, scale)
        if here is None:
            return None
        f, matrix = here
        still = z.size - len(where)
        if not self.type:
            whole = with_rows(matrix, rows[:, where])
            return SparseBordered(np.append(f, np.zeros(still)), whole, where, z.size)
        own = self._critical(matrix, z)
        borders = self._borders(z, own)
        found = singular(on_mesh, y, Assembled(own), borders)
        if found is None:
            return None
        gradient, columns, count = found.gradient, matrix, matrix.shape[0]
        if self.extra:
            f = f + float(z[-self.behind]) * borders.left
            columns = with_columns(matrix, borders.left[:, None], count)
            gradient = np.insert(gradient, count, 0.0, axis=1)
        whole = with_rows(with_rows(columns, gradient), rows[:, where])
        equations = np.concatenate([f, found.values, np.zeros(still)])
        return SparseBordered(equations, whole, where, z.size, found.form)

    def _borders(self, z: Array, own: csc_matrix) -> Borders:
        """Those chosen, where they are of this mesh."""
        known = None if self.chosen is None else self.chosen.borders_on(self.profile(z).h)
        return null_vectors(Assembled(own), 1 + self.extra) if known is None else known

    # -- stability -----------------------------------------------------------------------------------------------------

    def _others(self, z: Array, values: NDArray[np.complex128]) -> NDArray[np.complex128]:
        return np.asarray(without(nontrivial(self.problem, values), CRITICAL.get(self.type, [])))

    def stability(self, type_: str, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        values = np.asarray(self.at(z).multipliers(self.inner(z)))
        others = self._others(z, values)
        unstable = int(np.sum(np.abs(others) > 1.0))
        if not self.types(type_):
            return np.zeros(0), unstable, values
        pairs = np.array([a * b - 1.0 for i, a in enumerate(others) for b in others[i + 1 :]])
        return np.array([product_of(others - 1.0), product_of(others + 1.0), product_of(pairs)]), unstable, values

    def types(self, curve: str) -> Sequence[str]:
        return TYPES.get(self.type, ())

    def test_of(self, curve: str, type_: str) -> int | None:
        return test_of(self.types(curve), type_)

    def explain(self, type_: str, a: Sample, b: Sample) -> tuple[str, ...] | None:
        return one_event(self.types(type_), MOVED, a, b)

    def degeneracy(self, curve: str, type_: str, near: Sample) -> Scalars | str:
        others = self._others(near.z, near.eigenvalues)
        real = np.abs(others.imag) <= REAL
        target = {"LPPD": -1.0 if self.type == "LPC" else 1.0}.get(type_)
        chosen = others[~real] if target is None else others[real]
        if type_ in ("R1", "R2") or not chosen.size:
            return "two multipliers meet there, which is not solved for under conditions"
        off = np.abs(np.abs(chosen) - 1.0) if target is None else np.abs(chosen - target)
        reference = complex(chosen[int(np.argmin(off))])

        def part(z: Array) -> Array:
            now = self._others(z, np.asarray(self.at(z).multipliers(self.inner(z))))
            value = complex(now[int(np.argmin(np.abs(now - reference)))])
            return np.array([abs(value) - 1.0 if target is None else value.real - target])

        return part

    def described(self, type_: str, point: Verified, scale: Array) -> Outcome:
        others = self._others(point.z, point.eigenvalues)
        away = np.abs(np.abs(others) - 1.0) > 1e-6
        told = replace(point, unstable=int(np.sum(np.abs(others[away]) > 1.0)))
        return with_remark(self._with_coefficients(told, scale), WITHOUT)

    def _with_coefficients(self, point: Verified, scale: Array) -> Verified:
        """By the return map, with that of the special orbit in the first parameter on a mesh of half the lengths."""
        if self.type == "BPC" or not has_coefficients(point.type, self.system):
            return point
        problem, z, metric = self.at(point.z), self.inner(point.z), self.inner(scale)
        finer = special_on_finer_mesh(problem, self.type, z, metric)
        if finer is None:
            return point
        fine = OrbitLinear(problem, finer.z, finer.scale, finer.z)
        return with_coefficients(point, 0.0, OrbitLinear(problem, z, metric, z), fine)

    # -- columns -------------------------------------------------------------------------------------------------------

    def columns(self, z: Array) -> dict[str, Array]:
        def functions(u: Array, rows: Array) -> Array:
            p = np.array([self.at(row).full_parameters(self.inner(row)) for row in rows])
            return with_observables(self.system, u, p)

        values = [self.values(row) for row in z]
        found = {name: np.array([v[k] for v in values]) for k, name in enumerate(self.names)}
        found["period"] = np.array([self.profile(row).period for row in z])
        if self.extra:
            found["unfolding"] = z[:, -self.behind].copy()  # rows are padded on the left
        found |= orbit_columns(z, names_of(self.system), self.profile, functions)
        if self.type:
            return found
        found |= standard_columns(self.system, found, lambda: norms(z, self.profile))
        if self.problem.measures is not None:
            profiles = [self.profile(row) for row in z]
            found |= self.problem.measures.columns(profiles, lambda k: self.at(z[k]).full_parameters(self.inner(z[k])))
        return found

    def column_names(self) -> tuple[str, ...]:
        parts = (f"{name}.{end}" for name in names_of(self.system) for end in ("min", "max"))
        measures = self.problem.measures
        further = () if self.type else (*standard_names(self.system), *(() if measures is None else measures.texts))
        return (*self.names, "period", *parts, *further)

    def describe_failure(self, z: Array) -> str:
        return str(self.at(z).describe_failure(self.inner(z)))


@dataclass(frozen=True, eq=False)
class _OnMesh:
    """F and [F_x, F_p] at y = (u, T, parameters) / scale, on the mesh of `like`."""

    base: OrbitBase
    like: Array
    scale: Array

    def unknowns(self, z: Array) -> Array:
        base = self.base
        where = base.where(z)
        y = z[where] / self.scale[where]
        return np.delete(y, [len(where) - base.behind] if base.extra else [])

    def at(self, y: Array) -> Assembled | None:
        base, z = self.base, self.like.copy()
        where = base.where(z)
        where = np.delete(where, [len(where) - base.behind] if base.extra else [])
        z[where] = y * self.scale[where]
        here = base.equations(z, self.scale)
        return None if here is None else Assembled(here[1])
