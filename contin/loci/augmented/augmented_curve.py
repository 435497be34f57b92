"""A curve of special solutions in two or three parameters, on any equations that solve bordered systems.

z = (unknowns of the equations, further parameters q, .., second parameter, first parameter). E(z) = 0 are equations of
a discretisation (`contin.loci.augmented.base`), h(z) = 0 the scalars that are held: a condition of the user's,
a degeneracy, an extremum. As many parameters vary as make a curve of what vanishes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation import march as python_march
from contin.continuation.problem import Chunk, Frame, Outcome, Problem, Sample, Stop
from contin.continuation.settings import Settings
from contin.errors import InputError
from contin.loci.augmented import events
from contin.loci.augmented.base import Base
from contin.loci.augmented.elimination import Augmented, Scalars, first_rows, null_space, orthonormal
from contin.loci.augmented.scalar_conditions import Held, joined

Bounds = tuple[float, float]
TOLERANCE = 1e-11
CHUNK = 20
ROUNDS = 3  # until the border rows span the null space
TURNS = 2  # tests of the curve itself, where a parameter turns or a branch crosses: nothing of the points on it
EVERYWHERE = (-np.inf, np.inf)


@dataclass(frozen=True, eq=False)
class AugmentedCurve(Problem):
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

    def default_range(self, parameter: str) -> Bounds | None:
        return self.base.default_range(parameter)

    # -- what makes it planar ------------------------------------------------------------------------------------------

    def within(self, *bounds: Bounds) -> AugmentedCurve:
        """The same curve with ranges of the named parameters."""
        return replace(self, bounds=tuple(bounds))

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

    def at_unknown(self, index: int, guess: Array, value: float, scale: Array) -> Array | None:
        z0 = guess.copy()
        z0[index] = value
        near = self.near(z0, scale)
        return None if near is None else python_march.with_one_fixed(near, index, guess, value, scale, TOLERANCE)

    def at_parameter(self, guess: Array, value: float, scale: Array) -> Array | None:
        return self.at_unknown(-1, guess, value, scale)

    # -- the engine's contract -----------------------------------------------------------------------------------------

    def initial_scale(self, z: Array, bounds: Bounds) -> Array:
        known = self.bounds or (bounds,)
        ranges = [known[k] if k < len(known) else EVERYWHERE for k in range(len(self.names))]
        return self.base.scales(z, [*ranges, *[EVERYWHERE] * (self.base.varying - len(ranges))])

    def near(self, z: Array, scale: Array, more: tuple[Held, ...] = ()) -> Near | None:
        """The curve with border rows and scalars that are good near z; None where its equations have no value."""
        rows = first_rows(self.base.varying - self.base.conditions, z.size)
        for _ in range(ROUNDS):
            here = self.base.linearise(z, scale, rows)
            if here is None or here.sign == 0.0:
                return None
            found = null_space(here, len(rows))
            if not np.all(np.isfinite(found)):
                return None
            rows = orthonormal(found.T)
        return Near(self, self.base, rows, joined((*self.held, *more), self, z, scale))

    def tangents(self, z: Array, scale: Array) -> Sequence[Array]:
        near = self.near(z, scale)
        border = np.random.default_rng(3).normal(size=z.size)
        tangent = None if near is None else python_march.null_vector(near, z, scale, border, ROUNDS)
        if tangent is None:
            raise InputError(f"the curve cannot be followed from here. {self.describe_failure(z)}")
        return [tangent]

    def march(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        bounds: Bounds, settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        self.base.settle(origin.z)
        near = self.near(origin.z, frame.scale)
        if near is None:
            return _failed(origin, step)
        limit = min(limit, self.maximum_chunk)
        if before is not None:  # whose tests of the curve were put aside
            before = replace(before, tests=np.append(np.full(TURNS, np.nan), before.tests[TURNS:]))
        chunk = python_march.march(
            near, origin, before, length, frame, step, limit, bounds, settings, loop, planar=self
        )
        chunk.tests[:, :TURNS] = 1.0
        return chunk

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        near = self.near(base.z, frame.scale)
        found = None if near is None else python_march.probe(near, base, length, guess, frame, settings)
        if found is not None:
            found.tests[:TURNS] = 1.0
        return found

    def explain(self, a: Sample, b: Sample) -> tuple[str, ...] | None:
        return self.base.explain(self.type, a, b)

    def watch(self, type_: str) -> int | None:
        return self.base.watch(self.type, type_)

    def verify(self, type_: str, near: Sample, frame: Frame) -> Outcome:
        return events.verify(self, type_, near, frame)

    def verify_compound(self, a: Sample, b: Sample, frame: Frame) -> Sequence[Outcome]:
        return events.verify_compound(self, a, b, frame)

    def finite(self, z: Array, values: NDArray[np.complex128]) -> NDArray[np.complex128]:
        return self.base.finite(z, values)

    def left_reach(self, z: Array) -> tuple[int, str] | None:
        return self.base.left_reach(z)

    def columns(self, z: Array) -> dict[str, Array]:
        return self.base.columns(z)

    def column_names(self) -> tuple[str, ...]:
        """Names that `columns` gives."""
        return self.base.column_names()

    def remarks(self, z: Array, eigenvalues: NDArray[np.complex128]) -> Sequence[str]:
        return self.words

    def describe_failure(self, z: Array) -> str:
        own = self.base.describe_failure(z)
        held = ", ".join(one.text for one in self.held)
        return own or (
            f"The equations of the curve ({held or self.type}) may be singular here: these points may not form a curve "
            "in the parameters named, or two curves cross. Try other parameters, or a smaller settings.step."
        )


def _failed(origin: Sample, step: float) -> Chunk:
    """A march that took no step."""
    return Chunk(
        origin.z[None], origin.tangent[None], origin.tests[None], np.array([origin.unstable]), origin.eigenvalues[None],
        np.zeros(1), Stop.CORRECTOR, step, 0.0, 0, 1,
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class Near:
    """A curve as the march in Python takes it: with border rows and scalars from a point nearby."""

    problem: AugmentedCurve
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
