"""Saddles that an orbit lingers at."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array, Vector
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.problems.orbits.ends.distances import NEAR_SADDLE, apart, distance, extent_of
from contin.problems.orbits.ends.stays import visits
from contin.problems.orbits.march.slow_passage import of_the_frame, slowest_points
from contin.problems.orbits.mesh.layout import Profile

if TYPE_CHECKING:
    from contin.problems.orbits.family import FamilyOfOrbits


@dataclass(frozen=True, eq=False)
class Saddle:
    """An equilibrium that the orbit lingers at; `frame`: which of its eigenvalues only a turning frame makes."""

    u: Array
    eigenvalues: NDArray[np.complex128]
    visits: int = 1
    frame: int | None = None

    @property
    def own(self) -> NDArray[np.complex128]:
        """The eigenvalues of its shape."""
        return self.eigenvalues if self.frame is None else np.delete(self.eigenvalues, self.frame)

    @property
    def leading(self) -> complex:
        """The leading eigenvalue, stable or unstable, with the slower rate; the upper one of a pair."""
        return self.by_rate[0]

    @property
    def by_rate(self) -> list[complex]:
        """An eigenvalue of each rate |Re|, the slowest first; the upper one of a pair."""
        found: list[complex] = []
        for value in sorted(self.own, key=lambda v: (abs(v.real), -v.imag)):
            if not found or abs(value.real) > abs(found[-1].real) * (1.0 + 1e-9):
                found.append(complex(value))
            elif value.imag > found[-1].imag:
                found[-1] = complex(value)
        return found

    def at(self, problem: FamilyOfOrbits, parameter: float, sizes: Array) -> Saddle:
        """The same equilibrium at another parameter value; as it is here where it is no such saddle there."""
        found = equilibrium_near(problem, self.u, parameter, sizes)
        if found is None or np.sum(found.own.real > 0.0) != np.sum(self.own.real > 0.0):
            return self
        return replace(found, visits=self.visits)

    @property
    def quantity(self) -> float:
        """Saddle quantity: leading unstable plus leading stable real part; negative: a stable cycle (n = 2)."""
        real = self.own.real
        return float(real[real > 0].min() + real[real < 0].max())


def saddles_near(problem: FamilyOfOrbits, profile: Profile, sizes: Array) -> list[Saddle]:
    """Hyperbolic saddles that the orbit comes close to, each with the number of its visits in a period.

    Empty where the orbit is slow elsewhere, too: a saddle that it has not come close to yet may be there.
    """
    found, elsewhere = saddles_and_elsewhere(problem, profile, sizes)
    return [] if elsewhere else found


def saddles_and_elsewhere(
    problem: FamilyOfOrbits, profile: Profile, sizes: Array, earlier: Profile | None = None
) -> tuple[list[Saddle], bool]:  # fmt: skip
    """The same saddles, and whether the orbit is slow elsewhere; no saddles where one of them is not hyperbolic.

    earlier : an orbit of the family with a shorter period: only visits that have become longer since are counted. An
    orbit homoclinic to a saddle may pass close by it on its way.
    """
    extent, elsewhere = extent_of(profile, sizes), False
    found: list[Saddle] = []
    for u in slowest_points(problem, profile, sizes):
        near = equilibrium_near(problem, u, profile.parameter, sizes)
        if near is None or distance(problem, near.u, u, sizes) > NEAR_SADDLE * extent:
            elsewhere = True
            continue
        values = near.own
        if not (np.any(values.real > 0) and np.any(values.real < 0)):
            return [], elsewhere
        if float(np.abs(values.real).min()) < 1e-6 * float(np.abs(values).max()):
            return [], elsewhere
        if all(float(np.max(np.abs(apart(problem, known.u, near.u)) / sizes)) >= 1e-6 for known in found):
            found.append(near)
    return [replace(s, visits=visits(problem, s, profile, sizes, earlier)) for s in found], elsewhere


def equilibria_of(problem: FamilyOfOrbits) -> EquilibriumProblem:
    """The equilibria of a family's equations, in its parameter."""
    return EquilibriumProblem(problem.system, problem.base.copy(), problem.active)


def equilibrium_near(problem: FamilyOfOrbits, u: Array, parameter: float, sizes: Array) -> Saddle | None:
    """The equilibrium near u and its eigenvalues by falling real part."""
    rest = equilibria_of(problem)
    z = rest.at_parameter(np.append(u, parameter), parameter, np.append(sizes, 1.0))
    if z is None:
        return None
    jacobian = rest.linear_part(z)
    values: Vector = np.linalg.eigvals(jacobian)
    values = values[np.argsort(-values.real)].astype(complex)
    return Saddle(z[:-1], values, 1, of_the_frame(problem, z[:-1], jacobian, values))


def rounded(state: Array, sizes: Array) -> Array:
    """The state, with zeros for what is rounding beside the states' sizes."""
    return np.asarray(np.where(np.abs(state) > 1e-13 * np.maximum(sizes, np.abs(state)), state, 0.0))
