"""Curves in two parameters of folds, period doublings, torus bifurcations and branch points of large orbits.

What vanishes on them is in `scalars_of_large_orbits` and `branch_points_of_large_orbits`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Parent
from contin.continuation.seed import Seed
from contin.loci.augmented.branch_points_of_large_orbits import crossing
from contin.loci.augmented.curve_equations import CurveEquations
from contin.loci.augmented.elimination import Scalars, first_rows, null_space
from contin.loci.augmented.large_orbit_curve import LargeOrbitCurve
from contin.loci.augmented.large_orbits import LargeOrbitBase, Latest
from contin.loci.augmented.scalars_of_large_orbits import Flipped, Followed, Turning
from contin.problems.large_orbits.cycle import Monodromy
from contin.problems.large_orbits.large_orbit import LargeOrbitProblem
from contin.problems.large_orbits.large_orbit_equations import Memory
from contin.problems.large_orbits.multipliers import critical_index, critical_pair, plane_of
from contin.problems.two_parameters import indices


@dataclass(frozen=True, eq=False)
class TurningInSecond:
    """`Turning` of the family in the second parameter: where the curve runs along the first one, that moves no fold."""

    turning: Turning

    @staticmethod
    def swapped(z: Array) -> Array:
        return np.append(z[:-2], z[[-1, -2]])

    def __call__(self, z: Array) -> Array:
        return self.turning(self.swapped(z))

    def along(self, z: Array, x: Array) -> Array:
        return self.turning.along(self.swapped(z), self.swapped(x))


def runs_along_first(base: LargeOrbitBase, z: Array, scale: Array) -> bool:
    """True where a curve of folds moves further in the first parameter than in the second, each in its unit.

    The null space of the equations with both parameters free has one direction that moves neither, and one along it.
    """
    here = base.linearise(z, scale, first_rows(2, z.size))
    if here is None or here.sign == 0.0:
        return False
    moved = null_space(here, 2)[-2:]
    if not np.all(np.isfinite(moved)):
        return False
    second, first = np.abs(np.linalg.svd(moved)[0][:, 0])
    return bool(first > second)


def in_second(base: LargeOrbitBase) -> LargeOrbitBase:
    """The same orbits as families in the second parameter."""
    family = replace(base.problem, active=base.second, memory=replace(base.problem.memory, solvers=None, origin=None))
    return replace(base, problem=family, second=base.problem.active, _latest=Latest())


@dataclass(frozen=True, eq=False)
class Special:
    """The condition of a type of special orbits."""

    type: str

    @property
    def text(self) -> str:
        return f"the condition of {self.type}"

    def near(self, problem: CurveEquations, z: Array, scale: Array) -> Scalars:
        base = problem.base
        assert isinstance(base, LargeOrbitBase)
        family, inner = base.at(z), base.inner(z)
        if self.type == "BPC":
            return crossing(base, z, scale)
        if self.type == "LPC":
            moved = TurningInSecond.swapped
            if not runs_along_first(base, z, scale):
                return Turning(base, scale, family.tangents(inner, base.inner(scale))[0])
            base, z, scale = in_second(base), moved(z), moved(scale)
            border = base.at(z).tangents(base.inner(z), base.inner(scale))[0]
            return TurningInSecond(Turning(base, scale, border))
        values, vectors = family.multipliers(inner, exactly=True)
        sweeps = family.sweeps(inner)
        if self.type == "NS":
            pair = critical_pair(values)
            return (lambda at: np.full(1, np.nan)) if pair is None else Followed(
                base, scale, plane_of(values, vectors, pair)
            )  # fmt: skip
        k = critical_index(values, self.type)
        if k is None or sweeps is None:
            return lambda at: np.full(1, np.nan)
        borders = Monodromy.at(sweeps, -1.0, np.real(vectors[:, [k]]))
        return Flipped(base, scale, np.real(borders.b[:, 0]), np.real(borders.c[:, 0]))


def curve_of(problem: LargeOrbitProblem, z: Array, type_: str, parameters: Sequence[str], parent: Parent) -> Seed:
    """The curve of special orbits of a type in two parameters, from one of them."""
    first, second = indices(problem.system, parameters)
    p = problem.full_parameters(z)
    unfolded = type_ == "BPC"
    base = LargeOrbitBase(replace(problem, base=p.copy(), active=first, memory=Memory()), second, unfolded)
    made = LargeOrbitCurve(base, (Special(type_),), type_, tuple(parameters))
    return Seed(made, np.concatenate([z[:-1], [0.0] * unfolded, [p[second], p[first]]]), parent=parent)
