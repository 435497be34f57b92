"""Curves of folds of connecting orbits with cycles: where the manifolds that the orbit lies on touch."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Self

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.seed import Seed
from contin.homoclinic.cycle_connection_problem import ConnectionToCycle
from contin.homoclinic.hyperbolic_ends import beyond
from contin.loci.augmented.adaptive import AdaptiveCurve
from contin.loci.augmented.boundary import BoundaryBase
from contin.loci.augmented.of_boundary import boundary_base, start

if TYPE_CHECKING:
    from contin.model.model import Model

CHUNK = 5  # a step takes some 0.2 s


@dataclass(frozen=True, eq=False)
class TangencyBase(BoundaryBase):
    """Folds of a branch of connecting orbits, with its columns and the reach of its equations."""

    problem: ConnectionToCycle

    @property
    def model(self) -> Model:
        return self.problem.model

    def at(self, z: Array) -> ConnectionToCycle:
        """The branch through z at the parameters in z."""
        base = self.problem.base.copy()
        base[list(self.places)] = self.values(z)
        return replace(self.problem, base=base)

    def constants(self) -> dict[str, float]:
        known = super().constants()
        return {name: known[name] for name in self.model.parameter_names if name in known}

    def corrected(self, z: Array) -> Self:
        """With the ends on their manifolds to second order."""
        return replace(self, problem=self.at(z).bent(self.inner(z)))

    def left_reach(self, z: Array) -> tuple[int, str] | None:
        for k, row in enumerate(z):
            text = beyond(self.at(row), self.inner(row))
            if text is not None:
                return k, text
        return None

    def columns(self, z: Array) -> dict[str, Array]:
        rows = [self.at(row).columns(self.inner(row)[None]) for row in z]
        found = {name: np.array([row[name][0] for row in rows]) for name in rows[0]}
        varying = np.array([self.values(row) for row in z])
        return {**{name: varying[:, k] for k, name in enumerate(self.names)}, **found}

    def column_names(self) -> tuple[str, ...]:
        return (*self.names, *self.problem.column_names()[1:])


@dataclass(frozen=True, eq=False)
class CurveOfTangencies(AdaptiveCurve):
    """In two parameters."""

    base: TangencyBase

    maximum_chunk = CHUNK

    def orbit_at(self, z: Array) -> object:
        """The connecting orbit alone, with its time."""
        return self.base.at(z).orbit_at(self.base.inner(z))


def curve_of(problem: ConnectionToCycle, point: SpecialPoint, parameters: Sequence[str]) -> Seed:
    """The curve through a fold of a branch of connecting orbits, in two parameters."""
    base = boundary_base(problem, point.z, "LP", parameters, scale=point.scale)
    assert isinstance(base.problem, ConnectionToCycle)
    own = TangencyBase(base.problem, base.places, base.type, usual=base.usual)
    curve = CurveOfTangencies(own, (), "LP", tuple(parameters))
    return Seed(curve, start(own, point.z), parent=Parent.of(point))
