"""A curve of special solutions in two or three parameters, on any equations that solve bordered systems.

z = (unknowns of the equations, further parameters q, .., second parameter, first parameter). E(z) = 0 are equations of
a discretisation (`contin.loci.augmented.base`), h(z) = 0 the scalars that are held: a condition of the user's,
a degeneracy, an extremum. As many parameters vary as make a curve of what vanishes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation import march as python_march
from contin.continuation.outcome import Outcome
from contin.continuation.sample import Chunk, Frame, Sample, Stop
from contin.continuation.settings import Settings
from contin.errors import InputError
from contin.loci.augmented import events
from contin.loci.augmented.curve_equations import TURNS, Bounds, CurveEquations
from contin.problems.tolerances import ONE_FIXED

ROUNDS = 3  # until the tangent lies in the null space


@dataclass(frozen=True, eq=False)
class AugmentedCurve(CurveEquations):
    """The equations of `CurveEquations`, followed by the march in Python."""

    # -- both parameters ----------------------------------------------------------------------------------------------

    def within(self, *bounds: Bounds) -> AugmentedCurve:
        """The same curve with ranges of the named parameters."""
        return replace(self, bounds=tuple(bounds))

    def at_unknown(self, index: int, guess: Array, value: float, scale: Array) -> Array | None:
        z0 = guess.copy()
        z0[index] = value
        near = self.near(z0, scale)
        return None if near is None else python_march.with_one_fixed(near, index, guess, value, scale, ONE_FIXED)

    def at_parameter(self, guess: Array, value: float, scale: Array) -> Array | None:
        return self.at_unknown(-1, guess, value, scale)

    # -- the engine's contract -----------------------------------------------------------------------------------------

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
        own = replace(self, base=self.base.gauged(frame.gauge).settled(origin.z, frame.scale))
        near = own.near(origin.z, frame.scale)
        if near is None:
            return _failed(origin, step)
        limit = min(limit, self.maximum_chunk)
        if before is not None:  # whose tests of the curve were put aside
            before = replace(before, tests=np.append(np.full(TURNS, np.nan), before.tests[TURNS:]))
        chunk = python_march.march(
            near, origin, before, length, frame, step, limit, bounds, settings, loop, walled=self
        )
        chunk.tests[:, :TURNS] = 1.0
        return replace(chunk, gauge=own.base.gauge)

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        near = self.beside(base.z, frame).near(base.z, frame.scale)
        return None if near is None else python_march.probe(near, base, length, guess, frame, settings, turns=False)

    def explain(self, a: Sample, b: Sample) -> tuple[str, ...] | None:
        return self.base.explain(self.type, a, b)

    def verify(self, type_: str, near: Sample, frame: Frame) -> Outcome:
        return events.verify(self.beside(near.z, frame), type_, near, frame)

    def verify_compound(self, a: Sample, b: Sample, frame: Frame) -> Sequence[Outcome]:
        return events.verify_compound(self.beside(a.z, frame), a, b, frame)

    def finite(self, z: Array, values: NDArray[np.complex128]) -> NDArray[np.complex128]:
        return self.base.finite(z, values)

    def left_reach(self, z: Array) -> tuple[int, str] | None:
        return self.base.left_reach(z)

    def columns(self, z: Array) -> dict[str, Array]:
        return self.base.columns(z)

    def column(self, name: str, z: Array) -> Array:
        return self.base.column(name, z)

    def column_names(self) -> tuple[str, ...]:
        """Names that `columns` gives."""
        return self.base.column_names()

    def remarks(self, z: Array, eigenvalues: NDArray[np.complex128]) -> Sequence[str]:
        return [*self.words, *self.base.remarks(self, z)]

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


