"""Branch points of orbits: which families cross there, from the equation for their tangents.

With null vectors q, along which the parameter does not move, and r normal to it, and the left null vector psi, the
families leave along x q + y r where

    b20 x^2 + 2 b11 x y + a02 y^2 = 0,    b20 = psi . D^2F[q, q],  b11 = psi . D^2F[q, r],  a02 = psi . D^2F[r, r]

(Keller 1977): a pitchfork where b20 = 0. `slope` is by how much the parameter moves while the families part: where one
has u1(p), the other is u1(p) + xi v + ..., p = p0 +- slope xi + ..., the mean of |v|^2 over the orbit being 1, in the
model's units. With y = 1 the roots x differ by 2 sqrt(b11^2 - a02 b20) / |b20|, whatever r is beside q. Every
coefficient is computed on two meshes, from two solutions of the defining system: their difference and the rounding of
the terms are its error, and decide what is zero.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.outcome import Verified
from contin.machine.elementary import square
from contin.normalforms.coefficient import SAFETY as CHANGE
from contin.normalforms.coefficient import Coefficient
from contin.problems.orbits.linearised.bordered import Borders
from contin.problems.orbits.linearised.linear import OrbitLinear, embed
from contin.problems.orbits.normal_forms.carried_borders import carried
from contin.problems.orbits.normal_forms.multiple_branch_point import kernel_dimension, planes
from contin.problems.orbits.symmetric.symmetry import halves_alike
from contin.records import Record

if TYPE_CHECKING:
    from contin.problems.orbits.linearised.solved_orbit import SolvedOrbit
    from contin.problems.orbits.orbit_equations import OrbitEquations

SETTLED: Final = 1e-13  # (scaled) error of a place, at least
SAFETY: Final = 4.0  # the error of the parameter alone is known
STEP: Final = 1e-3  # (scaled) for derivatives of the coefficients by the place


@dataclass(frozen=True, eq=False)
class Crossing:
    """The equation of one family that crosses, in units of its largest sum of moduli.

    What the error of the place makes of a coefficient is its `noise`.
    """

    b20: Coefficient
    b11: Coefficient
    a02: Coefficient
    vertical: Array  # q as a direction of z, scaled
    rate: float  # change of the parameter along r beside the mean square of q over the orbit, in the model's units


def branch_point(problem: OrbitEquations, point: Verified, solved: SolvedOrbit) -> Record:
    """{kind, slope, errors}, {kind, breaks} where a declared symmetry decides, {} where no family is told.

    breaks: the symmetry that the orbit has and the new family has not; kernel: the number of multipliers that pass 1
    together there, where it is above 1 (see `contin.problems.orbits.normal_forms.multiple_branch_point`).
    """
    known: dict[str, Borders] = {}
    count = kernel_dimension(problem, point.eigenvalues)
    linear = OrbitLinear(problem, solved.z, solved.scale, solved.z)
    coarse = _crossings(linear, point, solved, known)
    if not coarse:
        return {}
    kernel = {"kernel": count} if count > 1 else {}
    for each in coarse:
        broken = halves_alike(problem, solved.z, each.vertical * solved.scale)
        if broken:
            return {"kind": "pitchfork", "breaks": broken[0], **kernel}
    other = solved.finer or solved
    closer = OrbitLinear(problem, other.z, other.scale, other.z)
    fine = _crossings(closer, point, other, carried(known, linear, closer))
    if len(fine) != len(coarse):
        return {}
    return {**decided(coarse[0], fine[0]), **kernel}


def decided(coarse: Crossing, fine: Crossing) -> Record:
    """{kind, slope, errors} from the equation on two meshes."""
    pairs = ((coarse.b20, fine.b20), (coarse.b11, fine.b11), (coarse.a02, fine.a02))
    (b20, e20), (b11, e11), (a02, e02) = ((one.value.real, one.error(other)) for one, other in pairs)
    discriminant = square(b11) - a02 * b20
    unsure = (2.0 * abs(b11) + e11) * e11 + abs(a02) * e20 + (abs(b20) + e20) * e02
    if not abs(discriminant) > unsure:  # NaN, too
        return {"kind": "degenerate"}  # terms of higher order decide what crosses
    if discriminant < 0.0:
        return {"kind": "isolated"}
    slope = abs(b20) / (2.0 * float(np.sqrt(discriminant)))
    worst = discriminant - unsure
    error = e20 / (2.0 * float(np.sqrt(worst))) + slope * unsure / (2.0 * worst)
    moved = slope * CHANGE * abs(coarse.rate - fine.rate)
    stated = {"slope": slope * coarse.rate, "errors": {"slope": error * coarse.rate + moved}}
    return {"kind": "pitchfork" if abs(b20) <= e20 else "transcritical", **stated}


def _crossings(
    linear: OrbitLinear, point: Verified, solved: SolvedOrbit, known: dict[str, Borders]
) -> list[Crossing]:  # fmt: skip
    problem = linear.problem
    off = SAFETY * max(solved.error / float(solved.scale[-1]), SETTLED)
    found = []
    for null, left in planes(linear, point.eigenvalues, known):
        along = null[-1] / np.linalg.norm(null[-1])  # the parameter is the last unknown
        vectors = null @ np.column_stack([[-along[1], along[0]], along])
        values, sizes = _terms(linear, left, vectors)
        steps = [embed(linear, vector) * solved.scale * STEP for vector in vectors.T]
        sides = [
            [_terms(OrbitLinear(problem, z, solved.scale, z), left, vectors)[0] for z in (solved.z + s, solved.z - s)]
            for s in steps
        ]
        drifts = off * sum(np.abs(ahead - behind) for ahead, behind in sides) / (2.0 * STEP)
        unit = float(sizes.max())
        rows = np.array([values, sizes, drifts]).T / unit
        b20, b11, a02 = (Coefficient(float(v), float(s), signed=False, noise=float(d)) for v, s, d in rows)
        raw = (vectors[: linear.nu, 0] * linear.units[: linear.nu]).reshape(-1, linear.profile.n)
        size = float(np.sqrt(linear.profile.weights @ np.sum(square(raw), axis=1)))
        rate = float(vectors[-1, 1] * linear.units[-1]) / size
        found.append(Crossing(b20, b11, a02, embed(linear, vectors[:, 0]), abs(rate)))
    return found


def _terms(linear: OrbitLinear, left: Array, vectors: Array) -> tuple[Array, Array]:
    """b20, b11 and a02, and the sums of the moduli of their terms, (3,)."""
    second = [linear.hessian(vectors[:, k]) for k in range(2)]
    pairs = ((0, 0), (0, 1), (1, 1))
    values = np.array([float(left @ (second[i] @ vectors[:, j])) for i, j in pairs])
    sizes = np.array([float(np.abs(left) @ (abs(second[i]) @ np.abs(vectors[:, j]))) for i, j in pairs])
    return values, sizes
