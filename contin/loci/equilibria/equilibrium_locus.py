"""Curves of folds, Hopf points and branch points of equilibria (of maps: fixed points) in two parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.branch import End
from contin.continuation.outcome import Outcome
from contin.continuation.position import elsewhere, position
from contin.continuation.problem import Renewal
from contin.continuation.sample import STOPS, Chunk, Frame, Sample
from contin.continuation.settings import Settings
from contin.errors import NotFiniteError
from contin.kernels import locus as kernel
from contin.linalg import newton
from contin.loci.codim2 import degenerate, events, uncomputed_tests
from contin.loci.curve_of_points import LONGEST, CurveOfPoints, scalar_columns
from contin.loci.equilibria import timeless
from contin.loci.equilibria.across import usual_rate
from contin.loci.equilibria.curves import curve_of
from contin.loci.equilibria.extended import ExtendedCurve
from contin.loci.equilibria.half_cycles import halves_change_places, is_doubling, is_even
from contin.loci.equilibria.march import march, probe
from contin.loci.equilibria.neutral_plane import across
from contin.loci.neutral import with_told_crossings
from contin.loci.tolerances import FORCED_AT_POINTS
from contin.machine import elementary
from contin.problems.algebraic_states import finite_eigenvalues
from contin.problems.state_columns import state_columns
from contin.simulate.reach import has_reach, left_reach
from contin.systems.protocol import is_timeless

CHUNK = 250  # rows after which the border is looked at again
REACH = 12.5  # ... or, where steps are short, this arclength (so many of the longest steps by default)
FEW = 10  # states at most: some 50 ms
IMAGINARY = 1e-4  # relative size of an imaginary part that counts, and root of that of a real part that does not
_NONE = np.empty(0)
_KINDS = {"LP": 0, "HB": 1, "BP": 2}


@dataclass(frozen=True, eq=False)
class LocusProblem(CurveOfPoints):
    """The equations of `CurveOfPoints`, followed by a compiled march."""

    def of_type(self, type_: str, p: Array) -> LocusProblem:
        """The curve of another type in the same two parameters, the others being those of p."""
        own = self.curve
        curve = curve_of(type_, self.system, p, own.first, own.second, own.sizes)
        return replace(self, curve=curve, memory={})

    # -- the engine's contract ----------------------------------------------------------------------------------------

    @property
    def has_stability(self) -> bool:
        return not is_timeless(self.system)

    def initial_scale(self, z: Array, bounds: tuple[float, float]) -> Array:
        return np.asarray(self.curve.scales(z, self.widths(z, bounds)))

    def tangents(self, z: Array, scale: Array) -> Sequence[Array]:
        own = replace(self, curve=self.curve.settled(z, scale))
        return [own._tangent(z, scale)]

    def _tangent(self, z: Array, scale: Array) -> Array:
        _, jacobian = self.curve.linearise(z)
        if not np.all(np.isfinite(jacobian)):
            raise NotFiniteError(f"no curve passes here: {self.describe_failure(z)}")
        return np.asarray(np.linalg.svd(jacobian * scale / scale[:-1, None])[2][-1])

    def near(self, z: Array, frame: Frame) -> Self:
        """The curve as it is looked at next to a chunk; where there is none, as it was set out with, or next to z."""
        curve = self.curve.gauged(frame.gauge)
        return replace(self, curve=curve if curve.gauge is not None else curve.settled(z, frame.scale))

    def _parameters(self, z: Array, frame: Frame) -> Array:
        """Those of the kernel."""
        if frame.gauge is None and self.curve.gauge is None:
            return np.asarray(self.curve.settled(z, frame.scale).parameters(z))
        return np.asarray(self.curve.parameters(z, frame.gauge))

    def march(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        bounds: tuple[float, float], settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        found = self._marched(origin, before, length, frame, step, limit, settings, loop)
        found = with_told_crossings(self.locus, found)
        return found if self.has_stability else timeless.chunk_without(found)

    def _marched(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        limit = min(limit, self._most_rows(settings))
        known = self.curve.gauged(frame.gauge)
        if isinstance(known, ExtendedCurve):
            origin = replace(origin, z=across(known, origin.z))
        curve = known.settled(origin.z, frame.scale)
        own, renewed = replace(self, curve=curve), curve.turns_from(known)
        if not curve.compiled:
            marched = march(own, origin, before, length, frame, step, limit, settings, loop)
            return replace(marched, gauge=curve.gauge)

        n, rows, size = self.n, limit + 1, curve.size
        z, t, tests = np.empty((rows, size)), np.empty((rows, size)), np.empty((rows, kernel.TESTS))
        unstable = np.zeros(rows, np.int64)
        re, im, lengths, info = np.empty((rows, n)), np.empty((rows, n)), np.zeros(rows), np.zeros(6)
        first = own._realigned(origin, frame.scale) if renewed else origin.tangent
        z[0], t[0] = origin.z, first
        controls = np.array([
            step, settings.min_step, settings.max_step, elementary.cos(np.radians(settings.max_angle)),
            settings.newton_tolerance, length if before is not None else 0.0, np.radians(settings.max_angle) / 2.5,
            self._trust,
        ])  # fmt: skip
        reason = kernel.march(
            *self._functions, n, self.base.copy(), self._slots, curve.parameters(origin.z),
            curve.active, frame.scale, np.array(self.walls, dtype=float), controls, limit,
            first if before is None or renewed else before.tangent,
            np.zeros(kernel.TESTS) if before is None else before.tests,
            _NONE if loop is None else loop.z, _NONE if loop is None else loop.tangent,
            self.identifying.astype(float), self.angle_periods, self.growing.astype(float), z, t, tests, unstable,
            re, im, lengths, info,
        )  # fmt: skip
        m = int(info[0]) + 1
        chunk = Chunk(
            z[:m], t[:m], tests[:m], unstable[:m], re[:m] + 1j * im[:m], lengths[:m], STOPS[reason], float(info[1]),
            0.0, int(info[4]), int(info[2]), gauge=curve.gauge,
            crossed=(int(info[5]),) if info[5] > 0.0 else (),
        )  # fmt: skip
        return events.with_degeneracy(own, chunk) if self.locus == "BP" else chunk

    def _most_rows(self, settings: Settings) -> int:
        """In one call of the kernel."""
        quick = self.curve.compiled and self.n <= FEW
        return max(CHUNK, int(min(float(LONGEST), REACH / settings.max_step))) if quick else CHUNK

    def _realigned(self, origin: Sample, scale: Array) -> Array:
        """The tangent with a new border, in the sense in which states and parameters went on before."""
        tangent = np.asarray(self._tangent(origin.z, scale))
        seen = self.identifying
        return tangent if float(tangent[seen] @ origin.tangent[seen]) > 0.0 else -tangent

    @cached_property
    def _functions(self) -> tuple[int, int, int, int]:
        """Address of the extended system, the kernel's kind, addresses of the second and third derivatives."""
        system = self.curve.system
        third = system.form(3) if self.locus == "HB" else system.form(2)
        return self.curve.extended.jacobian_address, _KINDS[self.locus], system.form(2), third

    @cached_property
    def _slots(self) -> NDArray[np.int64]:
        """Places of the first and of the second parameter among those of the model."""
        return np.array([self.curve.first, self.curve.second])

    @property
    def _trust(self) -> float:
        return 0.0 if self.system.n_switches else 0.01

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        found = self._probed(base, length, guess, frame, settings)
        return found if self.has_stability else timeless.sample_without(found)

    def _probed(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        if not self.curve.compiled:
            return probe(self.near(base.z, frame), base, length, guess, frame, settings)

        curve, n = self.curve, self.n
        z, t, tests = np.empty(curve.size), np.empty(curve.size), np.empty(kernel.TESTS)
        re, im = np.empty(n), np.empty(n)
        count = kernel.probe(
            *self._functions, n, self.base.copy(), self._slots, base.z, base.tangent, length, guess,
            self._parameters(base.z, frame), curve.active, frame.scale, min(settings.tolerance, 1e-9), self._trust, z,
            t, tests, re, im,
        )  # fmt: skip
        if count >= 0 and self.locus == "BP":
            tests[events.DEGENERACY] = degenerate.test(self.near(base.z, frame), z)
        return None if count < 0 else Sample(z, t, tests, int(count), re + 1j * im)

    def points_between(
        self, base: Sample, ends: tuple[Sample, Sample], lengths: tuple[float, float], fractions: Sequence[float],
        frame: Frame, settings: Settings,
    ) -> Sequence[Sample | None] | None:  # fmt: skip
        known = self._between(base, ends, lengths, fractions, frame, settings)
        if known is None:
            return None
        z, t, tests, counts, values = known
        found = [None if row[3] < 0 else Sample(*row) for row in zip(z, t, tests, counts, values, strict=True)]
        return found if self.has_stability else [s and timeless.sample_without(s) for s in found]

    def tests_between(
        self, base: Sample, ends: tuple[Sample, Sample], lengths: tuple[float, float], fractions: Sequence[float],
        frame: Frame, settings: Settings,
    ) -> tuple[Array, Sequence[int]] | None:  # fmt: skip
        known = self._between(base, ends, lengths, fractions, frame, settings) if self.has_stability else None
        return None if known is None else (known[2], known[3])

    def _between(
        self, base: Sample, ends: tuple[Sample, Sample], lengths: tuple[float, float], fractions: Sequence[float],
        frame: Frame, settings: Settings,
    ) -> tuple[Array, Array, Array, list[int], NDArray[np.complex128]] | None:  # fmt: skip
        """z, tangents, tests, counts (-1 where there is no point) and eigenvalues; None where no kernel has them."""
        curve, n, (a, b), count = self.curve, self.n, ends, len(fractions)
        if not curve.compiled or self.locus == "BP":
            return None
        z, t, tests = np.empty((count, curve.size)), np.empty((count, curve.size)), np.empty((count, kernel.TESTS))
        (re, im), counts = np.full((2, count, n), np.nan), np.empty(count, np.int64)  # unknown where there is no point
        kernel.points_between(
            *self._functions, n, self.base.copy(), self._slots, base.z, base.tangent, a.z, a.tangent, b.z, b.tangent,
            np.array(fractions), np.array(lengths), self._parameters(base.z, frame), curve.active, frame.scale,
            min(settings.tolerance, 1e-9), self._trust, z, t, tests, re, im, counts,
        )  # fmt: skip
        return z, t, tests, counts.tolist(), re + 1j * im

    def at_unknown(self, index: int, guess: Array, value: float, scale: Array) -> Array | None:
        parameters = self.curve.settled(guess, scale).parameters(guess)
        return newton.with_one_fixed(lambda z: self.curve.linearise(z, parameters), index, guess, value, scale)

    def explain(self, a: Sample, b: Sample) -> tuple[str, ...] | None:
        def apart() -> bool:
            scale = self.initial_scale(a.z, self.first_bounds)
            return float(np.linalg.norm(((a.z - b.z) / scale)[self.identifying])) > events.JUMPING

        return events.explain(self.locus, a, b, self.system.kind == "map", apart)

    def test_of(self, type_: str) -> int | None:
        return events.test_of(self.locus, type_)

    def verify(self, type_: str, near: Sample, frame: Frame) -> Outcome:
        own = self.near(near.z, frame)
        if not own.curve.compiled:  # the borders of a chunk's first row may be no borders at its last one
            own = replace(own, curve=own.curve.settled(near.z, frame.scale))
        found = events.verify(own, type_, near, frame)
        return found if self.has_stability else timeless.point_without(found)

    def verify_compound(self, a: Sample, b: Sample, frame: Frame) -> Sequence[Outcome]:
        found = events.verify_compound(self.near(a.z, frame), a, b, frame)
        return found if self.has_stability else timeless.points_without(found)

    def reverses(self, z: Array, tangent: Array, scale: Array, symmetries: Sequence[str]) -> bool:
        return degenerate.is_mirror(self, z, self.initial_scale(z, self.first_bounds))

    def finite(self, z: Array, values: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """Without the eigenvalues of algebraic equations."""
        return finite_eigenvalues(self.system, values)

    @property
    def has_reach(self) -> bool:
        return has_reach(self.system)

    def left_reach(self, z: Array) -> tuple[int, str] | None:
        """The first row at which the model does not hold, and why."""
        p = np.tile(self.base, (len(z), 1))
        p[:, list(self.curve.places)] = z[:, -len(self.curve.places) :]
        return left_reach(self.system, z[:, : self.n], p)

    def past_half(self, z: Array) -> int | None:
        """Where the two halves of a cycle have changed places from one row to the next."""
        if not is_even(self.system):
            return None
        return halves_change_places(self.system, z[:, : self.n], [self.curve.full_parameters(row) for row in z])

    def foretold(self, origin: Sample, before: Sample | None, frame: Frame) -> Renewal | None:
        """What a curve of folds of cycles of maps was near when its corrector failed: a generalised period doubling."""
        z = origin.z
        if self.locus != "LP" or not is_doubling(self.system, z[: self.n], self.curve.full_parameters(z)):
            return None
        text = "came together with cycles of half the period, at their generalised period doubling near "
        return Renewal(frame.scale, origin, before, None, End("joined", text + self.place(z)))

    def columns(self, z: Array) -> dict[str, Array]:
        def parameters() -> Array:
            p = np.tile(self.base, (len(z), 1))
            p[:, self.curve.first], p[:, self.curve.second] = z[:, -1], z[:, -2]
            return p

        columns = self.parameter_columns(z) | state_columns(self.system, z[:, : self.n], parameters)
        columns |= scalar_columns(self.locus, z[:, -3])
        if self.locus == "BP" and self._is_unfolded(z):
            columns["unfolding"] = z[:, -3].copy()
        return columns

    def _is_unfolded(self, z: Array) -> bool:
        d = self.curve.sizes
        rate = float(np.linalg.norm(self.curve.matrix(z[0]) * d / d[:, None]))
        if self.n == 1:  # of one state f_u vanishes at branch points
            rate = usual_rate(self.system, z[0, :1], self.curve.full_parameters(z[0]), d)
        return bool(np.any(np.abs(z[:, -3]) > FORCED_AT_POINTS * rate))

    def remarks(self, z: Array, eigenvalues: NDArray[np.complex128]) -> Sequence[str]:
        """What holds all along the curve, and which tests failed on it."""
        return [*self._properties(z), *self._kernels_of_two(z), *uncomputed_tests.remarks(self, z)]

    def _kernels_of_two(self, z: Array) -> Sequence[str]:
        """Of algebraic equations, where no count of eigenvalues tells of them."""
        if self.has_stability:
            return []
        d = self.curve.sizes
        rows = timeless.where_two_vanish(np.array([self.curve.matrix(row) * d / d[:, None] for row in z]))
        if not rows:
            return []
        more = elsewhere(len(rows) - 1)
        return [
            f"the kernel of F_u has two dimensions near {position(self, z[rows[0]])}{more}: other curves of "
            f"{self.locus} or of branch points pass there; no label tells of it"
        ]

    def _properties(self, z: Array) -> Sequence[str]:
        if self.locus == "BP" and self._is_unfolded(z):
            return [
                "nothing forces these branch points (no symmetry, invariant subspace or solution that is always "
                "there): with two parameters they are isolated, and the curve is that of the unfolded equations "
                "f + unfolding w = 0, w the left null vector (column `unfolding`)"
            ]
        if self._carries_pair(z):
            return [
                "two more eigenvalues are imaginary all along these folds: the equations are degenerate (a first-order "
                "average, or a symmetry), and every point where they are would be a ZH; none is labelled"
            ]
        return []

    def _carries_pair(self, z: Array) -> bool:
        """True on a curve of folds along which a pair is on the imaginary axis too, wherever it is complex."""
        if self.locus != "LP" or self.n < 3 or self.system.kind == "map":
            return False
        seen = False
        for row in z[:: max(1, len(z) // 12)]:
            values = np.linalg.eigvals(self.curve.matrix(row))
            others = np.delete(values, int(np.argmin(np.abs(values))))
            size = float(np.abs(others).max())
            pairs = others[others.imag > IMAGINARY * size]
            if len(pairs):
                seen = True
                if float(np.abs(pairs.real).min()) > elementary.square(IMAGINARY) * size:
                    return False
        return seen

    def describe_failure(self, z: Array) -> str:
        text = self.system.why_not_finite(z[: self.n], self.curve.full_parameters(z))
        if text:
            return str(text)
        return (
            "The defining system may be singular here (two such curves cross, or the point is more degenerate than its "
            "type). Try a smaller settings.step or min_step."
        )
