"""Points of codimension two on curves of special orbits, told by the other multipliers and by the curve itself.

on LPC   R1 (a third multiplier 1), LPPD, LPNS, CPC (both parameters turn: the fold's coefficient vanishes)
on BPC   R1, LPPD, LPNS of the multipliers beside the critical one
on PD    R2 (a second multiplier -1), LPPD, PDNS, GPD (the coefficient c vanishes)
on NS    R1, R2, R3, R4 (cos theta = 1, -1, -1/2, 0), LPNS, PDNS, NSNS, CH (Re d vanishes)
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.continuation.outcome import NOTHING, Outcome, Verified, unverified
from contin.continuation.sample import Frame, Sample, opposite
from contin.loci.orbits import criticality
from contin.loci.without_coefficients import with_remark
from contin.problems.orbits.linearised.multipliers import without
from contin.problems.orbits.zero_of_test import zero_of_test
from contin.special.table import special_type, tests_of_orbits

if TYPE_CHECKING:
    from contin.loci.orbits.curve_of_orbits import CurveOfSpecialOrbits

    Refined = tuple[CurveOfSpecialOrbits, Sample, Frame]

RESIDUAL_LIMIT: Final = 1e-5  # of a test of multipliers, angles or the speed, all of which are of order one
SAFETY: Final = 2.0  # of the error by a finer mesh, which has one of its own
PLACED: Final = 1e-2  # (scaled) an estimated error above this locates nothing
SOME: Final = "cycles with algebraic states, or on curves of BPC or of touching orbits"
ALONG: Final = 10.0  # a point on a curve moves along it, too, when the equations change: no more than that is presumed

NOISE: Final = 1e-13  # a multiplier this near to the unit circle is on it
FURTHER: Final = {  # by curve and point: the multiplier that is critical beside those of the curve, where it is real
    ("LPC", "R1"): 1.0, ("BPC", "R1"): 1.0, ("LPC", "LPPD"): -1.0, ("BPC", "LPPD"): -1.0,
    ("PD", "R2"): -1.0, ("PD", "LPPD"): 1.0, ("NS", "LPNS"): 1.0, ("NS", "PDNS"): -1.0,
}  # fmt: skip


def explain(locus: str, a: Sample, b: Sample) -> tuple[str, ...] | None:
    """The types whose test functions change sign; () where nothing of interest does.

    Tests stand from index 2 on: of the remaining multipliers `pairs`, `flips`, `ones`, then those of the type itself.
    """
    changed = opposite(a.tests[2:], b.tests[2:])
    types = tuple(name for name, c in zip(tests_of_orbits(locus), changed, strict=True) if c)
    return types if len(types) <= 1 else None


def test_of(locus: str, type_: str) -> int | None:
    tests = tests_of_orbits(locus)
    return 2 + tests.index(type_) if type_ in tests else None


def critical(locus: str, further: float) -> tuple[complex, ...]:
    """The multipliers that are critical along a curve; of NS a pair with product 1 and sum 2 `further`."""
    if locus in ("LPC", "BPC"):
        return (1.0,)
    if locus == "PD":
        return (-1.0,)
    root = np.sqrt(complex(further * further - 1.0))
    return complex(further + root), complex(further - root)


def verify(problem: CurveOfSpecialOrbits, type_: str, near: Sample, frame: Frame) -> Outcome:
    """The zero of a test function along the curve, with its coefficients."""
    found = located(problem, type_, near, frame)
    if not isinstance(found, tuple):
        return found
    point, finer = found
    where = SOME if special_type(type_).powers else "cycles"
    return with_remark(problem.with_coefficients(point, frame, *finer), where)


def located(
    problem: CurveOfSpecialOrbits, type_: str, near: Sample, frame: Frame
) -> Outcome | tuple[Verified, Refined]:
    """The zero of a test function along the curve, by secants in a bracket; none where a neutral pair crosses.

    With the zero on a finer mesh.
    """
    index = test_of(problem.locus, type_)
    if index is None:
        return unverified(type_, "no test of this curve has it")
    zero = zero_of_test(problem, near, frame, index)
    if zero is None:
        return unverified(type_, "its test function has no zero nearby")
    found = zero.sample
    if type_ == "CPC" and (problem.has_shrunk(found.z, frame.scale) or problem.has_met_half(found.z, frame.scale)):
        return NOTHING  # the curve turns round at its generalised Hopf point or period doubling
    if type_ == tests_of_orbits(problem.locus)[0] and not _complex_pair(problem, found):
        return NOTHING
    if type_ in ("LPNS", "PDNS", "NSNS", "R3", "R4") and problem.locus == "NS" and abs(found.z[-3]) > 1.0:
        return NOTHING
    if type_ in ("GPD", "CH"):
        if criticality.is_pole(problem.curve, zero.value):
            return NOTHING  # at a strong resonance
        resolved = criticality.is_zero(problem.curve, zero.value)
    else:
        resolved = zero.value <= RESIDUAL_LIMIT
    if not resolved:
        return unverified(type_, f"its test function jumps across zero (residual {zero.value:.1e})")
    finer = _on_finer_mesh(problem, found, frame, index)
    if finer is None:
        return unverified(type_, "it is not there on a mesh of half the lengths")
    moved = float(np.abs(finer[1].z[[-1, -2]] - found.z[[-1, -2]]).max())
    error = 10.0 * zero.error * float(frame.scale[-1]) + SAFETY * moved
    error += ALONG * problem.error_of_equations(found.z, frame.scale)
    if not error <= PLACED * float(frame.scale[-1]):
        return unverified(type_, f"its place is known to {error:.1e} only")
    return Verified(type_, found.z, zero.value, error, found.eigenvalues, _unstable(problem, type_, found)), finer


def _unstable(problem: CurveOfSpecialOrbits, type_: str, found: Sample) -> int:
    """How many multipliers that are critical neither along the curve nor at the point are unstable."""
    others = problem.others(found.eigenvalues, found.z)
    further = FURTHER.get((problem.locus, type_))
    if further is not None:
        others = without(others, [further])
    elif type_ == tests_of_orbits(problem.locus)[0]:
        pairs = others[others.imag > 0.0]
        nearest = pairs[np.argmin(np.abs(np.abs(pairs) - 1.0))]
        others = without(others, [nearest, nearest.conj()])
    else:
        return found.unstable
    return int(np.count_nonzero(np.abs(others) > 1.0 + NOISE))


def _on_finer_mesh(problem: CurveOfSpecialOrbits, found: Sample, frame: Frame, index: int) -> Refined | None:
    """The point on a mesh of half the lengths (itself without a mesh); None where it is not found there."""
    refined = problem.on_finer_mesh(found, frame)
    if refined is None:
        return problem, found, frame
    again = zero_of_test(refined[0], refined[1], refined[2], index)
    return None if again is None else (refined[0], again.sample, refined[2])


def _complex_pair(problem: CurveOfSpecialOrbits, sample: Sample) -> bool:
    """True where the pair on the unit circle is complex: two real multipliers with product 1 are no torus."""
    values = problem.others(sample.eigenvalues, sample.z)
    if len(values) < 2:
        return False
    gaps = [(abs(values[i] * values[j] - 1.0), abs(values[i].imag)) for i in range(len(values)) for j in range(i)]
    return bool(min(gaps)[1] > 1e-9)
