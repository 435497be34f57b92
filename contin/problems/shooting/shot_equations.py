"""The shooting equations of orbits, one parameter free: trajectories, linearisation, multipliers, profiles."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation import corrector
from contin.continuation.outcome import Failure
from contin.kernels.tests_of_stability import map_tests
from contin.problems.neutral_pairs import is_suspect, paired
from contin.problems.orbits.mesh.layout import Profile
from contin.problems.orbits.mesh.sizes import state_sizes
from contin.problems.shooting.fixed_space import fixed_space
from contin.problems.shooting.layout import Nodes
from contin.problems.shooting.linear import BorderedShooting
from contin.problems.shooting.sampling import sampled
from contin.problems.shooting.segments import Segments
from contin.problems.shooting.shifted_in_time import apart_in_time
from contin.problems.shooting.shot_family import ShotFamily

SHIFTED = 1e-8  # of states' sizes: differences that a shift in time may make of itself, beside what it does linearly
PAIRED = 1e-10  # two multipliers are m and 1/m to this: the flow keeps an area, and |m| = 1 is no rounding error


@dataclass(frozen=True, eq=False)
class ShotEquations(ShotFamily):
    """phi_T(u, p) = u + winding in M segments, with a phase, and their derivatives."""

    def restricted(self, z: Array) -> Self:
        """Orbits with the symmetries that keep every node of z."""
        nodes = Nodes.of(z, self.n)
        return replace(self, fixed=fixed_space(self, nodes.u, self.full_parameters(z)))

    def profile(self, z: Array) -> Profile:
        """The orbit sampled over one period."""
        return sampled(self, z)

    def at_shared_places(self, z: Array, values: Array) -> Array:
        """States, and the period beside them, at the nodes, (M, n + 1)."""
        part = Nodes.of(values, self.n)
        return np.column_stack([part.u, np.full(part.count, part.period)])

    def apart_at_shared_places(self, one: Array, other: Array) -> Array:
        """one - other at the nodes of the one, at the times at which the other is nearest."""
        near = super().apart_at_shared_places(one, other)
        sizes = self.sizes(one, self.initial_scale(one, (float(one[-1]), float(one[-1]) + 1.0)))
        if not self.autonomous or np.all(np.abs(near[:, :-1]) <= SHIFTED * sizes):
            return near
        shifted = apart_in_time(self, one, other, sizes)
        return near if np.isnan(shifted).any() else shifted

    def of_one_mesh(self, one: Array, other: Array) -> bool:
        return bool(np.all(self._plane(one) == self._plane(other)))

    def on_mesh_of(self, z: Array, other: Array) -> Array:
        """The orbit z, its phase fixed by the plane of another one."""
        return np.concatenate([z[: -self.n - 2], self._plane(other), z[-1:]])

    def _plane(self, z: Array) -> Array:
        return np.asarray(z[-self.n - 2 : -1])

    def state_sizes(self, profile: Profile) -> Array:
        """Typical size of every state on an orbit, (n,)."""
        return state_sizes(self, profile)

    def linearisation(self, z: Array, tangent: Array, scale: Array) -> Any:
        """The bordered equations, None where a trajectory does not come to its end."""
        segments = self.segments(z)
        return None if segments is None else BorderedShooting.of(segments, tangent, scale)

    def segments(self, z: Array) -> Segments | None:
        """The trajectories of z's segments; the last ones are kept, for they are asked for twice."""
        kept = self._kept
        if kept and np.array_equal(kept[0][0], z):
            return kept[0][1]
        found = Segments.of(self, z)
        kept[:] = [(z.copy(), found)]
        return found

    @cached_property
    def _kept(self) -> list[tuple[Array, Segments | None]]:
        return []

    def stability(self, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        """(pairs, flips), multipliers outside the unit circle, multipliers (the trivial one first)."""
        values = self.multipliers(z)
        others = values[1:] if self.autonomous else values
        if is_suspect(others, True):
            others = paired(others, np.full(len(others), PAIRED), True)
        tests = np.ones(4)
        unstable = map_tests(np.ascontiguousarray(others.real), np.ascontiguousarray(others.imag), tests)
        return tests[2:], int(unstable), values

    def multipliers(self, z: Array) -> NDArray[np.complex128]:
        """Multipliers of an orbit, the trivial one of an autonomous system first; NaN where they cannot be computed."""
        segments = self.segments(z)
        if segments is None:
            return np.full(self.n, np.nan, complex)
        return segments.multipliers()

    def at_parameter(self, guess: Array, value: float, scale: Array) -> Array | None:
        fixed = np.zeros(len(scale))
        fixed[-1] = 1.0
        z0 = guess.copy()
        z0[-1] = value
        found = corrector.correct(self, z0, fixed, 0.0, np.zeros(len(scale)), scale, 1e-11)
        if isinstance(found, Failure):
            return None
        z = found.z.copy()
        z[-1] = value
        return z
