"""Equilibria of large systems (sparse or matrix-free Jacobians) as a continuation problem in one parameter.

One factorisation a Newton step, block elimination around it, eigenvalues from the same factors: memory and, for banded
Jacobians, time are proportional to n.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from contin.abi import Array
from contin.continuation import corrector
from contin.continuation import march as python_march
from contin.continuation.outcome import Outcome, Rejected, Verified, unverified
from contin.continuation.sample import Chunk, Frame, Sample
from contin.continuation.settings import Settings
from contin.linalg.krylov import TOLERANCE
from contin.linalg.linear import DirectLinear, KrylovLinear
from contin.linalg.newton import Rules, newton
from contin.linalg.vectors import norm
from contin.problems.sparse import special_points
from contin.problems.sparse.large_equations import LONG_STRIDE, STRIDE, LargeEquations
from contin.problems.state_columns import state_columns
from contin.problems.symmetry import reversing_symmetries
from contin.problems.turning_at_folds import no_fold

UNEVEN = 30.0  # ratio of sizes of states that are far apart
ROUGHLY = 1e-6  # part of a residual that iterative solvers may leave: it is many times as large along a null vector
POLISHED = Rules(settled=1e-14, stalled=1e-6, far=1.0, ratio=0.9, budget=60)  # beside singular points: a series


@dataclass(frozen=True, eq=False)
class LargeProblem(LargeEquations):
    """The equations of `LargeEquations`, followed by the march in Python."""

    @cached_property
    def maximum_chunk(self) -> int:
        return int(np.clip(400_000 // self.n, 2, 20))

    # evaluation -------------------------------------------------------------------------------------------------------

    # the engine's contract --------------------------------------------------------------------------------------------

    def initial_scale(self, z: Array, bounds: tuple[float, float]) -> Array:
        """The same size for all states (in proportion to `typical`, if given): the norm is that of a function.

        Lengths are divided by `STRIDE`: steps are dear here, and go further; the more so where every solve is a
        search (`LONG_STRIDE`).
        """
        width = bounds[1] - bounds[0] if np.isfinite(bounds[1] - bounds[0]) else max(1.0, abs(float(z[-1])))
        typical = self.system.model.typical
        unit = typical / float(np.abs(typical).max())
        size = float(np.max(np.abs(z[:-1]) / unit, initial=0.0))
        linear = self.linear(z)
        motion = 0.0
        if linear is not None:
            motion = float(np.max(np.abs(linear.solve(self.parameter_slope(z))) / unit)) * width
            motion = motion if np.isfinite(motion) else 0.0
        if size > 1e-14:
            size = max(size, min(motion, 10.0 * size))
        else:
            size = motion if motion > 1e-14 else float(np.abs(typical).max())
        stride = LONG_STRIDE if isinstance(linear, KrylovLinear) else STRIDE
        return stride * np.append(np.sqrt(self.n) * size * unit, width)

    def tangents(self, z: Array, scale: Array) -> Sequence[Array]:
        self.precisely(z)
        return special_points.tangents(self, z, scale)

    def march(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        bounds: tuple[float, float], settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        if before is None:
            self.begin(origin.z)
        return python_march.march(
            self, origin, before, length, frame, step, limit, bounds, settings, loop, self.again,
            decisions=corrector.Decisions(cubic=True),
        )  # fmt: skip

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        return python_march.probe(self, base, length, guess, frame, settings)

    def at_parameter(self, guess: Array, value: float, scale: Array) -> Array | None:
        left = ROUGHLY  # of a correction's length: as much as Newton's method will leave itself

        def correct(z: Array) -> tuple[float, Array] | None:
            nonlocal left
            linear = self.linear(z)
            if linear is None:
                return None
            step = linear.solve(-self.residual(z), left)
            size = norm(step / scale[:-1])
            left = min(ROUGHLY, max(size, TOLERANCE))
            return size, np.append(z[:-1] + step, value)

        found = newton(correct, np.append(guess[:-1], value), POLISHED)
        return None if found is None else found.at

    def explain(self, a: Sample, b: Sample) -> tuple[str, ...] | None:
        return special_points.explain(a, b, isinstance(self.work.linear, DirectLinear))

    def test_of(self, type_: str) -> int | None:
        return {"LP": 0, "HB": 2}.get(type_)

    def verify(self, type_: str, near: Sample, frame: Frame) -> Outcome:
        self.precisely(near.z)
        try:
            found = special_points.verify(self, type_, near, frame)
        except (ArithmeticError, np.linalg.LinAlgError) as error:
            return unverified(type_, str(error))
        if isinstance(found, Verified) and not np.isfinite(found.error):
            return unverified(type_, "its place is not determined to any accuracy")
        if type_ == "LP" and isinstance(found, Verified) and self.system.model.written is None:
            here = self.linearisation(found.z, near.tangent, frame.scale)
            here = here and replace(here, rough=True)  # for chords, which converge linearly anyway
            why = no_fold(self.residual, here, found.z, frame.scale)
            if why is not None:
                return Rejected(f"no LP: {why}")
        return found

    def verify_compound(self, a: Sample, b: Sample, frame: Frame) -> Sequence[Outcome]:
        return special_points.verify_compound(self, a, b, frame)

    def reverses(self, z: Array, tangent: Array, scale: Array, symmetries: Sequence[str]) -> bool:
        return any(name in symmetries for name in reversing_symmetries(self, z, tangent, scale))

    def columns(self, z: Array) -> dict[str, Array]:
        """The parameter, named states, what is recorded; and of many states their norm, smallest and largest value."""
        names = self.system.state_names
        columns: dict[str, Array] = {self.parameters[0]: z[:, -1].copy()}
        if not names:
            u = z[:, :-1]
            columns["norm"] = np.array([norm(row) for row in u]) / np.sqrt(self.n)
            columns["min"], columns["max"] = u.min(axis=1), u.max(axis=1)
        return columns | state_columns(self.system, z[:, :-1], lambda: self.rows_of_parameters(z))

    def explain_columns(self, z: Array) -> str | None:
        """The first observable that is not finite at z, and why."""
        text: str | None = self.system.why_observables_not_finite(z[:-1], self.full_parameters(z))
        return text

    def describe_failure(self, z: Array) -> str:
        u, p = z[:-1], self.full_parameters(z)
        near = self.system.trouble_near(u, p)
        if near:
            return f"Beyond, {near}"
        return self.system.why_not_finite(u, p) or (
            "Try a smaller settings.step, or a larger settings.tolerance; matrix-free: a better preconditioner."
            + self._uneven(u) + self.system.model.advice(u)
        )

    def _uneven(self, u: Array) -> str:
        """What may help where states whose sizes are far apart are measured in one size; empty where they are not."""
        typical, sizes = self.system.model.typical, np.abs(u[u != 0.0])
        if np.ptp(typical) > 0.0 or not sizes.size or sizes.max() < UNEVEN * sizes.min():
            return ""
        return " States in units of their own want the function's `typical` sizes: all are measured beside the largest."
