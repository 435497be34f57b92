"""Test functions along a curve of connecting orbits, named as in HomCont and MatCont.

    NSS NSF NFF   resonance: the leading eigenvalues have real parts nu_s + nu_u = 0 (none, one, both of them complex)
    NCH           an eigenvalue of the saddle vanishes: non-central homoclinic orbit to a saddle-node; along orbits to
                  a saddle-node, one of their ends has no part in the direction of that eigenvalue
    SH            a pair becomes imaginary: Shilnikov-Hopf
    OFS OFU       orbit flip: the orbit enters (leaves) along the strong stable (unstable) directions
    DRS DRU       two leading eigenvalues of one side are alike: real before, a pair beyond (Belyakov)
    NDS NDU       the leading eigenvalues, a pair on one side, have zero sum of real parts: neutrally divergent
    TLS TLU       a pair and a real eigenvalue of one side, both leading, have one real part
    IFS IFU       inclination flip: so does the bounded solution of the adjoint variational equation
Champneys and Kuznetsov, Int. J. Bifurcation and Chaos 4 (1994) 785; flips have a sign where the leading eigenvalue is
real.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.outcome import NOTHING, Outcome, Verified, unverified
from contin.continuation.sample import Frame, Sample
from contin.homoclinic import flips, significance
from contin.homoclinic.subspaces import leading
from contin.problems.orbits.ends.distances import extent_of
from contin.problems.orbits.ends.saddle_node import centrality
from contin.problems.orbits.zero_of_test import zero_of_test
from contin.special.table import tests_of_connections

if TYPE_CHECKING:
    from contin.homoclinic.curve_of_connections import CurveOfConnections
    from contin.homoclinic.equations import ConnectionCurve

LOST: Final = 1e-6  # rate of an unstable direction of a reversible flow, of the largest, at which it is none any more
ROUNDING: Final = 1e-11  # of a sum of two eigenvalues, relative
ABOVE_ROUNDING: Final = 1e-8  # of its largest value: where the adjoint solution, which decays, has a direction
NOT_AS_FAR: Final = 5.0  # ... times this where the error that is left there is estimated
SAFETY: Final = 2.0  # of what a finer mesh changes, which has an error of its own
FOLD: Final = "LP"


def tests_at(
    curve: ConnectionCurve, z: Array, sizes: Array, adjoint: Array | None
) -> tuple[Array, NDArray[np.complex128]]:
    """The tests from index 2 on and the eigenvalues of the (first) saddle."""
    ends = curve.equilibria(z)
    matrices = [curve.scaled_matrix(u, z, sizes) for u in ends]
    n = curve.n
    values = np.linalg.eigvals(matrices[0]).astype(complex)
    values = values[np.lexsort((-values.imag, -values.real))]
    if curve.node:
        tests = np.full(len(tests_of_connections()), np.nan)
        tests[1] = centrality(matrices[0], *curve.offsets(z, sizes), extent_of(curve.profile(z), sizes))
        return tests, values
    if curve.reversor is not None:  # the reversor maps stable directions to unstable ones: no resonance, no flips
        slow_out = leading(matrices[0], n - curve.stable_count, False)
        tests = np.full(len(tests_of_connections()), np.nan)
        tests[1] = slow_out.value.real / float(np.abs(values).max()) - LOST
        return tests, values
    leave, arrive = n - curve.stable_count, n - curve.unstable_count  # dimensions of the manifolds that it lies in
    slow_out, slow_in = leading(matrices[0], leave, False), leading(matrices[-1], arrive, True)
    size = abs(slow_in.value) + abs(slow_out.value)
    tests = np.full(len(tests_of_connections()), np.nan)
    sum_of_rates = (slow_in.value.real + slow_out.value.real) / size
    tests[1] = min(-slow_in.value.real, slow_out.value.real) / size
    if len(curve.slots) == 1:  # resonances and flips are no bifurcations of connections that persist
        return tests, values
    tests[0] = sum_of_rates if abs(sum_of_rates) > ROUNDING else 0.0  # resonant all along: no sign of its own
    tests[6:12] = spectral_tests(values if curve.saddles == 1 else np.empty(0, complex), leave, arrive)
    memory, profile = curve.chosen.vectors, curve.profile(z)
    away, home = flips.ends_of_orbit(profile, curve.termini(z), sizes)
    first = last = None  # of the adjoint solution where it is accurate
    if adjoint is not None and curve.saddles == 1:
        least = ABOVE_ROUNDING * (NOT_AS_FAR if curve.doubting else 1.0)
        first, last = flips.ends_of_adjoint(profile, _same_sense(memory, adjoint), least)
    if arrive > 1:  # with one direction, none is stronger
        tests[2] = flips.component(memory, "OFS", slow_in, slow_in.left, home)
        tests[4] = flips.component(memory, "IFS", slow_in, slow_in.right, first)
    if leave > 1:
        tests[3] = flips.component(memory, "OFU", slow_out, slow_out.left, away)
        tests[5] = flips.component(memory, "IFU", slow_out, slow_out.right, last)
    return tests, values


def spectral_tests(values: NDArray[np.complex128], leave: int, arrive: int) -> Array:
    """DRS, DRU, NDS, NDU, TLS, TLU of a saddle with `arrive` stable and `leave` unstable directions; NaN: no meaning.

    A discriminant ((a - b) / (|a| + |b|))^2 is positive for real a, b and negative for a pair.
    """
    tests = np.full(6, np.nan)
    if len(values) != leave + arrive:
        return tests
    order = np.argsort(values.real)
    sides = values[order[:arrive][::-1]], values[order[arrive:]]  # both from the slowest on
    for k, (own, other) in enumerate((sides, sides[::-1])):
        if len(own) > 1:
            ratio = (own[0] - own[1]) / (abs(own[0]) + abs(own[1]))
            tests[k] = float((ratio * ratio).real)
        size = max(abs(own[0]), abs(other[0])) if len(own) and len(other) else 1.0
        if len(own) > 1 and len(other) and own[0].imag != 0.0:
            tests[2 + k] = float((2.0 * own[0].real + other[0].real) / size)
        reals, pairs = own[own.imag == 0.0], own[own.imag > 0.0]
        if len(reals) and len(pairs) and any(own[0] == one or own[0] == np.conj(one) for one in (reals[0], pairs[0])):
            tests[4 + k] = float((reals[0].real - pairs[0].real) / size)
    return tests


def _same_sense(memory: dict[str, Array], adjoint: Array) -> Array:
    """The adjoint solution with the sense that it had at the last point: compared row by row along the orbit."""
    known = memory.get("adjoint")
    if known is not None:
        own, old = np.linspace(0.0, 1.0, len(adjoint)), np.linspace(0.0, 1.0, len(known))
        there = np.stack([np.interp(own, old, column) for column in known.T], axis=1)
        if float(np.sum(there * adjoint)) < 0.0:
            adjoint = -adjoint
    memory["adjoint"] = adjoint
    return adjoint


def explain(problem: CurveOfConnections, a: Sample, b: Sample) -> tuple[str, ...] | None:
    changed = changes(problem, a, b)
    return changed if len(changed) <= 1 else None


def changes(problem: CurveOfConnections, a: Sample, b: Sample) -> tuple[str, ...]:
    """The tests that change sign between two points; of connections that persist, the fold of their branch too."""
    names, start = (FOLD, *tests_of_connections()), (a.tests[0], *a.tests[2:])
    signs = zip(names, start, (b.tests[0], *b.tests[2:]), strict=True)
    return tuple(name for name, x, y in signs if x * y < 0.0 and (name != FOLD or problem.isolated))


def test_of(type_: str) -> int | None:
    if type_ == FOLD:
        return 0
    tests = tests_of_connections()
    return 2 + tests.index(type_) if type_ in tests else None


def verify(problem: CurveOfConnections, type_: str, near: Sample, frame: Frame) -> Outcome:
    """The zero of a test along the curve."""
    index = test_of(type_)
    assert index is not None
    zero = zero_of_test(problem, near, frame, index)
    place = near if zero is None else zero.sample
    slope = significance.slope_beside(problem, place, frame, index)
    if slope == 0.0 and type_ == FOLD:
        return unverified(type_, "the parameter hardly moves: its test function is no more than its errors")
    if slope == 0.0:
        return NOTHING  # an invariant plane or a skew product: no coupling, all along the curve
    if zero is None:
        return unverified(type_, "its test function has no zero nearby")
    found = zero.sample
    if significance.jumps(zero.value, slope):
        return unverified(type_, "its test function jumps")
    moved = problem.discretisation(found, frame, index)
    if moved is None:
        return unverified(type_, "not found again on a mesh of half the lengths")
    own = zero.error + significance.displacement(problem, found, frame, index, slope)
    error = 10.0 * own * float(frame.scale[-1]) + SAFETY * moved
    return Verified(_named(type_, found.eigenvalues), found.z, zero.value, error, found.eigenvalues, found.unstable)


def _named(type_: str, values: NDArray[np.complex128]) -> str:
    """The code that says which of the leading eigenvalues are complex."""
    if type_ not in ("NSS", "NCH"):
        return type_
    if type_ == "NCH":
        return "SH" if values[int(np.argmin(np.abs(values.real)))].imag != 0.0 else "NCH"
    slow_in = max(values[values.real < 0.0], key=lambda v: v.real, default=0.0)
    slow_out = min(values[values.real > 0.0], key=lambda v: v.real, default=0.0)
    pairs = int(np.imag(slow_in) != 0.0) + int(np.imag(slow_out) != 0.0)
    return ("NSS", "NSF", "NFF")[pairs]
