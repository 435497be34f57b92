"""Codimension-two points on curves of large systems: tests along the curve, location to full precision, normal forms.

Each test is a smooth function of the arclength with a simple zero at the point: the quadratic coefficient <w, B(v, v)>
(CP), <w, v> (BT), the real part of an eigenvalue that is followed by Newton (ZH, HH), the first Lyapunov coefficient
(GH). They are located like the points of a branch, by the secant method on the curve itself.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array, Vector
from contin.continuation.outcome import NOTHING, Outcome, Rejected, Verified, unverified
from contin.continuation.sample import Frame, Sample, opposite
from contin.errors import NotFiniteError
from contin.linalg.linear import Linear
from contin.linalg.vectors import norm
from contin.loci.sparse import forms
from contin.loci.sparse.curve import LargeCurve
from contin.loci.sparse.singular import Folds
from contin.loci.tolerances import REAL, RESIDUAL_LIMIT
from contin.machine import elementary
from contin.problems.sparse import forms as simple
from contin.problems.sparse.special_points import refine
from contin.problems.sparse.zero_on_curve import At, zero_on_curve
from contin.records import Fields
from contin.special.table import signs_of_points

if TYPE_CHECKING:
    from contin.loci.sparse.on_large_curve import OnLargeCurve

ROUNDED = 1e-9
STEEP = 1e-2  # part of the arclength that the parameter changes by at least where its error tells that of the place


def crossed(locus: str, a: Sample, b: Sample) -> list[str]:
    """Types whose tests change sign."""
    signs = signs_of_points(locus, False)
    return [type_ for index, (type_, _) in signs.items() if opposite(a.tests[index], b.tests[index])]


def split(problem: OnLargeCurve, z: Array) -> tuple[Vector, Vector, Vector]:
    """Leading eigenvalues at a point of the curve; which of them are not the curve's own; all their vectors."""
    spectrum = problem.curve.spectrum(z)
    values = spectrum.values
    kappa = problem.curve.kappa(z)
    root = np.sqrt(complex(-kappa))
    own: list[int] = []
    for target in [root, -root] if problem.locus == "HB" else [0.0]:
        free = [k for k in range(len(values)) if k not in own]
        if free:
            own.append(min(free, key=lambda k: abs(values[k] - target)))
    return values, np.delete(np.arange(len(values)), own), spectrum.vectors


def tests_at(problem: OnLargeCurve, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
    """Tests from index 2 on, unstable eigenvalues that are not the curve's own, the leading eigenvalues."""
    values, others, _ = split(problem, z)
    rest = values[others]
    largest = float(np.abs(values).max(initial=1e-300))
    unstable = int(np.sum(rest.real > 1e-13 * largest))
    pairs = rest[rest.imag > REAL * np.abs(rest)]
    pair = 1.0
    if pairs.size:
        sign = -1.0 if int(np.sum(pairs.real > 0.0)) % 2 else 1.0
        pair = sign * float(np.min(np.abs(pairs.real) / np.abs(pairs)))
    if problem.locus == "LP":
        at = problem.curve.singular(z)
        if not isinstance(at, Folds):
            return np.full(4, np.nan), unstable, values
        chain = _chain(at, problem.curve.linear_at(z))
        return np.array([_quadratic(at), chain, pair, 1.0]), unstable, values
    real = rest[np.abs(rest.imag) <= REAL * np.abs(rest)].real
    product = 1.0
    if real.size:
        sign = -1.0 if int(np.sum(real > 0.0)) % 2 else 1.0
        product = sign * float(np.abs(real).min()) / largest
    kappa = problem.curve.kappa(z)
    typical = elementary.square(float(np.sort(np.abs(rest))[0])) if rest.size else 1.0
    visible = kappa > ROUNDED * problem.curve.unit  # nearer to a BT only rounding is left of l1, which grows
    lyapunov = _lyapunov(problem, z) * np.sign(product) if visible else 0.0
    return np.array([kappa / max(typical, 1e-300), product, pair, lyapunov]), unstable, values


def _quadratic(at: Folds) -> float:
    """<w, B(v, v)>"""
    v = np.real(at.at.v)
    return -float(at.slopes(np.append(v, np.zeros(2)))[0])


def _chain(at: Folds, linear: Linear) -> float:
    """<w, M v>, zero at a Bogdanov-Takens point."""
    return float(np.real(at.at.functional(linear.weigh(np.real(at.at.v)))))


def _relative_chain(at: Folds, linear: Linear) -> float:
    """`_chain` for a null vector of length 1 on both sides of M."""
    v = np.real(at.at.v)
    return _chain(at, linear) / (norm(v) * norm(linear.weigh(v)))


def _lyapunov(problem: OnLargeCurve, z: Array) -> float:
    branch, point = problem.curve.branch(z)
    at = problem.curve.pairs_at(z)
    return simple.lyapunov(branch, point, at.at[0].v, float(np.sqrt(problem.curve.kappa(z))))


def verify(problem: OnLargeCurve, type_: str, near: Sample, frame: Frame) -> Outcome:
    """The point of this type near a sample, to full precision."""
    try:
        return _verified(problem, type_, near, frame)
    except NotFiniteError as error:
        return unverified(type_, str(error))


def _verified(problem: OnLargeCurve, type_: str, near: Sample, frame: Frame) -> Outcome:
    if type_ == "BT" and problem.locus == "HB":
        by_folds = _takens_by_folds(problem, near, frame)
        return by_folds if isinstance(by_folds, Verified) else _takens_by_frequency(problem, near, frame, by_folds)
    measure = _measure(problem, type_, near)
    if isinstance(measure, Rejected):
        return unverified(type_, measure.reason)
    found = zero_on_curve(problem, near, frame, measure)
    if found is None:
        return unverified(type_, "its test has no zero on the curve nearby")
    at, left, error = found.at, found.left, found.error
    residual = max(at.residual, abs(left))
    if not residual < RESIDUAL_LIMIT:
        return unverified(type_, f"its defining system has no solution nearby (residual {residual:.1e})")
    if problem.curve.kappa(at.z) <= 0.0 and problem.locus == "HB":
        return NOTHING  # a neutral saddle
    return _described(problem, type_, at.z, residual, error, frame, _drift(at.tangent, error, frame))


def _measure(problem: OnLargeCurve, type_: str, near: Sample) -> Callable[[At], float] | Rejected:
    curve = problem.curve

    if type_ == "CP":
        return _sized(lambda at: _quadratic(curve.folds_at(at.z)), problem, near, type_)
    if type_ == "BT":
        return lambda at: _relative_chain(curve.folds_at(at.z), curve.linear_at(at.z))
    if type_ == "GH":
        return _sized(lambda at: _lyapunov(problem, at.z), problem, near, type_)
    values, others, vectors = split(problem, near.z)
    complex_ = type_ == "HH" or problem.locus == "LP"
    chosen = [k for k in others if (values[k].imag > REAL * abs(values[k])) == complex_ and values[k].imag >= 0.0]
    if not chosen:
        return Rejected("the eigenvalues that cross are of another kind")
    k = min(chosen, key=lambda k: abs(values[k].real))
    value, q = complex(values[k]), vectors[:, k]
    value, q = (value, q) if complex_ else (complex(value.real), np.real(q).astype(complex))
    size = abs(value) if complex_ else float(np.abs(values).max())

    def growth(at: At) -> float:
        nonlocal value, q
        value, q = refine(curve.linear_at(at.z), value, q)
        return value.real / size

    return growth


def _sized(test: Callable[[At], float], problem: OnLargeCurve, near: Sample, type_: str) -> Callable[[At], float]:
    """A test in units of the part of it that does not cancel, so that what the secant leaves is comparable."""
    size = 1.0
    if type_ == "CP":
        at = problem.curve.folds_at(near.z)
        v = np.real(at.at.v)
        image = problem.curve.second_derivative(near.z, v, np.append(v, np.zeros(2)))
        size = max(abs(float(np.real(at.at.functional(np.abs(image))))), 1e-300)
    return lambda at: test(at) / size


def _takens_by_folds(problem: OnLargeCurve, near: Sample, frame: Frame) -> Outcome:
    """BT from a curve of Hopf points: on the curve of folds through it, where it is a regular zero."""
    locus, z = _folds_through(problem, near.z)
    scale = np.delete(frame.scale, -3)
    tangents = locus.tangents(z, scale)
    if not tangents:
        return unverified("BT", "the equations are not finite there")
    start = Sample(z, np.asarray(tangents[0]), np.zeros(6), 0, np.empty(0, complex))
    found = verify(locus, "BT", start, Frame(scale))
    if not isinstance(found, Verified):
        return found
    placed = np.concatenate([found.z[: problem.n], [0.0], found.z[-2:]])
    return replace(found, z=placed)


def _folds_through(problem: OnLargeCurve, z: Array) -> tuple[OnLargeCurve, Array]:
    """The curve of folds through a point of a curve of Hopf points next to a BT, and that point's unknowns there."""
    hopf = problem.curve
    folds = LargeCurve("LP", hopf.origin, hopf.first, hopf.second)
    moved = np.concatenate([z[: problem.n], z[-2:]])
    started = folds.started(moved, np.real(hopf.pairs_at(z).at[0].v))
    return replace(problem, curve=started), moved


def _takens_by_frequency(problem: OnLargeCurve, near: Sample, frame: Frame, refused: Outcome) -> Outcome:
    """BT where kappa = omega^2 vanishes on the curve of Hopf points itself, where there is no curve of folds.

    So it is where the equilibrium exists at all parameters: a curve of branch points passes there. kappa is an unknown.
    """
    size = problem.curve.unit
    found = zero_on_curve(problem, near, frame, lambda at: problem.curve.kappa(at.z) / size)
    if found is None or not max(found.at.residual, abs(found.left)) < RESIDUAL_LIMIT:
        return refused
    locus, z = _folds_through(problem, found.at.z)
    own = problem.curve.gauge  # F_p is no border there, and <p, q0> = 0: these hold a part along q1
    assert own is not None
    locus = replace(locus, curve=locus.curve.gauged(replace(own, regular=own.c)))
    there = _described(locus, "BT", z, max(found.at.residual, abs(found.left)), found.error, frame, np.zeros_like(z))
    return replace(there, z=np.concatenate([z[: problem.n], [0.0], z[-2:]]))


def _drift(tangent: Array, error: float, frame: Frame) -> Array:
    """By how much the unknowns may be off along the curve where the parameter is off by `error`."""
    if not np.isfinite(error):
        return np.zeros_like(tangent)  # that is told with the point
    rate = max(abs(float(tangent[-1])), STEEP) * float(frame.scale[-1])
    return tangent * frame.scale * (error / rate)


def _described(
    problem: OnLargeCurve, type_: str, z: Array, residual: float, error: float, frame: Frame, drift: Array
) -> Verified:  # fmt: skip
    values, others, vectors = split(problem, z)
    rest = list(others)
    own = [k for k in range(len(values)) if k not in rest]
    count = {"BT": 1 if problem.locus == "LP" else 0, "ZH": 2 if problem.locus == "LP" else 1, "HH": 2}.get(type_, 0)
    real = type_ == "BT" or (type_ == "ZH" and problem.locus == "HB")
    kinds = [k for k in rest if (abs(values[k].imag) <= REAL * abs(values[k])) == real]
    if type_ == "BT":
        kinds = rest
    more = sorted(kinds, key=lambda k: abs(values[k].real) if type_ != "BT" else abs(values[k]))[:count]
    free = [k for k in rest if k not in more]
    critical = values[[*own, *more]]
    known: Fields = {"critical": critical}
    pairs = [k for k in [*own, *more] if values[k].imag > REAL * abs(values[k])]
    known["omegas"] = [float(values[k].imag) for k in pairs]
    known["pairs"] = [vectors[:, k] for k in pairs]
    zeros = [k for k in [*own, *more] if k not in pairs and values[k].imag >= 0.0]
    if problem.locus == "LP":
        known["null"] = np.real(problem.curve.folds_at(z).at.v)
    elif zeros:
        known["null"] = np.real(vectors[:, zeros[0]])
    unstable = int(np.sum(values[free].real > 0.0))
    point = Verified(type_, z, residual, error, values, unstable)
    return forms.with_normal_form(problem, point, known, frame.scale[-2:], drift)
