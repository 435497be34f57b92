"""How the unknowns of a connecting orbit are stored, and what is read off them."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.homoclinic.reversor import Reversor
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.problems.orbits.mesh.layout import Profile
from contin.problems.orbits.two_parameters import CurveOfOrbits


@dataclass(frozen=True, eq=False)
class Gauge:
    """What is chosen for a stretch of a curve: phase reference, bases, and vectors that signs refer to.

    `vectors` are taken on from point to point within one call, which has a copy of them for itself.
    """

    reference: Array | None = None
    stable: Array | None = None
    unstable: Array | None = None
    borders: tuple[Array, Array] | None = None  # of the matrix at a saddle-node
    vectors: dict[str, Array] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class ConnectionLayout(CurveOfOrbits):
    """`orbits` gives the equations, with the first parameter free; counts: stable directions of x0, unstable of x1.

    They add up to n, to n - 1 at a saddle-node (`node`) and where only p is free. With a `reversor` the orbit is half
    of a symmetric one and ends in its fixed space, which `unstable_count` conditions say (see `reversor.py`).
    winding : whole turns of angles, by which u(1) is farther.
    """

    orbits: OrbitProblem
    second: int
    saddles: int  # 1 homoclinic, 2 heteroclinic
    stable_count: int
    unstable_count: int
    node: bool = False
    winding: Array | None = None
    slots: tuple[int, ...] = (-2, -1)  # of q and p those that are unknowns
    reversor: Reversor | None = None
    aim: Array | None = None  # of a homotopy, whose parameter stands in the place of q: see `projections`
    truncation: float | None = None  # distance of the ends from the saddles, relative to the orbit's extent
    doubting: bool = False  # for the error of its tests: the adjoint solution is followed less far
    gauge: Gauge | None = None
    type = "HOM"

    @property
    def n(self) -> int:
        return self.orbits.n

    def gauged(self, gauge: Any) -> Self:
        return self if gauge is None else replace(self, gauge=replace(gauge, vectors=dict(gauge.vectors)))

    @property
    def is_settled(self) -> bool:
        return self.chosen.reference is not None

    @property
    def chosen(self) -> Gauge:
        """The gauge; bases refer to nothing where there is none."""
        return Gauge() if self.gauge is None else self.gauge

    def join(self, profile: Profile, saddles: Array, q: float) -> Array:
        return np.concatenate([profile.u.ravel(), saddles.ravel(), [profile.period], profile.h, [q, profile.parameter]])

    def intervals(self, z: Array) -> int:
        return int((z.size - self.n * (1 + self.saddles) - 3) // (self.orbits.points * self.n + 1))

    def nodes(self, z: Array) -> int:
        """Number of node values."""
        return (self.intervals(z) * self.orbits.points + 1) * self.n

    def profile(self, z: Array) -> Profile:
        nu, count = self.nodes(z), self.intervals(z)
        place = nu + self.saddles * self.n
        u = z[:nu].reshape(-1, self.n)
        return Profile(self.orbits.points, u, float(z[place]), z[place + 1 : place + 1 + count], float(z[-1]))

    def equilibria(self, z: Array) -> Array:
        """(1 or 2, n)"""
        nu = self.nodes(z)
        return z[nu : nu + self.saddles * self.n].reshape(self.saddles, self.n)

    def termini(self, z: Array) -> tuple[Array, Array]:
        """Where the orbit comes from and where it goes to, both (n,)."""
        ends = self.equilibria(z)
        if self.reversor is not None:
            return ends[0], self.reversor.image(ends[0])
        return ends[0], ends[-1] if self.winding is None else ends[-1] + self.winding

    def orbit_of(self, z: Array) -> Profile:
        """The whole orbit, of which `profile` may be half."""
        half = self.profile(z)
        return half if self.reversor is None else self.reversor.whole(half)

    def is_complete(self) -> bool:
        """True where there are as many equations as unknowns but one."""
        wanted = self.n - int(self.node or len(self.slots) == 1) + int(self.reversor is not None)
        return self.stable_count + self.unstable_count == wanted

    def unknowns(self, z: Array) -> NDArray[np.intp]:
        """Places of (u, saddles, those of q and p that are free) in z."""
        return np.append(np.arange(self.nodes(z) + self.saddles * self.n), [z.size + slot for slot in self.slots])

    def full_parameters(self, z: Array) -> Array:
        p = self.orbits.full_parameters(z)
        if self.aim is None and -2 in self.slots:
            p[self.second] = z[-2]
        return p

    def matrix(self, u: Array, z: Array) -> Array:
        """f_u at a state."""
        return np.asarray(self.orbits.system.jacobian(u, self.full_parameters(z))[1][:, : self.n])

    def scaled_matrix(self, u: Array, z: Array, sizes: Array) -> Array:
        """f_u at a state, of states relative to their sizes."""
        return np.asarray(self.matrix(u, z) * sizes / sizes[:, None])

    def offsets(self, z: Array, sizes: Array) -> tuple[Array, Array]:
        """Of both ends of the orbit from the saddles, relative to the states' sizes."""
        u, (first, last) = z[: self.nodes(z)], self.termini(z)
        return (u[: self.n] - first) / sizes, (u[-self.n :] - last) / sizes
