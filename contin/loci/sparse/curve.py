"""The equations of a curve of folds or Hopf points of a large system, and Newton's matrix for them by elimination.

z = (u, [kappa], second parameter, first parameter): F(u, p) = 0 and the scalars of `singular`. The null vectors are no
unknowns, and all large solves are with F_u (shifted), bordered by two vectors: the cost of a Newton step is a fixed
number of such solves.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Final, Self

import numpy as np

from contin.abi import Array, Vector
from contin.errors import NotFiniteError
from contin.linalg.eigen import Spectrum, leading
from contin.linalg.linear import Linear, Solution
from contin.linalg.pencil import OnRange, inverse_of
from contin.linalg.vectors import norm
from contin.loci.sparse.singular import Folds, Hopf, Singularity
from contin.machine import elementary
from contin.problems.gauged import Gauged
from contin.problems.sparse.large_equilibrium import LargeProblem
from contin.problems.sparse.large_linearisation import Workspace

if TYPE_CHECKING:
    from contin.systems.functions.function_system import FunctionSystem

SHIFT = 0.3  # of the gap between zero and the next eigenvalue: where eigenvalues are sought from
INVERSE_STEPS = 4
FLAT = 1e-3  # of a tangent's length: parameters that change less do not tell a direction across the curve
OPPOSITE = 1e-3  # length of a sum of two unit vectors below which it is their rounding


NO_VALUE: Final = "the equations have no value at a point of the curve"


@dataclass(frozen=True, eq=False)
class Borders:
    """b, c of the singular matrix, and b0 = c0 that make F_u regular where another eigenvalue is zero."""

    b: Array
    c: Array
    regular: Array


@dataclass(eq=False)
class Memory:
    """Factors of the last point, and how far its eigenvalues were searched: what makes the next answer cheaper."""

    work: Workspace = field(default_factory=Workspace)
    second: float = np.nan
    reach: float = 0.0


@dataclass(frozen=True, eq=False)
class LargeCurve(Gauged):
    """The curve's type (LP or HB), the large system, and which two of its parameters vary."""

    type: str
    origin: LargeProblem
    first: int
    second: int
    gauge: Borders | None = None
    unit: float = 1.0  # size of kappa
    memory: Memory = field(default_factory=Memory)

    @property
    def n(self) -> int:
        return self.origin.n

    @property
    def has_scalar(self) -> bool:
        return self.type == "HB"

    @property
    def size(self) -> int:
        return self.n + 2 + self.has_scalar

    @property
    def base(self) -> Array:
        return self.origin.base

    @property
    def system(self) -> FunctionSystem:
        return self.origin.system

    def full_parameters(self, z: Array) -> Array:
        p = self.base.copy()
        p[self.first], p[self.second] = z[-1], z[-2]
        return p

    def kappa(self, z: Array) -> float:
        return float(z[-3]) if self.has_scalar else 0.0

    def branch(self, z: Array) -> tuple[LargeProblem, Array]:
        """The equilibria through z with the first parameter free, and z as one of them."""
        memory = self.memory
        if memory.second != z[-2]:
            memory.second, memory.work.z = float(z[-2]), None
        problem = replace(self.origin, base=self.full_parameters(z), active=self.first, work=memory.work)
        return problem, np.append(z[: self.n], z[-1])

    def linear(self, z: Array) -> Linear | None:
        problem, point = self.branch(z)
        return problem.linear(point)

    def linear_at(self, z: Array) -> Linear:
        """F_u; raises `NotFiniteError` where it has no value."""
        linear = self.linear(z)
        if linear is None:
            raise NotFiniteError(NO_VALUE)
        return linear

    def folds_at(self, z: Array) -> Folds:
        """`singular` on a curve of folds; raises `NotFiniteError` where it has no value."""
        at = self.singular(z)
        if not isinstance(at, Folds):
            raise NotFiniteError(NO_VALUE)
        return at

    def pairs_at(self, z: Array) -> Hopf:
        """`singular` on a curve of Hopf points; raises `NotFiniteError` where it has no value."""
        at = self.singular(z)
        if not isinstance(at, Hopf):
            raise NotFiniteError(NO_VALUE)
        return at

    def precisely(self, z: Array) -> Linear | None:
        problem, point = self.branch(z)
        return problem.precisely(point)

    def slope(self, z: Array, index: int) -> Array:
        """F_p of one parameter."""
        with np.errstate(all="ignore"):
            return np.asarray(self.system.parameter_slope(z[: self.n], self.full_parameters(z), index))

    def second_derivative(self, z: Array, v: Vector, direction: Array) -> Vector:
        """D^2F[v, (du, dp2, dp1)]"""
        n, m = self.n, self.system.m
        left, right = np.zeros(n + m, v.dtype), np.zeros(n + m)
        left[:n], right[:n] = v, direction[:n]
        right[n + self.second], right[n + self.first] = direction[n:]
        value: Vector = self.system.derivative(z[:n], self.full_parameters(z), left, right)
        return value

    def spectrum(self, z: Array) -> Spectrum:
        """Leading eigenvalues of F_u; on a curve of folds from F_u - s, since F_u itself is singular there."""
        problem, point = self.branch(z)
        if self.type == "HB":
            return problem.spectrum(point)
        at, linear = self.singular(z), self.precisely(z)
        if not isinstance(at, Folds) or linear is None:
            return Spectrum(np.empty(0, complex), np.empty((self.n, 0), complex), False)
        shift = SHIFT * self._gap(at, linear)
        inverse = inverse_of(linear.shifted(shift))
        found = leading(inverse, self.n, linear.weigh(np.real(at.at.v) + self._other), self.memory.reach)
        found = inverse.back(found) if isinstance(inverse, OnRange) else found
        values = found.values + shift
        if found.values.size:
            self.memory.reach = float(np.sort(np.abs(found.values))[min(2, len(values) - 1)])
        return replace(found, values=values)

    @cached_property
    def _other(self) -> Array:
        x = np.random.default_rng(7).normal(size=self.n)
        return np.asarray(x / norm(x))

    def _gap(self, at: Folds, linear: Linear) -> float:
        """About the modulus of the eigenvalue next to zero, by inverse iteration without the null vector."""
        x, growth = self._other, 1.0
        for _ in range(INVERSE_STEPS):
            x = np.real(at.at.residue(linear.weigh(x))[0])
            growth = norm(x)
            if not 0.0 < growth < np.inf:
                return 1.0
            x = x / growth
        return 1.0 / growth

    # borders ----------------------------------------------------------------------------------------------------------

    def started(self, z: Array, q: Vector) -> Self:
        """Borders from a critical eigenvector q; at a BT, from q0 + i q1 with A q0 = 0, A q1 = q0."""
        q = np.asarray(q)
        if self.type == "LP":
            c = np.real(q) / norm(np.real(q))
            return replace(self, gauge=self._best(z, c))
        if self.kappa(z) != 0.0:
            unit = self.unit_at(z) if self.kappa(z) > 0.0 else self.unit
            return replace(self, gauge=self._hopf(z, *_axes(q)), unit=unit)
        real, imaginary = np.real(q), np.imag(q)  # so fast is the motion beside a BT
        return replace(self, gauge=self._hopf(z, real, imaginary), unit=elementary.square(norm(real) / norm(imaginary)))

    def unit_at(self, z: Array) -> float:
        """A size for kappa at z, where it is not zero; that of the eigenvalues next to the critical ones, at least."""
        branch, point = self.branch(z)
        values = np.sort(np.abs(branch.spectrum(point).values))
        least = 1e-2 * elementary.square(float(values[min(2, len(values) - 1)])) if values.size else 1.0
        return max(abs(self.kappa(z)), least)

    def settled(self, z: Array, tangent: Array | None) -> Self:
        """With borders that fit at z: null vectors there, the left ones from a direction across the curve."""
        known = self.gauge
        assert known is not None
        at = self.singular(z, known)
        return self if at is None else replace(self, gauge=self._fitting(z, tangent, at, known))

    def _fitting(self, z: Array, tangent: Array | None, at: Folds | Hopf, known: Borders) -> Borders:
        if isinstance(at, Folds):
            c = np.real(at.at.v) / norm(np.real(at.at.v))
            b = known.b
            if tangent is not None and float(elementary.hypot(tangent[-1], tangent[-2])) > FLAT * norm(tangent):
                one, two = self.slope(z, self.first), self.slope(z, self.second)
                across = tangent[-2] * one - tangent[-1] * two
                if norm(across) > 0.0:
                    across = across / norm(across)
                    b = across if float(across @ b) >= 0.0 else -across
            return Borders(b, c, c)
        vectors = [s.v for s in at.at]
        if at.kappa >= 0.0:
            real, imaginary = np.real(vectors[0]), np.imag(vectors[0]) / at.root
        else:
            real, imaginary = 0.5 * (vectors[0] + vectors[1]), 0.5 * (vectors[0] - vectors[1]) / at.root
        fresh = self._hopf(z, np.real(real), np.real(imaginary))
        return fresh if float(fresh.c @ known.c) >= 0.0 else replace(fresh, c=-fresh.c)

    def _hopf(self, z: Array, real: Array, imaginary: Array) -> Borders:
        """c along Re q; b with a part along Im q, without which it would lose the left vector at a BT."""
        real = real / norm(real)
        imaginary = imaginary - (imaginary @ real) * real
        regular = real + (imaginary / norm(imaginary) if norm(imaginary) > 0.0 else 0.0)
        b = self._weighed(z, regular)
        problem, point = self.branch(z)
        spectrum = problem.spectrum(point)  # A is regular there but for zero-Hopf points
        if spectrum.values.size:
            nearest = np.real(spectrum.vectors[:, int(np.argmin(np.abs(spectrum.values)))])
            if norm(nearest) > 0.0:
                nearest = nearest / norm(nearest)
                regular = regular + (nearest if float(nearest @ regular) >= 0.0 else -nearest)
        return Borders(b, real, regular / norm(regular))

    def _best(self, z: Array, c: Array) -> Borders:
        """The column F_p, of either parameter or both, that makes the bordered matrix best conditioned."""
        columns = [self.slope(z, index) for index in (self.first, self.second)]
        sizes = [norm(column) for column in columns]
        units = [column / size for column, size in zip(columns, sizes, strict=True) if size > 0.0]
        if len(units) == 2 and norm(both := units[0] + units[1]) > OPPOSITE:
            units.append(both / norm(both))
        linear = self.precisely(z)
        candidates = [*units, self._weighed(z, c)]
        best, smallest = c, np.inf
        for b in candidates:
            if linear is None:
                break
            length = norm(np.real(Singularity.of(linear, 0.0, b, c).residue(b - (b @ c) * c)[0]))
            length = max(length, norm(np.real(Singularity.of(linear, 0.0, b, c).v)))
            if length < 0.5 * smallest:  # not so for nan
                best, smallest = b, length
        return Borders(best, c, c)

    def _weighed(self, z: Array, v: Array) -> Array:
        """M v / |M v| with the mass matrix, for a border column: <p, M q> does not vanish where <p, q> may."""
        linear = self.linear(z)
        if linear is None or linear.mass is None:
            return v
        moved = linear.weigh(v)
        return moved / (norm(moved) or 1.0)

    # equations --------------------------------------------------------------------------------------------------------

    def singular(self, z: Array, borders: Borders | None = None) -> Folds | Hopf | None:
        """The scalars at z; None where F_u is not finite."""
        borders = borders or self.gauge
        linear = self.linear(z)
        if linear is None or borders is None:
            return None

        def second(v: Vector, direction: Array) -> Vector:
            return self.second_derivative(z, v, direction)

        if self.type == "LP":
            return Folds(linear, borders.b, borders.c, second)
        return Hopf(linear, self.kappa(z), self.unit, borders.b, borders.c, second)

    def residual(self, z: Array) -> Array:
        """F and the scalars, (N - 1,), unscaled."""
        f = self.system.value(z[: self.n], self.full_parameters(z))
        at = self.singular(z) if np.all(np.isfinite(f)) else None
        return np.append(f, np.full(1 + self.has_scalar, np.nan) if at is None else at.values)

    def linearisation(self, z: Array, tangent: Array, scale: Array) -> CurveLinearisation | None:
        f = self.system.value(z[: self.n], self.full_parameters(z))
        borders = self.gauge
        at = self.singular(z) if np.all(np.isfinite(f)) else None
        linear = self.linear(z)
        if at is None or linear is None or borders is None:
            return None
        solver: Solution | None = None
        if isinstance(at, Hopf):
            corner = np.zeros((1, 1))
            column = self._weighed(z, borders.regular)
            solver = linear.bordered(column[:, None], borders.regular[:, None], corner)
        return CurveLinearisation.of(self, z, np.append(f, at.values), at, solver, tangent, scale)


@dataclass(frozen=True, eq=False)
class CurveLinearisation:
    """Scaled residual, and [J; t^T] in scaled unknowns: du = x0 + sum of a_k x_k, with a small system for the a_k."""

    residual: Array
    scale: Array
    basis: Array  # (N, k): x_k with their parameters and kappa, raw
    small: Array  # (k, k): what the elimination leaves, its last row the tangent
    _curve: LargeCurve
    _at: Folds | Hopf
    _solver: Solution | None
    _row: Array

    @cached_property
    def _determinant(self) -> tuple[float, float]:
        sign, log = np.linalg.slogdet(self.small)
        return float(sign), float(log)

    @property
    def sign(self) -> float:
        """Of what the elimination leaves: it changes where another curve crosses, and not where G has a pole."""
        return self._determinant[0]

    @property
    def log_determinant(self) -> float:
        return self._determinant[1]

    @classmethod
    def of(
        cls, curve: LargeCurve, z: Array, f: Array, at: Folds | Hopf, solver: Solution | None, tangent: Array,
        scale: Array,
    ) -> CurveLinearisation | None:  # fmt: skip
        n, size = curve.n, curve.size
        made = cls(f / scale[:-1], scale, np.empty((size, 0)), np.empty((0, 0)), curve, at, solver, tangent / scale)
        columns, top = [], []
        for index, place in ((curve.first, -1), (curve.second, -2)):
            x, y = made._inverse(-curve.slope(z, index))
            column = np.zeros(size)
            column[:n], column[place] = x, 1.0
            columns.append(column)
            top.append(y)
        null, pivot = made._null()
        columns.append(np.append(null, np.zeros(size - n)))
        top.append(pivot)
        rows = [np.array([*top, 0.0] if at.scalars == 2 else top)]
        slopes = [at.slopes(np.append(column[:n], column[-2:])) for column in columns]
        if isinstance(at, Hopf):
            column = np.zeros(size)
            column[-3] = 1.0
            columns.append(column)
            slopes.append(at.kappa_slopes())
        basis = np.column_stack(columns)
        rows += list(np.column_stack(slopes))
        rows.append(made._row @ basis)
        small = np.array(rows)
        return replace(made, basis=basis, small=small) if np.all(np.isfinite(small)) else None

    def _inverse(self, r: Array) -> tuple[Array, float]:
        """(x, y) with A x + b y = r, c^T x = 0."""
        if self._solver is None:
            assert isinstance(self._at, Folds)
            x, y = self._at.at.residue(r)
        else:
            found = self._solver.solve(np.append(r, 0.0))
            x, y = found[:-1], found[-1]
        return np.real(x), float(np.real(y))

    def _null(self) -> tuple[Array, float]:
        if self._solver is None:
            assert isinstance(self._at, Folds)
            return np.real(self._at.at.v), float(np.real(self._at.at.g))
        found = self._solver.solve(np.append(np.zeros(self._curve.n), 1.0))
        return np.real(found[:-1]), float(np.real(found[-1]))

    def solve(self, right: Array) -> Array:
        """[J; t^T] x = right, in scaled unknowns."""
        n = self._curve.n
        raw = right[:-1] * self.scale[:-1]
        x, y = self._inverse(raw[:n]) if np.any(raw[:n]) else (np.zeros(n), 0.0)
        step = np.zeros(len(self.scale))
        step[:n] = x
        slopes = self._at.slopes(np.append(x, [0.0, 0.0])) if np.any(x) else np.zeros(self._at.scalars)
        rest = np.concatenate([[-y], raw[n:] - slopes, [right[-1] - self._row @ step]])
        sizes = np.abs(self.small).max(axis=1)
        sizes[sizes == 0.0] = 1.0
        try:
            a = np.linalg.solve(self.small / sizes[:, None], rest / sizes)
        except np.linalg.LinAlgError:  # with NaN the step is refused
            return np.full(len(self.scale), np.nan)
        return np.asarray((step + self.basis @ a) / self.scale)


def _axes(q: Vector) -> tuple[Array, Array]:
    """Re q and Im q with the phase that makes them orthogonal and Re q the longer."""
    square = np.sum(q * q)
    q = q * elementary.exp(-0.5j * elementary.angle(square)) if abs(square) > 0.0 else q
    return np.real(q).copy(), np.imag(q).copy()
