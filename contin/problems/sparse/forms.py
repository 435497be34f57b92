"""Normal forms of large systems. Left null vectors enter only as functionals, which bordered solves evaluate:

[A q; q^H 0] [x; y] = [r; 0] gives y = <p, r> with <p, q> = 1, whatever the transpose of A would be.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from contin.abi import Array, Vector
from contin.errors import NotFiniteError
from contin.linalg.linear import Linear
from contin.normalforms.linear import normalise
from contin.normalforms.result import parts, sense
from contin.records import Fields

if TYPE_CHECKING:
    from contin.problems.sparse.equations import SparseEquations

SAMPLES = 3
TRUST = 1e-6  # coefficients below this part of their largest summand are zero to the accuracy of differenced forms


def linear_at(problem: SparseEquations, z: Array) -> Linear:
    """The operator F_u at a point; raises `NotFiniteError` where it has no value."""
    linear = problem.linear(z)
    if linear is None:
        raise NotFiniteError("the Jacobian is not finite at the point")
    return linear


def projector(linear: Linear, q: Vector) -> Callable[[Vector], tuple[Vector, Any]]:
    """r -> (x, <p, r>) with A x = r - <p, r> q and q^H x = 0."""
    solver = linear.bordered(q[:, None], np.conj(q)[:, None], np.zeros((1, 1)))

    def project(r: Vector) -> tuple[Vector, Any]:
        found = solver.solve(np.append(r, 0.0))
        return found[:-1], found[-1]

    return project


def rounding(linear: Linear, value: complex, q: Vector) -> float:
    """How much the real part of an eigenvalue moves when the operator's entries are rounded: max |Re <p, E q>|.

    E has random entries of half a unit in the last place of A's, or, where A is not known by entries, of its size.
    """
    generator = np.random.default_rng(4)
    q = normalise(q)
    project = projector(linear.shifted(value), q)
    size = linear.magnitude(np.abs(q))
    noise = np.finfo(float).eps * generator.uniform(-1.0, 1.0, (SAMPLES, len(q)))
    return max(abs(complex(project((size * row).astype(complex))[1]).real) for row in noise)


def rounding_of_fold(problem: SparseEquations, z: Array, q: Vector) -> float:
    """How much the parameter of a fold moves when F is rounded: |<p, e>| / |<p, F_p>|.

    e has random entries of half a unit in the last place of the largest terms of F, which for a discretised derivative
    are n^2 times larger than F's own.
    """
    generator = np.random.default_rng(6)
    linear = linear_at(problem, z)
    project = projector(linear, normalise(q))
    size = linear.magnitude(np.abs(z[:-1]))
    slope = abs(complex(project(problem.parameter_slope(z))[1]))
    noise = 0.5 * np.finfo(float).eps * generator.uniform(-1.0, 1.0, (SAMPLES, problem.n))
    moved = max(abs(complex(project(size * row)[1])) for row in noise)
    return moved / slope if slope > 0.0 else np.inf


def rounding_of_branch_point(problem: SparseEquations, z: Array, q: Vector, form: Fields) -> float:
    """How much the parameter of a simple branch point moves when entries of [F_u F_p] are rounded.

    There the gradient of the reduced equation, (<p, F_u q>, <p, F_u h + F_p>), vanishes. Its rounding errors e move the
    point by the inverse of [b20 b11; b11 a02], the parameter by (b11 e_1 - b20 e_2) / discriminant.
    """
    b11, b20, discriminant = (abs(float(form[key])) for key in ("b11", "b20", "discriminant"))
    if discriminant == 0.0:
        return np.inf
    generator = np.random.default_rng(8)
    linear, slope = linear_at(problem, z), problem.parameter_slope(z)
    q = normalise(q)
    project = projector(linear, q)
    h = -np.real(project(slope)[0])
    worst = 0.0
    for size, weight in ((linear.magnitude(np.abs(q)), b11), (linear.magnitude(np.abs(h)) + np.abs(slope), b20)):
        noise = np.finfo(float).eps * generator.uniform(-1.0, 1.0, (SAMPLES, len(q)))
        worst += weight * max(abs(complex(project(size * row)[1])) for row in noise)
    return worst / discriminant


def state(v: Vector) -> Vector:
    """A direction in which only the states move."""
    return np.append(v, 0.0)


def fold(problem: SparseEquations, z: Array, q: Vector) -> Fields:
    """`a` = <p, B(q, q)>/2."""
    q = normalise(q)
    _, value = projector(linear_at(problem, z), q)(problem.form(z, state(q), state(q)))
    return {"a": 0.5 * float(np.real(value))}


def branch_point(problem: SparseEquations, z: Array, q: Vector) -> Fields:
    """FORMATS' reduced equation at a simple branch point."""
    q = normalise(q)
    project = projector(linear_at(problem, z), q)
    slope = problem.parameter_slope(z)
    right = state(q)

    def response(r: Vector) -> tuple[Vector, float]:
        """(x, <p, r>) with A x = -(r - <p, r> q) and <p, x> = 0."""
        x, value = project(r)
        return -(x - float(np.real(project(x)[1])) * q), float(np.real(value))

    h, a01 = response(slope)
    along = np.append(h, 1.0)
    k, b20 = response(problem.form(z, right, right))
    a02 = float(np.real(project(problem.form(z, along, along))[1]))
    b11 = float(np.real(project(problem.form(z, right, along))[1]))
    cubic = problem.form(z, right, right, right)
    mixed = problem.form(z, right, state(k))
    b30 = float(np.real(project(cubic + 3.0 * mixed)[1]))
    scale = float(np.abs(problem.form(z, right, right)).max())
    form: Fields = {"a01": a01, "a02": a02, "b11": b11, "b20": b20, "b30": b30}
    form["discriminant"] = b11 * b11 - a02 * b20
    if abs(b20) <= TRUST * max(scale, abs(b11)):
        return {"kind": "pitchfork", "criticality": sense(b30, TRUST * float(np.abs(cubic).max())), **form}
    return {"kind": "transcritical" if form["discriminant"] > 0 else "isolated", **form}


def hopf(problem: SparseEquations, z: Array, q: Vector, omega: float) -> Fields:
    """`omega`, `c1` = G21/2, `l1` = Re c1 / omega, `criticality` (Kuznetsov, 3rd ed., sec. 5.4)."""
    q = normalise(q)
    linear = linear_at(problem, z)
    right, other = state(q), state(np.conj(q))
    h20 = -linear.shifted(2j * omega).solve(problem.form(z, right, right).astype(complex))
    h11 = -linear.solve(np.real(problem.form(z, right, other)))
    cubic = problem.form(z, right, right, other)
    total = cubic + problem.form(z, other, state(h20)) + 2.0 * problem.form(z, right, state(h11.astype(complex)))
    c1 = 0.5 * complex(projector(linear.shifted(1j * omega), q)(total)[1])
    error = TRUST * float(np.abs(cubic).max())
    return {"omega": omega, "c1": parts(c1), "l1": c1.real / omega, "criticality": sense(c1.real, error)}
