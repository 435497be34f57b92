"""Critical normal forms of periodic orbits by collocation: b of LPC, c of PD, d of NS (`contin.normalforms.cycles`).

On the centre manifold of an orbit u0 of period T, with its phase tau and a coordinate xi, in the model's own time t,
u = u0(tau) + xi v(tau) + ..., where the mean of |v|^2 over the orbit is 1 (2-norm, the model's units); for b of an
autonomous system v is the generalised eigenfunction v' = A v + u0', whose size is given; where there is no shear, v is
the one eigenfunction of the multiplier 1 with mean(<v, u0'>) = 0, up to its sign. Every coefficient follows from
the solvability of a linear boundary-value problem, w^* right = 0 with the left null vector w of its matrix; no adjoint
equation is solved. Cost: a few sparse factorisations, and second and third derivatives at every Gauss point.

The error of a coefficient has two parts: rounding, a part of the sum of the moduli of its terms, and the change from
the same point on a mesh of half the lengths (discretisation, and how well the point was located).
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.abi import Array, Vector
from contin.continuation.outcome import Verified
from contin.kernels.collocation_basis import basis
from contin.linalg.vectors import norm
from contin.normalforms import cycles
from contin.normalforms.coefficient import Coefficient
from contin.normalforms.result import sense
from contin.problems.algebraic_states import massless
from contin.problems.orbits.linearised.bordered import Bordered, Borders, factors
from contin.problems.orbits.linearised.linear import OrbitLinear
from contin.problems.orbits.mesh.layout import in_intervals
from contin.problems.orbits.normal_forms.branch_point import branch_point
from contin.problems.orbits.normal_forms.carried_borders import carried
from contin.problems.tolerances import SHEARLESS

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

    from contin.problems.orbits.linearised.solved_orbit import SolvedOrbit
    from contin.problems.orbits.orbit_equations import OrbitEquations

UNMOVED: Final = float(np.sqrt(np.finfo(float).eps))
UNKNOWN: Final = (
    "its normal form could not be computed (the error of its coefficient is as large as its terms: the multiplier is "
    "not simple, or the orbit not resolved)"
)
ACROSS: Final = "across"  # the name of the two borders across a fold
NAMES: Final = {"LPC": "b", "PD": "c", "NS": "d"}

Values = Vector  # of a function at the Gauss points, (N, m, n)


def normal_form(
    problem: OrbitEquations, point: Verified, solved: SolvedOrbit, other: SolvedOrbit | None = None
) -> Verified:
    """The point with its coefficients, their errors, and the criticality of PD and NS or the kind of BPC.

    other : where another way of solving for it has found the point: the error counts how far its coefficient is off.
    What cannot be computed is a remark.
    """
    try:
        if point.type == "BPC":
            kind = branch_point(problem, point, solved)
            remark = "" if kind else "BPC: the families that cross there were not told apart; no kind is stated"
            return replace(point, normal_form=kind, remark=remark)
        coarse, fine = on_two_meshes(problem, point.type, solved)
        error = coarse.error(fine)
        if other is not None and other is not solved and other.confirmed:
            error += abs(coefficient(problem, point.type, other).value - coarse.value)
    except (np.linalg.LinAlgError, ZeroDivisionError) as reason:
        return replace(point, remark=f"{point.type}: its normal form could not be computed ({reason})")
    return stated(point, coarse, error)


def stated(point: Verified, coefficient: Coefficient, error: float) -> Verified:
    """The point with its coefficient b, c or d and the error, and the criticality of PD and NS."""
    if not coefficient.is_known(error):
        return replace(point, remark=f"{point.type}: {UNKNOWN}")
    name, value = NAMES[point.type], complex(coefficient.value)
    form: dict[str, object] = {name: [value.real, value.imag] if point.type == "NS" else value.real}
    if point.type != "LPC":
        form["criticality"] = sense(value.real, error)
    return replace(point, normal_form={**form, "errors": {name: error}})


def coefficient(problem: OrbitEquations, type_: str, solved: SolvedOrbit) -> Coefficient:
    """b of LPC, c of PD or d of NS."""
    return cycles.coefficient(Forms(_linear(problem, solved)), type_, solved.theta)


def on_two_meshes(problem: OrbitEquations, type_: str, solved: SolvedOrbit) -> tuple[Coefficient, Coefficient]:
    """The coefficient, and the same on the finer mesh, where its borders are those of the first one."""
    coarse = Forms(_linear(problem, solved))
    found = cycles.coefficient(coarse, type_, solved.theta)
    if solved.finer is None:
        return found, found
    fine = _linear(problem, solved.finer)
    known, same = (carried(borders, coarse.linear, fine) for borders in (coarse.known, coarse.same))
    return found, cycles.coefficient(Forms(fine, known, same), type_, solved.finer.theta)


def _linear(problem: OrbitEquations, solved: SolvedOrbit) -> OrbitLinear:
    return OrbitLinear(problem, solved.z, solved.scale, solved.z)


@dataclass(frozen=True, eq=False)
class Variation:
    """The equation w' = A w + g, w(T) = rho w(0), along the orbit, with its null vectors where it is singular."""

    linear: OrbitLinear
    rho: complex
    name: str = ""
    known: dict[str, Borders] = field(default_factory=dict)  # of equations nearby, by name; this one adds its own

    @cached_property
    def matrix(self) -> csc_matrix:
        return self.linear.variational(self.rho)

    @cached_property
    def bordered(self) -> Bordered:
        found = Bordered.of(self.matrix, 1, self.known.get(self.name))
        self.known[self.name] = found.b, found.c
        return found

    def begin(self, right: Vector, g: Vector, left: Vector) -> None:
        """Borders from a solution with two of them, B right = -b g: next to the null vectors already."""
        u, _, v = np.linalg.svd(g)
        pair = left @ u[:, -1:], right @ v[-1:].T
        self.known[self.name] = pair[0] / norm(pair[0][:, 0]), pair[1] / norm(pair[1][:, 0])

    @cached_property
    def null(self) -> tuple[Vector, Vector]:
        """Right null vector (values at the nodes, raw), and left one."""
        v, _, w = self.bordered.solve()
        return self.raw(v[:, 0]), w[:, 0]

    def raw(self, x: Vector) -> Vector:
        """A scaled vector as values at the nodes, (N m + 1, n)."""
        return (x * self.linear.units[: self.linear.nu]).reshape(-1, self.linear.profile.n)

    def remainder(self, x: Vector) -> float:
        """Of a scaled vector in the equations of each state, over their terms' moduli: the largest, in any units.

        What rounding leaves in states that are at rest is nothing beside `UNMOVED` of the largest terms.
        """
        left, terms = (
            np.abs(sums).reshape(-1, self.linear.profile.n).sum(axis=0)
            for sums in (self.matrix @ x, abs(self.matrix) @ np.abs(x))
        )
        return float(np.max(left / (terms + UNMOVED * terms.max())))

    def _right(self, g: Values) -> Vector:
        """Scaled right-hand side of the collocation equations, (nu,)."""
        profile, sizes = self.linear.profile, self.linear.sizes
        rows = (profile.h[:, None, None] * profile.period * g / sizes).ravel()
        return np.concatenate([rows, np.zeros(profile.n, rows.dtype)])

    def projection(self, g: Values, left: Vector | None = None) -> complex:
        """Zero where the equation with right-hand side g has a solution; linear in g, of arbitrary scale."""
        return complex(np.vdot(self.null[1] if left is None else left, self._right(g)))

    def modulus(self, g: Values, left: Vector | None = None) -> float:
        """Sum of the moduli of the terms of `projection`."""
        return float(np.abs(self.null[1] if left is None else left) @ np.abs(self._right(g)))

    def solve(self, g: Values, singular: bool) -> Vector:
        """A solution at the nodes."""
        right = self._right(g)
        if singular:
            return self.raw(np.asarray(self.bordered.factors.solve(np.append(right, 0.0)))[:-1])
        matrix = self.matrix.astype(complex) if np.iscomplexobj(right) else self.matrix
        return self.raw(factors(matrix).solve(right))


@dataclass(frozen=True, eq=False)
class Forms:
    """A, B and C of the equations at the Gauss points of an orbit: a `contin.normalforms.cycles.Cycle`."""

    linear: OrbitLinear
    known: dict[str, Borders] = field(default_factory=dict)  # of the equations of orbits nearby, by name
    same: dict[str, Borders] = field(default_factory=dict)  # ... and of two vectors, on another mesh of this orbit
    _equations: dict[tuple[complex, str], Variation] = field(default_factory=dict)

    @property
    def period(self) -> float:
        return float(self.linear.profile.period)

    @property
    def autonomous(self) -> bool:
        return bool(self.linear.problem.autonomous)

    def equation(self, rho: complex, name: str = "") -> Variation:
        key = complex(rho), name
        if key not in self._equations:
            self._equations[key] = Variation(self.linear, rho, name, self.known)
        return self._equations[key]

    @cached_property
    def states(self) -> Array:
        return np.moveaxis(self.linear._points.at, -1, 0)

    @cached_property
    def rates(self) -> Array:
        return np.moveaxis(self.linear._points.f, -1, 0)

    def values(self, w: Vector) -> Values:
        """A function at the nodes, at the Gauss points."""
        return in_intervals(basis(self.linear.profile.m).values, w)

    def weighed(self, w: Values) -> Values:
        return w

    def first(self, w: Values) -> Values:
        return np.asarray(np.einsum("icka,ica->ick", self.linear.state_derivatives, w))

    def apply(self, *functions: Values) -> Values:
        """D^k f [w_1, ..., w_k]."""
        problem, profile = self.linear.problem, self.linear.profile
        shape, size = self.states.shape, problem.system.p_size
        rows = shape[0] * shape[1]
        p = np.tile(problem.full_parameters(self.linear.z), (rows, 1))
        if not problem.autonomous:
            p[:, -1] = profile.period * self.linear._times.ravel()
        directions = [np.concatenate([w.reshape(rows, -1), np.zeros((rows, size))], axis=1) for w in functions]
        found = problem.system.derivatives(self.states.reshape(rows, -1), p, *directions)
        return np.asarray(found).reshape(shape)

    def _mean(self, v: Vector, w: Vector) -> Any:
        """The mean of <v, w> over the orbit, of the states with mass."""
        moving = ~massless(self.linear.problem.system)
        return self.linear.profile.weights @ np.sum(v[:, moving].conj() * w[:, moving], axis=1)

    def normalised(self, w: Vector) -> Vector:
        return np.asarray(w / np.sqrt(self._mean(w, w).real))

    def across_fold(self) -> tuple[Vector, Vector | None]:
        linear, periodic = self.linear, self.equation(1.0)
        if not self.autonomous:
            return self.normalised(periodic.null[0]), periodic.null[1]
        same = self.same.get(ACROSS)  # of a matrix with one null vector the other border never settles: any will do
        bordered = Bordered.with_borders(periodic.matrix, *same) if same else Bordered.of(periodic.matrix, 2)
        self.same[ACROSS] = bordered.b, bordered.c
        right, g, left = bordered.solve()
        periodic.begin(right, g, left)
        a, b = np.linalg.qr(right)[0].T
        q = self._mean(periodic.raw(b), linear.field) * a - self._mean(periodic.raw(a), linear.field) * b
        if periodic.remainder(q) > SHEARLESS:
            return periodic.solve(self.rates, singular=True), None
        along = [periodic.projection(self.rates, w) for w in left.T]  # <p, u0'> = 0 selects p
        p = along[1] * left[:, 0] - along[0] * left[:, 1]
        return self.normalised(periodic.raw(q)), p


def eigenfunction(linear: OrbitLinear, rho: complex) -> Vector:
    """v of the normal forms at the nodes, of the length that the coefficients refer to; rho = 1: that of a fold."""
    forms = Forms(linear)
    return forms.across_fold()[0] if rho == 1.0 else forms.normalised(forms.equation(rho).null[0])
