"""A curve of special solutions: equations, scalars that vanish besides, and both near a point."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.choices import Choices
from contin.continuation.corrector import is_singular
from contin.continuation.problem import Problem
from contin.continuation.sample import Frame
from contin.loci.augmented.base import Base
from contin.loci.augmented.elimination import Augmented, Scalars, first_rows, null_space, orthonormal
from contin.problems.surfaces.of_parameters import choices_of

Bounds = tuple[float, float]
TURNS = 2  # tests of the curve itself, where a parameter turns or a branch crosses: nothing of the points on it
EVERYWHERE = (-np.inf, np.inf)
CHUNK = 20


class Held(Protocol):
    """One or more scalars."""

    @property
    def text(self) -> str:
        """What vanishes, in words."""

    def near(self, problem: CurveEquations, z: Array, scale: Array) -> Scalars:
        """The scalars as smooth functions around z, with borders and references from there."""


def joined(held: tuple[Held, ...], problem: CurveEquations, z: Array, scale: Array) -> Scalars:
    """All scalars near z as one function."""
    parts = [one.near(problem, z, scale) for one in held]
    if len(parts) == 1:
        return parts[0]

    def values(at: Array) -> Array:
        return np.concatenate([part(at) for part in parts]) if parts else np.zeros(0)

    return values


@dataclass(frozen=True, eq=False)
class Near:
    """A curve as the march in Python takes it: with border rows and scalars from a point nearby."""

    problem: CurveEquations
    base: Base
    rows: Array
    scalars: Scalars

    @property
    def angle_periods(self) -> Array:
        return self.problem.angle_periods

    def values(self, z: Array) -> Array:
        """What is left of the scalars."""
        found = self.scalars(z)
        return found - np.array(self.problem.offset) if self.problem.offset else found

    def linearisation(self, z: Array, tangent: Array, scale: Array) -> Augmented | None:
        inner = self.base.linearise(z, scale, self.rows)
        if inner is None:
            return None
        values = self.values(z)
        if not np.all(np.isfinite(values)):
            return None
        return Augmented(inner, self.scalars, values, z, scale, tangent)

    def stability(self, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        return self.base.stability(self.problem.type, z)


@dataclass(frozen=True, eq=False)
class CurveEquations(Problem):
    """base : the equations E.  held : the scalars.  type : label of the points on the curve.

    names : of the parameters that the run names, the last unknown first.  free : of those solved for besides.
    bounds : ranges of the named parameters, in their order.  offset : what the scalars are to be, on the way to 0.
    """

    base: Base
    held: tuple[Held, ...]
    type: str
    names: tuple[str, ...]
    free: tuple[str, ...] = ()
    bounds: tuple[Bounds, ...] = ()
    offset: tuple[float, ...] = ()
    words: tuple[str, ...] = ()  # notes that hold all along
    kind = "locus"
    maximum_chunk = CHUNK

    @property
    def locus(self) -> str:
        return self.type

    @property
    def parameters(self) -> tuple[str, ...]:
        return self.names

    @property
    def free_names(self) -> tuple[str, ...]:
        return self.free

    @property
    def has_stability(self) -> bool:
        return self.base.has_stability

    @property
    def system(self) -> Any:
        return self.base.system

    @property
    def angle_periods(self) -> Array:
        return self.base.angle_periods

    def constants(self) -> dict[str, float]:
        return self.base.constants()

    @property
    def formulas(self) -> object:
        return self.base.problem.formulas

    def choices(self, z: Array) -> Choices:
        return choices_of(self, z)

    def default_range(self, parameter: str) -> Bounds | None:
        return self.base.default_range(parameter)

    @property
    def walls(self) -> Sequence[tuple[int, float, float]]:
        known = self.bounds or (EVERYWHERE,) * len(self.names)
        return [(-1 - k, *known[k]) for k in reversed(range(len(self.names)))]

    @property
    def identifying(self) -> NDArray[np.bool_]:
        return self.base.identifying

    @property
    def growing(self) -> NDArray[np.bool_]:
        return self.base.growing

    def initial_scale(self, z: Array, bounds: Bounds) -> Array:
        known = self.bounds or (bounds,)
        ranges = [known[k] if k < len(known) else EVERYWHERE for k in range(len(self.names))]
        return self.base.scales(z, [*ranges, *[EVERYWHERE] * (self.base.varying - len(ranges))])

    def near(self, z: Array, scale: Array, more: tuple[Held, ...] = ()) -> Near | None:
        """The curve with border rows and scalars that are good near z; None where its equations have no value."""
        own = self if self.base.is_settled else replace(self, base=self.base.settled(z, scale))
        base = own.base
        rows = first_rows(base.varying - base.conditions, z.size)
        here = base.linearise(z, scale, rows)
        if here is None or is_singular(here):
            return None
        found = null_space(here, len(rows))  # that of E', whatever the rows
        if not np.all(np.isfinite(found)):
            return None
        return Near(self, base, orthonormal(found.T), joined((*self.held, *more), own, z, scale))

    def beside(self, z: Array, frame: Frame) -> Self:
        """The curve as it is looked at next to a chunk; where there is none, next to z."""
        base = self.base.gauged(frame.gauge)
        return replace(self, base=base if base.is_settled else base.settled(z, frame.scale))

    def test_of(self, type_: str) -> int | None:
        return self.base.test_of(self.type, type_)
