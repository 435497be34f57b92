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
from contin.continuation.sample import Chunk, Frame, Sample
from contin.continuation.settings import Settings
from contin.linalg.vectors import norm
from contin.loci.augmented.augmented_curve import AugmentedCurve
from contin.loci.augmented.curve_equations import TURNS, Bounds, Near
from contin.loci.augmented.large_orbits import LargeOrbitBase
from contin.loci.orbits.curve_of_orbits import ANGLES
from contin.loci.without_coefficients import with_remark
from contin.machine import elementary
from contin.problems.large_orbits.codimension_two import why_none, with_coefficients
from contin.problems.large_orbits.multipliers import critical_index, stay_outside
from contin.problems.large_orbits.radau import Trajectory
from contin.problems.orbits.hopf_end import cut_at_birth, has_shrunk, is_growing
from contin.problems.orbits.zero_of_test import Zero, zero_of_test
from contin.special.table import tests_of_orbits

RESIDUAL_LIMIT: Final = 1e-5  # of a test, which are of order one
POLE: Final = 0.1  # of a coefficient as part of its terms: it does not vanish there
SAFETY: Final = 2.0  # of the change to a finer mesh, which has an error of its own
BRACKET: Final = 1e-3  # (scaled arclength) half-width, within which an event has been isolated
MEETING: Final = 0.95  # |cos theta| from which a curve of tori that ends does so where its pair meets
GRADED: Final = ("CPC", "GPD", "CH")  # which the coefficient tells
FEW: Final = {"pairs": 2, "flips": 1, "ones": 1}
KINDS: Final = ("pairs", "flips", "ones")


@dataclass(eq=False)
class LastNear:
    """The equations near the last sample that was asked about."""

    asked: Array | None = None  # z and its metric
    near: Near | None = None


@dataclass(frozen=True, eq=False)
class LargeOrbitCurve(AugmentedCurve):
    """`base` is a `LargeOrbitBase`, `type` LPC, PD or NS."""

    base: LargeOrbitBase
    _last: LastNear = field(default_factory=LastNear)

    adaptive = True

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        last = self._last
        asked = np.concatenate([base.z, frame.scale])
        if last.asked is None or not np.array_equal(last.asked, asked):
            last.asked = asked
            last.near = self.beside(base.z, frame).near(base.z, frame.scale)
        found = None if last.near is None else python_march.probe(last.near, base, length, guess, frame, settings)
        if found is not None:
            found.tests[:TURNS] = 1.0
        return found

    def march(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        bounds: Bounds, settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        chunk = super().march(origin, before, length, frame, step, limit, bounds, settings, loop)
        return cut_at_birth(self, chunk, frame, settings)

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
        changed = a.tests[TURNS:] * b.tests[TURNS:] < 0.0
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
        curve = self if type_ in GRADED else replace(self, base=replace(self.base, graded=False), _last=LastNear())
        zero = None if index is None else zero_of_test(curve, near, frame, index, BRACKET)
        if index is None or zero is None:
            return unverified(type_, "its test function has no zero nearby")
        found = zero.sample
        if type_ in ("GPD", "CH") and zero.value > POLE:
            return NOTHING  # a pole, at a strong resonance
        if type_ == "CPC" and has_shrunk(self, found.z, frame.scale):
            return NOTHING  # the curve turns round at its generalised Hopf point
        if not zero.value <= RESIDUAL_LIMIT:
            return unverified(type_, f"its test function jumps across zero (residual {zero.value:.1e})")
        finer = curve._on_finer_mesh(found, frame, index)
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
        why = why_none(point.type, coarse[0])
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
        changed = a.tests[TURNS:] * b.tests[TURNS:] < 0.0
        types = [name for name, c in zip(tests_of_orbits(self.type), changed, strict=True) if c]
        return [self.verify(type_, a, frame) for type_ in types]

    def refined(self, sample: Sample, frame: Frame) -> tuple[LargeOrbitCurve, Sample, Frame] | None:
        base, moved, metric = self.base.finer(sample.z)
        held = tuple(replace(one, base=base) for one in self.held)  # type: ignore[type-var]
        curve = replace(self, base=base, held=held, _last=LastNear())
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
        untold = self._untold(z[len(z) // 2])
        if self.type != "NS":
            return (*self.words, *untold)
        resonances = []
        for values in (eigenvalues[0, 1:], eigenvalues[-1, 1:]):
            critical = values[int(np.argmin(np.abs(np.abs(values) - 1.0)))]
            if abs(critical.real) > MEETING:
                resonances.append("1:1" if critical.real > 0.0 else "1:2")
        words = [
            f"an end is near a {one} resonance, which curves of NS of large orbits do not pass" for one in resonances
        ]
        return (*self.words, *untold, *words)

    def _untold(self, z: Array) -> Sequence[str]:
        """That the coefficient, whose zero is a point of codimension two, is not known at a row."""
        name = next(name for name in tests_of_orbits(self.type) if name in GRADED)
        if np.isfinite(self.base.stability(self.type, z)[0][-1]):
            return ()
        return (f"{name} is not looked for: its coefficient is not told from rounding in the middle of the curve",)
