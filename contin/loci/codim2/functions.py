"""Smooth functions of z near a curve of special points, zero at points of codimension two.

They are smooth off the curve too, as Newton needs: eigenvalues are followed by their distance from those of a reference
point, null vectors come from borders that are fixed there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import NO_FUNCTION, Array
from contin.continuation.outcome import Rejected
from contin.continuation.sample import Sample
from contin.kernels.lyapunov import lyapunov_terms
from contin.loci.codim2 import degenerate
from contin.loci.codim2.flip_coefficient import flip_coefficient, of_jet
from contin.loci.codim2.forms import jet_at
from contin.loci.codim2.matrices import (
    critical_value,
    own_critical,
    parameters_at,
    scaled_matrices,
    scaled_matrix,
)
from contin.loci.codim2.uncomputed_tests import untold
from contin.loci.tolerances import REAL
from contin.machine import elementary
from contin.normalforms.hopf import first_lyapunov
from contin.normalforms.maps import cubic_beyond_error, cubic_on_circle
from contin.normalforms.result import NO_FORM
from contin.normalforms.rounding import off_by_rounding
from contin.special.table import special_type

if TYPE_CHECKING:
    from contin.abi import Vector
    from contin.loci.curve_of_points import CurveOfPoints
    from contin.normalforms.jet import Jet

Function = Callable[[Array], float]


def function_of(problem: CurveOfPoints, type_: str, near: Sample) -> Function | Rejected:
    """The function whose zero on the curve is a point of this type; a string says why there is none."""
    locus = problem.locus
    if type_ == "BT" and locus == "HB":
        size = elementary.square(float(np.linalg.norm(scaled_matrix(problem, near.z))))
        return lambda z: problem.curve.scalar(z) / size
    cosine = special_type(type_).cosine
    if locus == "NS" and cosine is not None:
        return lambda z: problem.curve.scalar(z) - cosine
    if type_ in ("BT", "R1", "R2"):
        return _border_function(problem, near.z, lambda z, right, left, _: (left * right).sum(axis=1))
    if type_ == "CP":
        return _border_function(problem, near.z, lambda *parts: _quadratic(problem, *parts))
    if type_ == "DP":
        return _border_function(problem, near.z, lambda *parts: _degeneracy(problem, *parts))
    if type_ == "GPD":
        return lambda z: _flip_function(problem, z)
    if type_ in ("GH", "CH"):
        return lambda z: lyapunov(problem, z)
    return _eigenvalue_function(problem, type_, near)


@dataclass(frozen=True, eq=False)
class BorderFunction:
    """values(z, v, psi, sizes) in rows: of null vectors v, psi of A - shift from [A - shift, b; c^T, 0], of A's size.

    `frame` (n + 1, n + 1) holds b and c, the singular vectors at a point nearby, and minus the shift: v is along the
    curve's. A = f_u in units of the states' sizes.
    """

    problem: CurveOfPoints
    frame: Array
    values: Callable[[Array, Array, Array, Array], Array]

    def __call__(self, z: Array) -> float:
        return float(self.at(z[None])[0])

    def at(self, z: Array) -> Array:
        """At rows z; NaN where the bordered matrix is singular: Newton's method ends, and the point is not verified."""
        n = self.problem.n
        matrices = scaled_matrices(self.problem, z)
        bordered = np.repeat(self.frame[None], len(z), axis=0)
        bordered[:, :n, :n] += matrices
        try:
            inverses = np.asarray(np.linalg.inv(bordered), dtype=float)
        except np.linalg.LinAlgError:  # one of them is singular
            return np.array([self(row) for row in z]) if len(z) > 1 else np.full(1, np.nan)
        sizes = np.sqrt(np.einsum("kij,kij->k", matrices, matrices))
        return self.values(z, inverses[:, :-1, -1], inverses[:, -1, :-1], sizes)


def _border_function(
    problem: CurveOfPoints, z0: Array, values: Callable[[Array, Array, Array, Array], Array]
) -> Function:
    n = problem.n
    frame = np.zeros((n + 1, n + 1))
    frame[:n, :n] = -critical_value(problem) * np.eye(n)
    left, _, right = np.linalg.svd(scaled_matrix(problem, z0) + frame[:n, :n])
    frame[:n, n], frame[n, :n] = left[:, -1], right[-1]
    return BorderFunction(problem, frame, values)


def at_rows(function: Function, z: Array) -> Array:
    """The function at rows z."""
    return function.at(z) if isinstance(function, BorderFunction) else np.array([function(row) for row in z])


def _quadratic(problem: CurveOfPoints, z: Array, v: Array, psi: Array, sizes: Array) -> Array:
    """<psi, B(v, v)> in scaled states, relative to the size of f_u; of rows."""
    curve, n = problem.curve, problem.n
    p = parameters_at(problem, z)
    wide = np.zeros((len(z), n + p.shape[1]))
    wide[:, :n] = v * curve.sizes
    image = curve.system.derivatives(z[:, :n], p, wide, wide) / curve.sizes
    products = np.asarray((psi * image).sum(axis=1))
    return products if n == 1 else products / np.maximum(sizes, 1e-300)  # n = 1: f_u is rounding, no measure of rates


def _degeneracy(problem: CurveOfPoints, z: Array, v: Array, psi: Array, _: Array) -> Array:
    return np.array([degenerate.coefficient(problem, *parts) for parts in zip(z, v, psi, strict=True)])


def _flip_function(problem: CurveOfPoints, z: Array) -> float:
    """c / (1 + |c|) with c the cubic coefficient of a period doubling: bounded, where c itself has poles."""
    c = flip_coefficient(problem, z)
    return c / (1.0 + abs(c))


def lyapunov(problem: CurveOfPoints, z: Array, beyond_error: bool = False) -> float:
    """Re G21 of the first Lyapunov coefficient (`kernels.lyapunov`); l1 itself for user functions, Re d of maps.

    beyond_error : of maps, 0 where it is zero to its error, as all along in area-preserving ones: a sign of rounding is
    no event. The zero itself is located without that.
    """
    curve, n = problem.curve, problem.n
    kappa = curve.scalar(z)
    if problem.system.kind == "map":
        return _map_lyapunov(problem, z, kappa, beyond_error)
    if kappa <= 0.0:
        return 0.0
    if curve.system.jacobian_address == NO_FUNCTION:
        return first_lyapunov(jet_at(problem, z), float(np.sqrt(kappa)))

    system, d = curve.system, curve.sizes
    matrix = np.ascontiguousarray(scaled_matrix(problem, z))
    v = np.ascontiguousarray(curve.vector(z) / d)
    terms = np.empty(4)
    lyapunov_terms(
        system.form(2), system.form(3), np.ascontiguousarray(z[:n]), curve.full_parameters(z), d, matrix,
        float(np.sqrt(kappa)), v, matrix @ v, terms,
    )  # fmt: skip
    return float(terms[0])


def _map_lyapunov(problem: CurveOfPoints, z: Array, cosine: float, beyond_error: bool) -> float:
    """Re d of a Neimark-Sacker point."""
    if abs(cosine) >= 1.0:
        return 0.0
    jet, theta = jet_at(problem, z), float(elementary.acos(cosine))
    try:
        return cubic_beyond_error(jet, theta) if beyond_error else cubic_on_circle(jet, theta).real
    except (ZeroDivisionError, np.linalg.LinAlgError) as error:
        return untold(problem, "CH", z, error)


def rounding_of(problem: CurveOfPoints, type_: str, z: Array) -> float:
    """By how much the function of GPD or CH may be off for rounding errors of F_u, alike at points next to each other.

    0 for other types: theirs differ from point to point.
    """
    if type_ not in ("GPD", "CH"):
        return 0.0
    cosine = problem.curve.scalar(z) if type_ == "CH" else 0.0
    if abs(cosine) >= 1.0:
        return 0.0
    theta = float(elementary.acos(cosine))

    def value(jet: Jet) -> float:
        if type_ == "GPD":
            return of_jet(jet)
        return cubic_on_circle(jet, theta).real

    jet = jet_at(problem, z)
    try:
        here = value(jet)
        return max(abs(value(other) - here) for other in off_by_rounding(jet))
    except NO_FORM:  # the function itself says so, in words
        return 0.0


def _eigenvalue_function(problem: CurveOfPoints, type_: str, near: Sample) -> Function | Rejected:
    """The part of a further eigenvalue that vanishes: ZH, HH on flows; LPPD, PDNS, LPNS of maps."""
    values = np.asarray(near.eigenvalues)
    own = own_critical(problem, near.z, values)
    others = np.delete(values, own)
    size = max(float(np.abs(values).max()), 1e-300)
    complex_ones = others[others.imag > REAL * size]
    real_ones = others[np.abs(others.imag) <= REAL * size]
    target = _real_target(problem, type_)
    if target is not None:
        if not real_ones.size:
            return Rejected("no other real eigenvalue is near the stability boundary")
        reference = complex(real_ones[int(np.argmin(np.abs(real_ones - target)))])
        return lambda z: (_followed(problem, z, reference).real - target) / size
    if not complex_ones.size:
        return Rejected("the other critical eigenvalues are real")
    if problem.system.kind == "map":
        reference = complex(complex_ones[int(np.argmin(np.abs(np.abs(complex_ones) - 1.0)))])
        return lambda z: abs(_followed(problem, z, reference)) - 1.0
    reference = complex(complex_ones[int(np.argmin(np.abs(complex_ones.real)))])
    return lambda z: _followed(problem, z, reference).real / size


def _real_target(problem: CurveOfPoints, type_: str) -> float | None:
    """Where a further real eigenvalue crosses at a point of this type; None where a pair does."""
    if type_ == "ZH" and problem.locus == "HB":
        return 0.0
    if type_ == "LPPD":
        return 1.0 if problem.locus == "PD" else -1.0
    if problem.locus == "NS" and type_ in ("LPNS", "PDNS"):
        return 1.0 if type_ == "LPNS" else -1.0
    return None


def _followed(problem: CurveOfPoints, z: Array, reference: complex) -> complex:
    values = np.linalg.eigvals(scaled_matrix(problem, z))
    return complex(values[int(np.argmin(np.abs(values - reference)))])


def critical_indices(problem: CurveOfPoints, type_: str, z: Array, values: Vector) -> list[int] | None:
    """Indices of all eigenvalues that are critical at a point of this type; None where a needed pair is real."""
    own = own_critical(problem, z, values)
    rest = [i for i in range(len(values)) if i not in own]
    if type_ in ("CP", "GH", "DP", "GPD", "CH", "R3", "R4"):
        return own
    if type_ in ("BT", "R1", "R2") and problem.locus not in ("HB", "NS"):
        return [*own, min(rest, key=lambda i: abs(values[i] - critical_value(problem)))]
    if type_ in ("BT", "R1", "R2"):
        return own
    target = _real_target(problem, type_)
    if target is not None:
        return [*own, min(rest, key=lambda i: abs(values[i] - target))]
    distance = (lambda v: abs(abs(v) - 1.0)) if problem.system.kind == "map" else (lambda v: abs(v.real))
    upper = [i for i in rest if values[i].imag > 0.0]
    if not upper:
        return None
    chosen = min(upper, key=lambda i: distance(values[i]))  # type: ignore[no-untyped-call]
    partner = min((i for i in rest if i != chosen), key=lambda i: abs(values[i] - np.conj(values[chosen])))
    return [*own, chosen, partner]
