"""Normal forms of large systems. Left null vectors enter only as functionals, which bordered solves evaluate:

[A M q; q^H 0] [x; y] = [r; 0] gives y = <p, r> with <p, M q> = 1, whatever the transpose of A would be. M is the mass
matrix of M u' = F, or the identity: the coefficients are those of u' = M^-1 F where that exists, and of the equations
reduced to the states with mass where M is singular.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from contin.abi import Array, Vector
from contin.errors import NotFiniteError
from contin.linalg.linear import Linear, moving
from contin.normalforms.linear import normalise
from contin.normalforms.result import TRUST, parts, sense
from contin.records import Fields

if TYPE_CHECKING:
    from contin.problems.sparse.equations import SparseEquations
    from contin.problems.sparse.large_equations import LargeEquations
    from contin.systems.functions.function_system import FunctionSystem

SAMPLES = 3
MANY = 20_000  # states of which two samples tell as much as SAMPLES of few
SPREAD = 4.0  # of an error, over the largest of SAMPLES
SAME = 0.25  # about the diagonal's part of a row's terms
EPSILON = float(np.finfo(float).eps)


def linear_at(problem: SparseEquations, z: Array) -> Linear:
    """The operator F_u at a point; raises `NotFiniteError` where it has no value."""
    linear = problem.linear(z)
    if linear is None:
        raise NotFiniteError("the Jacobian is not finite at the point")
    return linear


def projector(linear: Linear, q: Vector, coarse: bool = False) -> Callable[[Vector], tuple[Vector, Any]]:
    """r -> (x, <p, r>) with A x = r - <p, r> M q and q^H x = 0; `coarse`: enough for estimates of errors."""
    solver = linear.bordered(linear.weigh(q)[:, None], np.conj(q)[:, None], np.zeros((1, 1)), coarse)

    def project(r: Vector) -> tuple[Vector, Any]:
        found = solver.solve(np.append(r, 0.0))
        return found[:-1], found[-1]

    return project


def functional(linear: Linear, q: Vector, coarse: bool = False) -> Callable[[Vector], Any]:
    """r -> <p, r> as of `projector`: one solve with the transpose where there is one, else a solve for each r."""
    solver = linear.bordered(linear.weigh(q)[:, None], np.conj(q)[:, None], np.zeros((1, 1)), coarse)
    row = solver.last_row()
    if row is None:
        return lambda r: solver.solve(np.append(r, 0.0))[-1]
    left = row[:-1]
    return lambda r: np.einsum("i,i->", left, r)


def unit(linear: Linear, q: Vector) -> Vector:
    """q with |q| = 1 over the states with mass, and the largest of these components positive."""
    counted = normalise(q[moving(linear)])
    whole = q[moving(linear)]
    k = int(np.argmax(np.abs(counted)))
    return counted if linear.mass is None else np.asarray(q * (counted[k] / whole[k]))


def null_vector(linear: Linear, near: Vector) -> Vector:
    """x with A x = 0 to rounding from an eigenvector, which is known to the tolerance of its iteration."""
    q = unit(linear, near)
    solver = linear.bordered(linear.weigh(q)[:, None], q[:, None], np.zeros((1, 1)))
    return unit(linear, np.real(solver.solve(np.append(np.zeros(len(q)), 1.0)))[:-1])


def rounding_errors(size: Array, along: Vector, generator: np.random.Generator) -> list[Vector]:
    """What rounding of a matrix's entries may add to its product with `along`, whose terms have the sum `size`.

    Rows of random errors, and one in which those of the diagonal are the same everywhere, as where all rows of a
    discretisation are alike: they shift all eigenvalues together, where random ones of n rows cancel.
    """
    found = [np.asarray(row * size) for row in EPSILON * generator.uniform(-1.0, 1.0, (SAMPLES, len(size)))]
    modulus = np.abs(along)
    sense = np.divide(along, modulus, out=np.zeros_like(along), where=modulus > 0.0)
    return [*found, np.asarray(SAME * EPSILON * size * sense)]


def rounding(linear: Linear, value: complex, q: Vector) -> float:
    """How much the real part of an eigenvalue moves when the operator's entries are rounded: max |Re <p, E q>|.

    E has entries of a unit in the last place of A's, or, where A is not known by entries, of its size.
    """
    q = unit(linear, q)
    left = functional(linear.shifted(value), q, coarse=True)
    noise = rounding_errors(linear.magnitude(np.abs(q)), q, np.random.default_rng(4))
    return max(abs(complex(left(row.astype(complex))).real) for row in noise)


def rounding_of_fold(problem: SparseEquations, z: Array, along: Callable[[Vector], Any]) -> float:
    """How much the parameter of a fold moves when F is rounded: |<p, e>| / |<p, F_p>|.

    e has random entries of half a unit in the last place of the largest terms of F, which for a discretised derivative
    are n^2 times larger than F's own.  along : `functional` there.
    """
    generator = np.random.default_rng(6)
    size = linear_at(problem, z).magnitude(np.abs(z[:-1]))
    slope = abs(complex(along(problem.parameter_slope(z))))
    noise = 0.5 * np.finfo(float).eps * generator.uniform(-1.0, 1.0, (SAMPLES, problem.n))
    moved = max(abs(complex(along(size * row))) for row in noise)
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
    q = unit(linear, q)
    h, left = -np.real(projector(linear, q, coarse=True)(slope)[0]), functional(linear, q, coarse=True)
    worst = 0.0
    for along, other, weight in ((q, 0.0, b11), (h, np.abs(slope), b20)):
        size = linear.magnitude(np.abs(along)) + other
        worst += weight * max(abs(complex(left(row))) for row in rounding_errors(size, along, generator))
    return worst / discriminant


def state(v: Vector) -> Vector:
    """A direction in which only the states move."""
    return np.append(v, 0.0)


@dataclass(frozen=True, eq=False)
class Derivatives:
    """D^kF at a point, as it is or as well as it is known: at a place off by `noise`, every entry off by as much.

    system : with other differences than the problem's own.
    """

    problem: LargeEquations
    z: Array
    noise: np.random.Generator | None = None
    system: FunctionSystem | None = None

    @classmethod
    def off(cls, problem: LargeEquations, z: Array, generator: np.random.Generator) -> Derivatives:
        """Beside the point, by the part of its unknowns' sizes to which points and derivatives are trusted."""
        size = np.maximum(np.abs(z), problem.typical_sizes)
        return cls(problem, z + TRUST * size * generator.uniform(-1.0, 1.0, z.size), generator)

    def __call__(self, *directions: Vector) -> Vector:
        return self._known(self.problem.form(self.z, *directions, system=self.system))

    def in_all(self, *directions: Vector) -> Vector:
        """The same along directions in the states and all parameters, (n + m,); of first order, too."""
        system, problem, z = self.system or self.problem.system, self.problem, self.z
        return self._known(system.derivative(z[:-1], problem.full_parameters(z), *directions))

    def functional(self, left: Callable[[Vector], Any], v: Vector) -> float:
        """left(D^2F(z)[v, v]) of a linear functional."""
        found, terms = self.problem.functional(left, self.z, v, 2, self.system or self.problem.system)
        return found if self.noise is None else found + float(np.real(left(self._known(terms) - terms)))

    def off_by_matrix(self, linear: Linear, h: Vector, here: Array) -> Vector:
        """What errors of F_u, known to rounding and at a place off `here`, make of its product with h; 0 at `here`."""
        if self.noise is None:
            return np.zeros_like(h)
        row = EPSILON * self.noise.uniform(-1.0, 1.0, len(h)) * linear.magnitude(np.abs(h))
        moved = 0.0 if len(h) > MANY else self.problem.form(here, self.z - here, state(h), system=self.system)
        return np.asarray(row + moved)

    def slope(self) -> Array:
        """F_p"""
        return np.real(self._known(self.problem.parameter_slope(self.z, self.system)))

    def _known(self, value: Vector) -> Vector:
        if self.noise is None:
            return value
        return np.asarray(value * (1.0 + TRUST * self.noise.uniform(-1.0, 1.0, len(value))))


Coefficients = Callable[[Derivatives], dict[str, float]]


def with_errors(problem: LargeEquations, z: Array, compute: Coefficients) -> tuple[dict[str, float], dict[str, float]]:
    """Coefficients, and their estimated errors: how far they scatter as what they are made of does, and differences."""
    found = compute(Derivatives(problem, z))
    generator, widths = np.random.default_rng(9), problem.system.with_other_differences()
    if problem.n > MANY and widths:  # every one tells of both: it is an average over many states, and dear
        offs = [replace(Derivatives.off(problem, z, generator), system=other) for other in widths]
        others = [compute(off) for off in offs]
    else:
        others = [compute(Derivatives.off(problem, z, generator)) for _ in range(SAMPLES)]
        others += [compute(Derivatives(problem, z, system=other)) for other in widths]
    return found, {key: SPREAD * max(abs(other[key] - value) for other in others) for key, value in found.items()}


def fold(problem: LargeEquations, z: Array, q: Vector, along: Callable[[Vector], Any]) -> Fields:
    """`a` = <p, B(q, q)>/2, `along` = <p, .> for the null vector q of length 1."""
    right = state(q)

    def coefficient(form: Derivatives) -> dict[str, float]:
        return {"a": 0.5 * form.functional(along, right)}

    found, errors = with_errors(problem, z, coefficient)
    return {**found, "errors": errors}


def branch_point(problem: LargeEquations, z: Array, q: Vector) -> Fields:
    """FORMATS' reduced equation at a simple branch point; its kind as `contin.normalforms.branching` decides it."""
    linear = linear_at(problem, z)
    q = unit(linear, q)
    project = projector(linear, q)
    right = state(q)

    def response(r: Vector) -> tuple[Vector, float]:
        """(x, <p, r>) with A x = -(r - <p, r> M q1) and <p, M x> = 0."""
        x, value = project(r)
        return -(x - float(np.real(project(linear.weigh(x))[1])) * q), float(np.real(value))

    def coefficients(form: Derivatives) -> dict[str, float]:
        h, a01 = response(form.slope())
        along = np.append(h, 1.0)
        k, b20 = response(form(right, right))
        cubic, mixed = form(right, right, right), form(right, state(k))
        a02, b11, b30 = (
            float(np.real(project(r)[1])) for r in (form(along, along), form(right, along), cubic + 3.0 * mixed)
        )
        return {"a01": a01, "a02": a02, "b11": b11, "b20": b20, "b30": b30, "discriminant": b11 * b11 - a02 * b20}

    form, errors = with_errors(problem, z, coefficients)
    errors["a01"] = max(errors["a01"], abs(form["a01"]))  # 0 at a branch point: what is left is that of its place
    kind: Fields = {"kind": "isolated"}
    if abs(form["b20"]) <= errors["b20"]:
        kind = {"kind": "degenerate"}
        if abs(form["b11"]) > errors["b11"]:
            kind = {"kind": "pitchfork", "criticality": sense(form["b30"], errors["b30"])}
    elif form["discriminant"] >= -errors["discriminant"]:
        kind = {"kind": "transcritical" if form["discriminant"] > errors["discriminant"] else "tangency"}
    return {**kind, **form, "errors": errors}


Cubic = Callable[[Derivatives], complex]


def hopf_coefficient(problem: LargeEquations, z: Array, q: Vector, omega: float) -> Cubic:
    """c1 = G21/2 of w' = i omega w + c1 w |w|^2 as a function of the derivatives (Kuznetsov, 3rd ed., sec. 5.4)."""
    linear = linear_at(problem, z)
    q = unit(linear, q)
    right, other = state(q), state(np.conj(q))
    twice, project = linear.shifted(2j * omega), projector(linear.shifted(1j * omega), q)

    def c1(form: Derivatives) -> complex:
        h20 = -twice.solve(form(right, right).astype(complex))
        h11 = -linear.solve(np.real(form(right, other)))
        if form.noise is not None:  # beside a resonance, or another zero eigenvalue, the matrix's errors are amplified
            h20 = h20 - twice.solve(form.off_by_matrix(linear, h20, z).astype(complex))
            h11 = h11 - linear.solve(np.real(form.off_by_matrix(linear, h11, z)))
        total = form(right, right, other) + form(other, state(h20)) + 2.0 * form(right, state(h11.astype(complex)))
        return 0.5 * complex(project(total)[1])

    return c1


def lyapunov(problem: LargeEquations, z: Array, q: Vector, omega: float) -> float:
    """l1 = Re c1 / omega."""
    return hopf_coefficient(problem, z, q, omega)(Derivatives(problem, z)).real / omega


def hopf(problem: LargeEquations, z: Array, q: Vector, omega: float) -> Fields:
    """`omega`, `c1`, `l1` = Re c1 / omega, `criticality`."""
    compute = hopf_coefficient(problem, z, q, omega)

    def coefficients(form: Derivatives) -> dict[str, float]:
        c1 = compute(form)
        return {"l1": c1.real / omega, "across": c1.imag}

    found, errors = with_errors(problem, z, coefficients)
    l1, error = found["l1"], errors["l1"]
    c1 = complex(omega * l1, found["across"])
    return {"omega": omega, "c1": parts(c1), "l1": l1, "criticality": sense(l1, error), "errors": {"l1": error}}
