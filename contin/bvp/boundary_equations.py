"""The equations of a boundary-value problem on a mesh, one parameter varying."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Self

import numpy as np

from contin.abi import Array
from contin.bvp.two_point import TwoPoint, two_point
from contin.bvp.workspace import Workspace
from contin.continuation.choices import Choices
from contin.continuation.problem import Problem
from contin.errors import InputError
from contin.kernels.boundary_march import Conditions, new_conditions
from contin.kernels.collocation import Equations
from contin.kernels.collocation_basis import basis
from contin.problems.orbits.mesh.layout import (
    Profile,
    at_places,
    of_one_mesh,
    profile_of,
    rows_at_places,
    sizes_of,
    trimmed,
)
from contin.problems.surfaces.of_parameters import choices_of

MESH_TOLERANCE = 1e-7  # error inside an interval, relative to the functions' sizes
LONGEST_CHUNK = 300
PLACES = 65  # at which functions of different rows are compared


@dataclass(frozen=True, eq=False)
class BoundaryEquations(Problem):
    """u' = F(u, p, s), g(u(0), u(1), p) = 0 with one parameter varying.

    two : the standard form.  base : values of its parameters (m,); entry `active` varies.  points : Gauss points an
    interval.  intervals : fixed number of mesh intervals, or None.
    """

    two: TwoPoint
    base: Array
    active: int
    points: int = 4
    intervals: int | None = None
    tolerance: float = MESH_TOLERANCE
    angle_periods: Array = field(default_factory=lambda: np.zeros(0))
    spaces: dict[int, Workspace] = field(default_factory=dict)
    kind = "bvp"
    adaptive = True
    has_shared_places = True
    locus = None
    closed = False
    maximum_chunk = LONGEST_CHUNK

    @property
    def system(self) -> Any:
        return self.two.system

    @property
    def n(self) -> int:
        return self.two.n

    @cached_property
    def parameters(self) -> tuple[str, ...]:
        return (self.two.parameters[self.active],)

    @property
    def free_names(self) -> tuple[str, ...]:
        """Parameters that are solved for."""
        return tuple(self.two.free)

    @cached_property
    def state_periods(self) -> Array:
        """None of the functions is an angle."""
        return np.zeros(self.n)

    @cached_property
    def equations(self) -> Equations:
        """The kernels' view of the equations."""
        scheme, system = basis(self.points), self.two.system
        return Equations(
            system.value_address, system.jacobian_address, self.two.period.address, 1, self.n, self.points, self.active,
            scheme.values, scheme.slopes, scheme.gauss, scheme.gauss_weights, np.zeros(self.n), self.state_periods,
        )  # fmt: skip

    @cached_property
    def at_ends(self) -> Conditions:
        """The kernels' view of the conditions."""
        address = self.two.conditions.jacobian_address
        return new_conditions(address, self.n, len(self.two.parameters))  # type: ignore[no-untyped-call,no-any-return]

    def with_active(self, name: str, z: Array) -> Self:
        """The same solutions with another parameter varying; the present one is frozen at its value in z."""
        if name not in self.two.parameters:
            raise InputError(f"{name} is solved for (`free`), and cannot vary too")
        base = self.base.copy()
        base[self.active] = z[-1]
        return replace(self, base=base, active=self.two.parameters.index(name), spaces={})

    def with_free(self, free: Sequence[str], name: str, z: Array, values: Mapping[str, float]) -> tuple[Self, Array]:
        """The same solution z with other parameters solved for, `name` varying, and its unknowns there.

        values : of all parameters. InputError where the conditions are too few or too many for `free`.
        """
        two, profile = two_point(self.two.model, free), self.profile(z)
        if name not in two.parameters:
            raise InputError(f"{name} is solved for (`free`), and cannot vary too")
        u = profile.u.copy()
        u[:, two.n_states : two.n_states + len(two.free)] = [values[q] for q in two.free]
        base = np.array([values[q] for q in two.parameters])
        problem = replace(self, two=two, base=base, active=two.parameters.index(name), spaces={})
        return problem, replace(profile, u=u, parameter=values[name]).vector()

    def workspace(self, intervals: int, p: Array) -> Workspace:
        """The kernels' memory for this many intervals."""
        if intervals not in self.spaces:
            self.spaces.clear()
            self.spaces[intervals] = Workspace.of(self.n, self.points, intervals, p)
        work = self.spaces[intervals]
        work.points.p[:] = p
        return work

    def asked_alone(self, values: Array) -> Array:
        """Each function, by its mean square, and the parameter: values of one mesh."""
        intervals = (values.shape[1] - self.n - 2) // (self.points * self.n + 1)
        nodes = values[:, : (intervals * self.points + 1) * self.n].reshape(len(values), -1, self.n)
        return np.column_stack([np.linalg.norm(nodes, axis=1), np.abs(values[:, -1])])

    def at_shared_places(self, z: Array, values: Array) -> Array:
        """At `PLACES` places of the interval, (places, n)."""
        return at_places(self.points, self.profile(values[-trimmed(z).size :]).u, self.profile(z).h, PLACES)

    def rows_at_shared_places(self, z: Array, values: Array) -> Array:
        return rows_at_places(self.points, self.n, z, values, PLACES)[:, :, : self.n]

    def of_one_mesh(self, one: Array, other: Array) -> bool:
        return of_one_mesh(self.profile(one), self.profile(other))

    def on_mesh_of(self, z: Array, other: Array) -> Array:
        return self.profile(z).on_mesh(self.profile(other).h).vector()

    def profile(self, z: Array) -> Profile:
        return profile_of(z, self.n, self.points)

    def sizes(self, z: Array, scale: Array) -> Array:
        """The functions' sizes (n,) in a metric that belongs to z's mesh."""
        return sizes_of(scale, self.profile(z).h, self.n, self.points)

    def full_parameters(self, z: Array) -> Array:
        """All parameter values at z, and a place for s: (m + 1,)."""
        p = np.append(self.base, 0.0)
        p[self.active] = z[-1]
        return p

    def conditions(self, profile: Profile, p: Array) -> tuple[Array, Array]:
        """g (n,) and its derivatives by (u(0), u(1), p)."""
        return self.two.conditions.jacobian(profile.u[0], profile.u[-1], p[:-1])

    def constants(self) -> dict[str, float]:
        return dict(zip(self.two.parameters, self.base.tolist(), strict=True))

    @property
    def formulas(self) -> object:
        return self.two.model

    def choices(self, z: Array) -> Choices:
        return choices_of(self, z)

    def default_range(self, parameter: str) -> tuple[float, float] | None:
        return self.two.model.parameter_range(parameter, self.constants())
