"""The equations of periodic orbits by orthogonal collocation, one parameter free: what all that works on them needs."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from contin.abi import Array
from contin.kernels.collocation import Equations
from contin.kernels.collocation_basis import basis
from contin.problems.orbits.family import FamilyOfOrbits
from contin.problems.orbits.forcing_period import ForcingPeriod
from contin.problems.orbits.measured.measures import Measures
from contin.problems.orbits.mesh.adaption import estimate
from contin.problems.orbits.mesh.layout import Profile, of_one_mesh, profile_of, rows_at_places, sizes_of
from contin.problems.orbits.mesh.sizes import state_sizes

MESH_TOLERANCE = 1e-7  # error inside an interval, relative to the states' sizes; that of T and p is far smaller
PLACES = 11  # at which orbits of different rows are compared
CONSTANT = 1e-9  # an orbit with less amplitude than this (relative) is an equilibrium


@dataclass(frozen=True, eq=False)
class OrbitEquations(FamilyOfOrbits):
    """u'(x) = T f(u, p), u(1) = u(0) + winding, with a phase condition; z as in `contin.problems.orbits.mesh.layout`.

    points : Gauss points an interval.  intervals : fixed number of mesh intervals, or None.  multiple : forcing periods
    in one orbit of a forced system.
    """

    points: int = 4
    intervals: int | None = None
    multiple: int = 1
    tolerance: float = MESH_TOLERANCE
    forcing: ForcingPeriod | None = None
    origin: tuple[float, Array] | None = None  # parameter and period, states of the Hopf point it was born at
    angle_periods: Array = field(default_factory=lambda: np.zeros(0))  # the engine's wrapping is not used
    measures: Measures | None = None  # columns that are asked for beside those of every family

    def __post_init__(self) -> None:
        if self.system.is_forced and self.forcing is None:
            object.__setattr__(self, "forcing", ForcingPeriod.of(self.system))

    def profile(self, z: Array) -> Profile:
        return profile_of(z, self.n, self.points)

    @cached_property
    def equations(self) -> Any:
        """The kernels' view of the equations."""
        scheme, forcing = basis(self.points), 0 if self.forcing is None else self.forcing.address
        return Equations(
            self.system.value_address, self.system.jacobian_address, forcing, self.multiple, self.n, self.points,
            self.active, scheme.values, scheme.slopes, scheme.gauss, scheme.gauss_weights,
            np.asarray(self.winding, dtype=float), np.array(self.state_periods, dtype=float),
        )  # fmt: skip

    def laid(self, h: Array, profile: Profile) -> Array:
        """Any mesh does: where equations change formula, orbits are followed by shooting."""
        return h

    def sizes(self, z: Array, scale: Array) -> Array:
        """The states' sizes (n,) in a metric that belongs to z's mesh."""
        return sizes_of(scale, self.profile(z).h, self.n, self.points)

    def period_place(self, z: Array) -> int:
        return int(self.profile(z).u.size)

    @property
    @abstractmethod
    def width_at_birth(self) -> float:
        """Scale of the parameter of a family that was born at a Hopf point."""

    def at_shared_places(self, z: Array, values: Array) -> Array:
        """States, and the period beside them, at `PLACES` places of the period, (places, n + 1)."""
        return np.asarray(self.rows_at_shared_places(z[None], values[None, -z.size :])[0])

    def rows_at_shared_places(self, z: Array, values: Array) -> Array:
        return rows_at_places(self.points, self.n, z, values, PLACES)

    def of_one_mesh(self, one: Array, other: Array) -> bool:
        return of_one_mesh(self.profile(one), self.profile(other))

    def on_mesh_of(self, z: Array, other: Array) -> Array:
        return self.profile(z).on_mesh(self.profile(other).h).vector()

    def mesh_error(self, z: Array, sizes: Array) -> float:
        return estimate(self.profile(z), sizes[: self.n])[0]

    @property
    def resolution(self) -> float:
        return self.tolerance

    def is_constant(self, z: Array, scale: Array) -> bool:
        """True where the orbit is an equilibrium."""
        u = self.profile(z).u
        return bool(np.all(np.ptp(u, axis=0) <= CONSTANT * self.sizes(z, scale))) and not self.winding.any()

    def state_sizes(self, profile: Profile) -> Array:
        """Typical size of every state on an orbit, (n,)."""
        return state_sizes(self, profile)
