"""The curve of large orbits of one type in two parameters, with the points of codimension two on it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation import march as python_march
from contin.continuation.branch import End
from contin.continuation.outcome import NOTHING, Outcome, Verified, unverified
from contin.continuation.position import position
from contin.continuation.problem import Renewal
from contin.continuation.sample import Chunk, Frame, Sample, opposite
from contin.continuation.settings import Settings
from contin.errors import InputError
from contin.linalg.vectors import norm
from contin.loci.augmented.augmented_curve import AugmentedCurve
from contin.loci.augmented.branch_points_of_large_orbits import FEW_ROWS, while_across
from contin.loci.augmented.curve_equations import TURNS, Bounds, Held, Near
from contin.loci.augmented.large_orbits import BEHIND, LargeOrbitBase
from contin.loci.augmented.tests_of_large_orbits import curvature, graded
from contin.loci.orbits import criticality
from contin.loci.orbits.curve_of_orbits import ANGLES
from contin.loci.without_coefficients import with_remark
from contin.machine import elementary
from contin.problems.large_orbits.codimension_two import why_none, with_coefficients
from contin.problems.large_orbits.multipliers import REAL, critical_index, critical_pair, stay_outside
from contin.problems.large_orbits.radau import Trajectory
from contin.problems.orbits.hopf_end import cut_at_birth, has_shrunk, is_growing
from contin.problems.orbits.zero_of_test import Zero, zero_of_test
from contin.records import Fields
from contin.special.table import tests_of_orbits

RESIDUAL_LIMIT: Final = 1e-5  # of a test, which are of order one
POLE: Final = 0.1  # of a coefficient as part of its terms: it does not vanish there
SAFETY: Final = 2.0  # of the change to a finer mesh, which has an error of its own
BRACKET: Final = 1e-3  # (scaled arclength) half-width, within which an event has been isolated
ONLY_TORI: Final = ("LPNS", "PDNS", "NSNS", "R3", "R4")  # none of two real multipliers with product 1
GRADED: Final = ("CPC", "GPD", "CH")  # which the coefficient tells
FORCED: Final = 1e-3  # of the tangent of a curve of branch points: more opens the orbits
FEW: Final = {"pairs": 2, "flips": 1, "ones": 1}
KINDS: Final = ("pairs", "flips", "ones")


@dataclass(eq=False)
class LastNear:
    """The equations near the last sample that was asked about."""

    asked: Array | None = None  # z and its metric
    near: Near | None = None


@dataclass(frozen=True, eq=False)
class LargeOrbitCurve(AugmentedCurve):
    """`base` is a `LargeOrbitBase`, `type` LPC, PD, NS or BPC."""

    base: LargeOrbitBase
    _last: LastNear = field(default_factory=LastNear)
    critical: Fields = field(default_factory=dict)  # what `criticality` remembers

    adaptive = True

    def effort(self) -> dict[str, int]:
        """As of families."""
        return self.base.problem.effort()

    def tangents(self, z: Array, scale: Array) -> Sequence[Array]:
        found = super().tangents(z, scale)
        if self.type == "BPC" and not abs(found[0][-BEHIND]) < FORCED:
            raise InputError(
                f"BPC: nothing forces this branch point when {self.names[0]} and {self.names[1]} vary (no symmetry, no "
                "family that stays): it is single in their plane and has no curve there; try another second parameter"
            )
        return found

    def near(self, z: Array, scale: Array, more: tuple[Held, ...] = ()) -> Near | None:
        """As of every curve; what solves have learnt before, elsewhere, is left out, for answers depend on z alone."""
        self.base.problem.memory.solvers = None
        return super().near(z, scale, more)

    def measured_beside(self, type_: str, sample: Sample, frame: Frame) -> Sample:
        return criticality.beside_pole(self, type_, sample, frame.scale)

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        last = self._last
        asked = np.concatenate([base.z, frame.scale])
        if last.asked is None or not np.array_equal(last.asked, asked):
            last.asked = asked
            last.near = self.beside(base.z, frame).near(base.z, frame.scale)
        found = None if last.near is None else python_march.probe(last.near, base, length, guess, frame, settings)
        if found is None:
            return None
        found.tests[:TURNS] = 1.0
        return criticality.measured(self, found, frame.scale) if criticality.is_measured(self, base) else found

    def march(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        bounds: Bounds, settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        limit = min(limit, FEW_ROWS) if self.type == "BPC" else limit
        chunk = super().march(origin, before, length, frame, step, limit, bounds, settings, loop)
        chunk = while_across(chunk) if self.type == "BPC" else chunk
        chunk = criticality.cut_at_change(self, chunk, frame.scale)
        return cut_at_birth(self, chunk, frame, settings)

    def further(self, z: Array) -> float:
        """`critical_coefficient` itself has no value for two real multipliers."""
        return 0.0

    def critical_coefficient(self, z: Array, scale: Array) -> tuple[float, float]:
        """c of PD or Re d of NS as part of the terms that it is made of, and 1."""
        return graded(self.base.at(z), self.base.inner(z), self.type), 1.0

    # orbits that shrink to a Hopf point -------------------------------------------------------------------------------

    @property
    def winding(self) -> Array:
        """What each state gains in one period."""
        return self.base.problem.winding

    def profile(self, z: Array) -> Trajectory:
        """The orbit."""
        return self.base.at(z).profile(self.base.inner(z))

    def orbit_sizes(self, z: Array, scale: Array) -> Array:
        """Sizes of the states (n,) in a metric of z."""
        return self.base.problem.orbit_sizes(self.base.inner(z), self.base.inner(scale))

    def renew(
        self, origin: Sample, before: Sample | None, loop: Sample | None, frame: Frame, settings: Settings
    ) -> Renewal:
        end = None
        if has_shrunk(self, origin.z, frame.scale) and not is_growing(self, before, origin, frame.scale):
            end = End("hopf", f"the orbit shrank to a Hopf point near {position(self, origin.z)}")
        return Renewal(frame.scale, origin, before, loop, end)

    # points of codimension two ---------------------------------------------------------------------------------------

    def test_of(self, type_: str) -> int | None:
        names = tests_of_orbits(self.type)
        return TURNS + names.index(type_) if type_ in names else None

    def explain(self, a: Sample, b: Sample) -> tuple[str, ...] | None:
        changed = opposite(a.tests[TURNS:], b.tests[TURNS:])
        moved = abs(a.unstable - b.unstable)
        if changed[0] and moved == 0 and stay_outside(a.eigenvalues, b.eigenvalues):
            changed[0] = False  # two real multipliers have met there, or parted
        types = tuple(name for name, c in zip(tests_of_orbits(self.type), changed, strict=True) if c)
        if len(types) > 1:
            return None
        by = [FEW[kind] for kind, c in zip(KINDS, changed, strict=False) if c]
        return types if moved == sum(by) else None

    def verify(self, type_: str, near: Sample, frame: Frame) -> Outcome:
        """The zero of a test along the curve, and how far it is from that on a mesh of half the lengths."""
        index = self.test_of(type_)
        if type_ not in GRADED and self.type in criticality.SLOTS:  # the coefficient is not asked for
            near = replace(near, tests=np.append(near.tests[: criticality.SLOTS[self.type]], np.nan))
        zero = None if index is None else zero_of_test(self, near, frame, index, BRACKET)
        if index is None or zero is None:
            return unverified(type_, "its test function has no zero nearby")
        found = zero.sample
        if self.type == "NS" and type_ in ONLY_TORI and self._is_neutral(found.eigenvalues):
            return NOTHING
        if type_ in ("GPD", "CH") and zero.value > POLE:
            return NOTHING  # a pole, at a strong resonance
        if type_ == "CPC" and has_shrunk(self, found.z, frame.scale):
            return NOTHING  # the curve turns round at its generalised Hopf point
        if type_ == "CPC" and abs(curvature(self.base.at(found.z), self.base.inner(found.z), self.base.second)) > POLE:
            return NOTHING  # the second parameter turns
        if not zero.value <= RESIDUAL_LIMIT:
            return unverified(type_, f"its test function jumps across zero (residual {zero.value:.1e})")
        finer = self._on_finer_mesh(found, frame, index)
        if finer is None:
            return unverified(type_, "it is not there on a mesh of half the lengths")
        there, fine = finer
        moved = float(np.abs(fine.sample.z[[-1, -2]] - found.z[[-1, -2]]).max())
        error = 10.0 * zero.error * float(frame.scale[-1]) + SAFETY * moved
        point = Verified(type_, found.z, zero.value, error, found.eigenvalues, found.unstable)
        return self._with_coefficients(point, there.base, fine.sample.z)

    def _with_coefficients(self, point: Verified, finer: LargeOrbitBase, z: Array) -> Verified:
        """finer, z : the base of the curve on half the lengths, and the point there."""
        coarse = self.base.at(point.z), self.base.inner(point.z)
        why = why_none(point.type, coarse[0]) if self.type != "BPC" else "they are not computed on curves of BPC"
        if why is not None:
            return with_remark(point, f"orbits of large systems: {why}")
        angle = ANGLES.get(point.type, 0.0)
        if point.type == "CH":
            values = point.eigenvalues[1:]  # without the trivial one
            k = critical_index(values, self.type)
            if k is None:
                return with_remark(point, "orbits of large systems: the pair on the unit circle is lost")
            angle = float(elementary.angle(values[k]))
        return with_coefficients(point, angle, coarse, (finer.at(z), finer.inner(z)))

    def verify_compound(self, a: Sample, b: Sample, frame: Frame) -> Sequence[Outcome]:
        changed = opposite(a.tests[TURNS:], b.tests[TURNS:])
        types = [name for name, c in zip(tests_of_orbits(self.type), changed, strict=True) if c]
        return [self.verify(type_, a, frame) for type_ in types]

    def refined(self, sample: Sample, frame: Frame) -> tuple[LargeOrbitCurve, Sample, Frame] | None:
        base, moved, metric = self.base.finer(sample.z)
        curve = replace(self, base=base, _last=LastNear())
        scale = metric(frame.scale)
        tangent = moved(sample.tangent * frame.scale) / scale
        near = replace(sample, z=moved(sample.z), tangent=tangent / norm(tangent))
        found = curve.probe(near, 0.0, near.z.copy(), Frame(scale), Settings())
        return None if found is None else (curve, found, Frame(scale))

    def _on_finer_mesh(self, found: Sample, frame: Frame, index: int) -> tuple[LargeOrbitCurve, Zero] | None:
        fine = self.refined(found, frame)
        zero = None if fine is None else zero_of_test(*fine, index, BRACKET)
        return None if fine is None or zero is None else (fine[0], zero)

    def same_point(self, a: Verified, b: Verified, scale: Array) -> bool:
        slack = 3.0 * (a.error + b.error) + 1e-9 * scale[-2:]
        return bool(np.all(np.abs(a.z[-2:] - b.z[-2:]) <= slack))

    def remarks(self, z: Array, eigenvalues: NDArray[np.complex128]) -> Sequence[str]:
        neutral = np.array([self.type == "NS" and self._is_neutral(values) for values in eigenvalues])
        tori = np.flatnonzero(~neutral)
        untold = self._untold(z[tori[len(tori) // 2]]) if tori.size else ()
        if not neutral.any():
            return (*self.words, *untold)
        rows = f"{int(neutral.sum())} of {len(z)} rows of this curve have"
        beyond = f"{rows} two real multipliers with product 1 (beyond R1 or R2): no tori are born there"
        return (*self.words, *untold, beyond)

    @staticmethod
    def _is_neutral(eigenvalues: NDArray[np.complex128]) -> bool:
        """True where two real multipliers with product 1 stand for the pair of a torus."""
        values = eigenvalues[1:]  # without the trivial one
        pair = critical_pair(values)
        return pair is not None and abs(values[pair[0]].imag) <= REAL * abs(values[pair[0]])

    def _untold(self, z: Array) -> Sequence[str]:
        """That the coefficient, whose zero is a point of codimension two, is not known at a row."""
        name = next((name for name in tests_of_orbits(self.type) if name in GRADED), None)
        if name is None:
            return ()
        graded_by = self.type in criticality.SLOTS
        value = self.critical_coefficient(z, z)[0] if graded_by else self.base.stability(self.type, z)[0][-1]
        if np.isfinite(value):
            return ()
        return (f"{name} is not looked for: its coefficient is not told from rounding in the middle of the curve",)
