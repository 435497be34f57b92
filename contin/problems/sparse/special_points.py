"""Special points of large systems: what a change means, location to full precision along the curve, switching.

A fold is a zero of dp/ds, a Hopf point one of the real part of an eigenvalue: smooth functions of the arclength, whose
zeros the secant method finds to rounding (`zero_on_curve`). A branch point, where the curve is not unique, is found on
the reduced equation. Errors are the scatter of results from points perturbed by 1e-9.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array, Vector
from contin.continuation.outcome import Outcome, Rejected, Verified, unverified
from contin.continuation.sample import Frame, Sample, opposite
from contin.errors import InputError, NotFiniteError
from contin.linalg.copies import kernel, rounding_of
from contin.linalg.linear import Linear, fastest_rate
from contin.linalg.newton import Rules, newton
from contin.linalg.pencil import inverse_of
from contin.linalg.vectors import norm
from contin.machine import elementary
from contin.normalforms.directions import any_branch_point
from contin.normalforms.later import stated
from contin.normalforms.multiple import LargeKernelError, require_countable
from contin.problems.coinciding import SEVERAL_PAIRS, with_hopf_points_told
from contin.problems.sparse import forms
from contin.problems.sparse.kernel_coefficients import kernel_coefficients
from contin.problems.sparse.multiple_kernel import Kernel, ReducedJet
from contin.problems.sparse.of_coarse_values import error_of_grain
from contin.problems.sparse.reduced_equation import Reduced, border_rows
from contin.problems.sparse.zero_on_curve import PERTURBATION, SAMPLES, At, zero_on_curve
from contin.problems.tolerances import CRITICAL, RESIDUAL_LIMIT_OF_LARGE

if TYPE_CHECKING:
    from contin.problems.sparse.large_equations import LargeEquations

EIGENPAIR = Rules(settled=1e-14, stalled=1e-6)
VANISHING = 1e5  # rounding errors of the matrix: eigenvalues as small vanish together
SINGULAR = 1e-11  # about the smallest singular value of a matrix that is singular, as a part of its size
EPSILON = float(np.finfo(float).eps)


def explain(a: Sample, b: Sample, factored: bool) -> tuple[str, ...] | None:
    """Event types that account for the change of the unstable count and of the signs of the tests; None: more than one.

    The determinant changes sign with the parity of the count, except at folds. Without factors it is silent; with them
    it tells a fold, next to which the count may be one of rounding, from a branch that turns where it crosses another.
    """
    fold, determinant, pairs, _ = (bool(x) for x in opposite(a.tests, b.tests))
    moved = abs(b.unstable - a.unstable)
    odd = moved % 2 == 1
    if moved == 0 and not fold and not determinant:
        return ()
    if fold and not determinant and (moved == 1 or (moved == 0 and factored)):
        return ("LP",)
    if moved <= 1 and odd != fold:
        return ("BP",)
    return ("HB",) if moved == 2 and pairs and not fold and not determinant else None


def verify(problem: LargeEquations, type_: str, near: Sample, frame: Frame) -> Outcome:
    """The point of this type near a sample, to full precision."""
    if type_ == "BP":
        return _branch_point(problem, near, frame)
    return _fold(problem, near, frame) if type_ == "LP" else _hopf(problem, near, frame)


def verify_compound(problem: LargeEquations, a: Sample, b: Sample, frame: Frame) -> list[Outcome]:
    """What can be told apart of several events at one place."""
    found: list[Outcome] = []
    if problem.explain(a, b) == ("BP",):
        found.append(_branch_point(problem, a, frame))
    elif opposite(a.tests[0], b.tests[0]):
        found.append(_fold(problem, a, frame))
    elif abs(a.unstable - b.unstable) > max(1, 2 * int(np.sum(_pairs_on_axis(a)))) and a.tests[2] * b.tests[2] > 0.0:
        found.append(_multiple(problem, a, frame, abs(a.unstable - b.unstable)))
    elif (a.unstable - b.unstable) % 2:
        found.append(_branch_point(problem, a, frame))
    if np.any(_pairs_on_axis(a)):
        found.append(_hopf(problem, a, frame))
    return with_hopf_points_told(found, frame.scale)


def _pairs_on_axis(sample: Sample) -> NDArray[np.bool_]:
    """Which eigenvalues, one of each pair, are on the imaginary axis or next to it."""
    values = sample.eigenvalues
    return (values.imag > 0) & (np.abs(values.real) < CRITICAL * np.abs(values))


# folds and Hopf points ------------------------------------------------------------------------------------------------


def _fold(problem: LargeEquations, near: Sample, frame: Frame) -> Outcome:
    found = zero_on_curve(problem, near, frame, lambda at: float(at.tangent[-1]))
    if found is None:
        return unverified("LP", "the parameter does not turn at one point of the curve")
    at, left, error = found.at, found.left, found.error
    values = problem.spectrum(at.z).values
    others = np.delete(values, int(np.argmin(np.abs(values)))) if values.size else values
    here = problem.linearisation(at.z, at.tangent, frame.scale)  # where solved by iteration, once more from at.tangent
    t = at.tangent if here is None else here.solve(np.append(np.zeros(problem.n), 1.0))
    linear = forms.linear_at(problem, at.z)
    q = forms.unit(linear, t[:-1] / norm(t) * frame.scale[:-1])
    along = forms.functional(linear, q)
    form = forms.fold(problem, at.z, q, along)
    error += 3.0 * forms.rounding_of_fold(problem, at.z, along)
    error += error_of_grain(problem, found, frame, linear.magnitude, lambda at: float(at.tangent[-1]))
    if found.slope != 0.0:  # the parameter's way, to second order, to where nothing is left
        error += elementary.square(left) / abs(found.slope) * float(frame.scale[-1])
    residual = max(at.residual, abs(left))
    if not residual < RESIDUAL_LIMIT_OF_LARGE + _floor(problem, at.z, frame):
        return unverified("LP", f"its defining system has no solution nearby (residual {residual:.1e})")
    return Verified("LP", at.z, residual, float(error), values, int(np.sum(others.real > 0.0)), form)


def linear_at(problem: LargeEquations, z: Array) -> Linear:
    """F_u at a point of the curve, where it is finite."""
    linear = problem.linear(z)
    assert linear is not None
    return linear


def _floor(problem: LargeEquations, z: Array, frame: Frame) -> float:
    """The residual that rounding leaves (scaled), of the Jacobian's terms."""
    terms = linear_at(problem, z).magnitude(np.abs(z[:-1]))
    return 100.0 * EPSILON * float(np.max(terms / frame.scale[:-1]))


def refine(linear: Linear, value: complex, q: Vector) -> tuple[complex, Vector]:
    """Newton on A q = l M q, c^H q = 1 (c = the start, normalised): one factorisation of A - l M an iteration."""
    q = q / norm(q)
    c = q.conj()

    def correct(at: tuple[complex, Vector]) -> tuple[float, tuple[complex, Vector]]:
        value, q = at
        moved = linear.weigh(q)
        solver = linear.shifted(value).bordered(-moved[:, None], c[:, None], np.zeros((1, 1)))
        right = np.append(-(linear.apply(q) - value * moved), 1.0 - c @ q)
        step = solver.solve(right.astype(complex))
        change = complex(step[-1])
        return abs(change) / max(abs(value), 1e-300), (value + change, q + step[:-1])

    found = newton(correct, (value, q), EIGENPAIR)
    return (value, q) if found is None else found.at


def _hopf(problem: LargeEquations, near: Sample, frame: Frame) -> Outcome:
    spectrum = problem.spectrum(near.z)
    pairs = np.flatnonzero(spectrum.values.imag > 0.0)
    if not pairs.size:
        return Rejected("HB: the two eigenvalues that cross are real")
    k = pairs[int(np.argmin(np.abs(spectrum.values[pairs].real) / np.abs(spectrum.values[pairs])))]
    value, q = complex(spectrum.values[k]), spectrum.vectors[:, k]
    frequency = abs(value.imag)

    def growth(at: At) -> float:
        nonlocal value, q
        value, q = refine(linear_at(problem, at.z), value, q)
        return value.real / frequency

    found = zero_on_curve(problem, near, frame, growth)
    if found is None:
        return unverified("HB", "the real part of the eigenvalue has no zero nearby")
    at, left, error, slope = found.at, found.left, found.error, found.by_parameter
    error += error_of_grain(problem, found, frame, linear_at(problem, at.z).magnitude, growth)
    growth(at)  # the estimate of its error has looked at points beside it
    omega = abs(value.imag)
    residual = max(at.residual, abs(left))
    limit = RESIDUAL_LIMIT_OF_LARGE + _floor(problem, at.z, frame)
    if not residual < limit or abs(omega - frequency) > 0.3 * frequency:
        return unverified("HB", f"its defining system has no solution nearby (residual {residual:.1e})")
    q = q if value.imag > 0 else np.conj(q)
    values = problem.spectrum(at.z).values
    critical = [np.abs(values - target) <= CRITICAL * omega for target in (1j * omega, -1j * omega)]
    pairs_there = max(1, int(np.sum(critical[0])))
    others = values[~(critical[0] | critical[1])]
    several = pairs_there > 1  # where each of them has directions of its own: l1 of one is that of no family
    form = {"kernel": pairs_there} if several else forms.hopf(problem, at.z, q, omega)
    error += 3.0 * forms.rounding(linear_at(problem, at.z), 1j * omega, q) / frequency / abs(slope)
    unstable = int(np.sum(others.real > 0.0))
    vectors = {"omega": omega, "q": q} | ({"kernel": pairs_there} if several else {})
    remark = SEVERAL_PAIRS if several else ""
    return Verified("HB", at.z, residual, float(error), values, unstable, form, vectors, remark=remark)


# branch points --------------------------------------------------------------------------------------------------------


def reduction(problem: LargeEquations, z: Array, tangent: Array, scale: Array) -> tuple[Reduced, Array]:
    """The reduced equation at z, bordered by the eigenvector to the eigenvalue nearest to zero (raw, returned too)."""
    spectrum = problem.spectrum(z, at_zero=True)
    if not spectrum.values.size:
        raise ArithmeticError("the eigenvalue nearest to zero was not found")
    q = np.real(spectrum.vectors[:, int(np.argmin(np.abs(spectrum.values)))])
    null = np.append(q, 0.0) / scale
    null /= norm(null)
    size = scale[:-1] / norm(null[:-1])
    column = linear_at(problem, z).weigh(null[:-1] * size)  # <p, M q> != 0, whatever <p, q> is
    return Reduced(problem, border_rows(null[:, None], tangent, scale), column, scale), q


def _branch_point(problem: LargeEquations, near: Sample, frame: Frame) -> Outcome:
    reduced, _ = reduction(problem, near.z, near.tangent, frame.scale)
    found = reduced.branch_point(near.z)
    if found is None:
        return unverified("BP", "Newton on the reduced equation did not converge")
    z = found.z
    residual = max(float(np.max(np.abs(problem.residual(z) / frame.scale[:-1]))), abs(found.mu))
    if not residual < RESIDUAL_LIMIT_OF_LARGE + _floor(problem, z, frame):
        return unverified("BP", f"its defining system has no solution nearby (residual {residual:.1e})")
    hessian = found.hessian

    def again(near: Array) -> Array | None:
        crossing = reduced.branch_point(near, hessian)
        return None if crossing is None else crossing.z

    scatter = _scatter(z, frame.scale, again)
    spectrum = problem.spectrum(z, at_zero=True)
    together = _vanishing(problem, z, spectrum.values)
    if together > 1:  # rounding has split them, and some seem to cross next to the others
        whole = _multiple(problem, replace(near, z=z), frame, together)
        if isinstance(whole, Verified):
            return whole
    k = int(np.argmin(np.abs(spectrum.values)))
    others = np.delete(spectrum.values, k)
    q = forms.null_vector(linear_at(problem, z), np.real(spectrum.vectors[:, k]))
    form = forms.branch_point(problem, z, q)
    rounding = forms.rounding_of_branch_point(problem, z, q, form)
    error = 4.0 * scatter + EPSILON * abs(float(z[-1])) + 3.0 * rounding
    unstable = int(np.sum(others.real > 0.0))
    return Verified("BP", z, residual, float(error), spectrum.values, unstable, form, {"kernel": 1})


def _scatter(z: Array, scale: Array, again: Callable[[Array], Array | None]) -> float:
    """How far apart in the parameter z and results of `again` from places beside it are; inf where one fails."""
    generator, worst = np.random.default_rng(3), 0.0
    for _ in range(SAMPLES):
        moved = again(z + PERTURBATION * scale * generator.uniform(-1.0, 1.0, z.size) / np.sqrt(z.size))
        worst = max(worst, np.inf if moved is None else abs(float(moved[-1] - z[-1])))
    return worst


def _vanishing(problem: LargeEquations, z: Array, values: NDArray[np.complex128]) -> int:
    """How many real eigenvalues are zero to rounding."""
    limit = VANISHING * rounding_of(inverse_of(linear_at(problem, z)), problem.n)
    return int(np.sum((np.abs(values) <= limit) & (values.imag == 0.0)))


def kernel_at(problem: LargeEquations, z: Array, tangent: Array, scale: Array, k: int) -> Kernel:
    """The reduction bordered by the k eigenvectors to the eigenvalues nearest to zero.  tangent : scaled.

    Beside the point they may be a complex pair, whose real and imaginary part become null vectors.
    """
    spectrum = problem.spectrum(z, at_zero=True)
    nearest = np.argsort(np.abs(spectrum.values))[:k]
    paired = np.sign(spectrum.values[nearest].imag)
    if len(nearest) < k or np.sum(paired) != 0.0:
        raise ArithmeticError(f"{k} eigenvalues near zero were not found")
    chosen = spectrum.vectors[:, nearest]
    vectors = np.where(paired < 0.0, np.imag(chosen), np.real(chosen))
    return Kernel.of(problem, z, kernel(linear_at(problem, z), vectors) if k > 1 else vectors, tangent, scale)


def _multiple(problem: LargeEquations, near: Sample, frame: Frame, k: int) -> Outcome:
    """A branch point with a kernel of dimension k."""
    try:
        kernel = kernel_at(problem, near.z, near.tangent, frame.scale, k)
        found = kernel.point()
    except (ArithmeticError, NotFiniteError) as failure:
        return unverified("BP", str(failure))
    if found is None:
        return unverified("BP", f"{k} eigenvalues vanish near each other, not together")
    z, left = found
    residual = max(float(np.max(np.abs(problem.residual(z) / frame.scale[:-1]))), left)

    def again(near: Array) -> Array | None:
        moved = replace(kernel, origin=near).point()
        return None if moved is None else moved[0]

    scatter = _scatter(z, frame.scale, again)
    spectrum = problem.spectrum(z, at_zero=True)
    others = np.delete(spectrum.values, np.argsort(np.abs(spectrum.values))[:k])
    coefficients, remark = _reduced_equation(kernel, z)
    error = 4.0 * scatter + EPSILON * abs(float(z[-1])) + 3.0 * kernel.rounding(z)
    unstable = int(np.sum(others.real > 0.0))
    vectors = {"kernel": k}
    return Verified("BP", z, residual, float(error), spectrum.values, unstable, coefficients, vectors, remark=remark)


def _reduced_equation(kernel: Kernel, z: Array) -> tuple[dict[str, object], str]:
    """The coefficients at a branch point, and a remark where there are too many branches to look for."""
    try:
        require_countable(kernel.k)
    except LargeKernelError as reason:
        return {"kind": "multiple", "kernel": kernel.k}, f"BP: {reason}"
    reduced = ReducedJet(kernel, z).reduction
    form = any_branch_point(reduced.jet, kernel=kernel.k, reduction=reduced)
    coefficients = dict(form.coefficients) | kernel_coefficients(kernel, z)
    return coefficients | ({"errors": stated(form.errors)} if form.errors else {}), ""


def tangents(problem: LargeEquations, z: Array, scale: Array) -> list[Array]:
    """Unit tangents (scaled) of the branches through z."""
    row = np.random.default_rng(5).normal(size=len(z))
    row[-1] = norm(row[:-1])  # what one number of many sees is little, and iterative solvers would not see it at all
    here = problem.linearisation(z, row / norm(row), scale)
    if here is None:
        raise InputError(problem.describe_failure(z))
    t = here.solve(np.append(np.zeros(len(z) - 1), 1.0))
    size = norm(t)  # is moderate by chance at a branch point, where the equations of t are singular but consistent
    largest = fastest_rate(linear_at(problem, z), scale[:-1])
    is_regular = here.smallest is None or here.smallest > SINGULAR * largest
    if np.isfinite(size) and size < 1e8 and is_regular:
        return [t / size]
    try:
        reduced, _ = reduction(problem, z, np.append(np.zeros(problem.n), 1.0), scale)
    except ArithmeticError as failure:
        raise InputError(f"no direction of a branch was found at the start: {failure}") from failure
    crossing = [d / scale for d, _ in reduced.crossing(z)]
    return [t / norm(t) for t in crossing] or [t / size]
