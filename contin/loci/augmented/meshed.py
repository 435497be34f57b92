"""Solutions on an adaptive mesh as a base of curves: what periodic orbits and boundary-value problems share.

z = (u at the nodes, one number, mesh, [unfolding of branch points], parameters, the last one first); the number is the
period of an orbit, 1 of another boundary-value problem. Rows of one chunk are padded with nan on their left.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Generic, Protocol, Self, TypeVar

import numpy as np

from contin.abi import Array
from contin.loci.augmented.base import Base, OfSolutions
from contin.loci.augmented.elimination import Scalars
from contin.loci.augmented.singular import Borders
from contin.model.model import Model
from contin.problems.orbits.mesh.layout import Profile, trimmed
from contin.problems.scales import parameter_width
from contin.problems.two_parameters import OnAdaptiveMesh


class OnMeshes(OfSolutions, Protocol):
    """The problem of the solutions themselves, with one parameter active."""

    @property
    def base(self) -> Array: ...

    def profile(self, z: Array) -> Profile: ...

    def initial_scale(self, z: Array, bounds: tuple[float, float]) -> Array: ...


P = TypeVar("P", bound=OnMeshes)


@dataclass(frozen=True, eq=False)
class Chosen:
    """For a stretch of a curve: borders on a mesh, and the solution that a phase condition refers to."""

    mesh: Array
    borders: Borders | None
    reference: Array

    def borders_on(self, mesh: Array) -> Borders | None:
        """None where they are of another mesh."""
        return self.borders if np.array_equal(self.mesh, mesh) else None


@dataclass(frozen=True, eq=False)
class MeshedBase(OnAdaptiveMesh, Base, Generic[P]):
    """problem : of the solutions, the first parameter active.  places : of the varying parameters, the last unknown
    first, among those of `problem`.  type : of the special solutions, or "" for solutions themselves.
    """

    problem: P
    places: tuple[int, ...]
    type: str
    chosen: Chosen | None = None

    @property
    def gauge(self) -> Any:
        return self.chosen

    @property
    def is_settled(self) -> bool:
        return self.chosen is not None

    def gauged(self, gauge: Any) -> Self:
        return self if gauge is None else replace(self, chosen=gauge)

    @property
    @abstractmethod
    def model(self) -> Model:
        """The equations, which declare ranges of parameters."""

    @abstractmethod
    def based(self, base: Array) -> P:
        """The problem of the solutions at other constants."""

    # -- the parts of z ------------------------------------------------------------------------------------------------

    @property
    def extra(self) -> int:
        """Unknowns that unfold branch points."""
        return int(self.type in ("BP", "BPC"))

    @property
    def behind(self) -> int:
        """Unknowns behind the mesh."""
        return len(self.places) + self.extra

    def inner(self, z: Array) -> Array:
        """(u, number, mesh, first parameter), also of a metric or tangent."""
        z = trimmed(z)
        return np.append(z[: -self.behind], z[-1])

    def joined(self, inner: Array, rest: Array) -> Array:
        """z from `inner` and the unknowns behind the mesh (`rest`)."""
        return np.append(inner[:-1], rest)

    def rest(self, z: Array) -> Array:
        return z[-self.behind :]

    def values(self, z: Array) -> Array:
        """Values of the varying parameters, in the order of `places`."""
        return trimmed(z)[: -1 - len(self.places) : -1]

    def profile(self, z: Array) -> Profile:
        return self.problem.profile(self.inner(z))

    def at(self, z: Array) -> P:
        """The problem of the solutions at the parameters in z."""
        base = self.problem.base.copy()
        base[list(self.places)] = self.values(z)
        return self.based(base)

    # -- the base's contract -------------------------------------------------------------------------------------------

    @property
    def angle_periods(self) -> Array:
        return np.zeros(0)

    @property
    def conditions(self) -> int:
        return int(self.type != "")

    def null_functions(self, z: Array) -> Array | None:
        """(nodes, k) of the special solution at z, of largest value 1, which the mesh is to serve too, or None."""
        return None

    def scales(self, z: Array, ranges: Sequence[tuple[float, float]]) -> Array:
        triples = zip(self.names, self.values(z), ranges, strict=True)
        widths = [parameter_width(self.model, name, float(v), ends) for name, v, ends in triples]
        inner = self.at(z).initial_scale(self.inner(z), ranges[0])
        return self.joined(inner, np.array([*[1.0] * self.extra, *widths[::-1]]))


@dataclass(frozen=True)
class MeshedUnfolding:
    """Branch points that nothing forces: a parameter more takes the place of the unfolding."""

    base: MeshedBase[Any]
    text: str = "branch points"

    def near(self, problem: object, z: Array, scale: Array) -> Scalars:
        place = -1 - len(self.base.places)
        return lambda at: at[[place]]
