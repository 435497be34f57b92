"""Special points at 40 digits: Newton in mpmath on a defining system of determinants, from contin's own result.

The systems are sympy formulas whose numbers are fractions of powers of two, so that contin's doubles are exact. The
determinants (folds det J = 0; Hopf points by Hurwitz's) and the formulas of the coefficients (Kuznetsov, Elements of
Applied Bifurcation Theory, 3rd ed., ch. 3 to 5 and 8, 9) are not those that contin solves.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import mpmath
import sympy
from mpmath import mp, mpc, mpf

import contin

DIGITS = 40
FAR = mpf("1e-4")  # Newton leads elsewhere: not the point that was labelled


@dataclass(frozen=True, eq=False)
class Formulas:
    """du/dt = f(u, p), or u -> f(u, p)."""

    states: tuple[sympy.Symbol, ...]
    parameters: tuple[sympy.Symbol, ...]
    equations: tuple[sympy.Expr, ...]
    kind: str = "flow"

    @property
    def n(self) -> int:
        return len(self.states)

    def model(self, at: Mapping[str, float]) -> contin.Model:
        return contin.Model(
            "exact", kind=self.kind, states={s.name: 0.0 for s in self.states},
            parameters={p.name: at[p.name] for p in self.parameters},
            equations={s.name: str(e) for s, e in zip(self.states, self.equations, strict=True)},
        )  # fmt: skip

    def _compiled(self, order: int) -> Any:
        """f, or its directional derivative of this order, as a function of (u, p, direction, ...)."""
        given = [*self.states, *self.parameters]
        parts = list(self.equations)
        for k in range(order):
            along = sympy.symbols(f"dir{k}_0:{self.n}")
            parts = [sum(sympy.diff(e, s) * d for s, d in zip(self.states, along, strict=True)) for e in parts]
            given += along
        return sympy.lambdify(given, parts, "mpmath")

    @cached_property
    def _orders(self) -> list[Any]:
        return [self._compiled(order) for order in range(4)]

    def derivative(self, z: Sequence[Any], *directions: Any) -> Any:
        """D^k f [d1, ..., dk] at z = (u, parameters), a column."""
        flat = [x for d in directions for x in d]
        return mp.matrix(self._orders[len(directions)](*z, *flat))

    def jacobian(self, z: Sequence[Any]) -> Any:
        found = mp.matrix(self.n, self.n)
        for j in range(self.n):
            found[:, j] = self.derivative(z, [mpf(int(i == j)) for i in range(self.n)])
        return found

    def rest(self, z: Sequence[Any]) -> list[Any]:
        f = self.derivative(z)
        return [f[i] - (z[i] if self.kind == "map" else 0) for i in range(self.n)]


def characteristic(matrix: Any) -> list[Any]:
    """a_0 ... a_{n-1} of x^n + a_{n-1} x^(n-1) + ... (Faddeev and LeVerrier)."""
    n = matrix.rows
    coefficients, m = [mpf(0)] * n, mp.matrix(n, n)
    c = mpf(1)
    for k in range(1, n + 1):
        m = matrix * m + c * mp.eye(n)
        product = matrix * m
        c = -sum(product[i, i] for i in range(n)) / k
        coefficients[n - k] = c
    return coefficients


def on_axis(matrix: Any) -> Any:
    """Zero where two eigenvalues have zero sum, n = 2, 3, 4."""
    a = characteristic(matrix)
    if matrix.rows == 2:
        return a[1]
    return a[2] * a[1] - a[0] if matrix.rows == 3 else a[3] * a[2] * a[1] - a[1] ** 2 - a[3] ** 2 * a[0]


def on_circle(matrix: Any) -> Any:
    """Zero where two eigenvalues have product 1, n = 2, 3."""
    a = characteristic(matrix)
    return a[0] - 1 if matrix.rows == 2 else 1 - a[1] + a[2] * a[0] - a[0] ** 2


def null_vector(matrix: Any) -> Any:
    """Of length 1, its largest component positive: the last right singular vector's, by two inverse iterations."""
    n = matrix.rows
    border = mp.matrix(n + 1, n + 1)
    border[:n, :n] = matrix
    for k in range(n):
        border[k, n], border[n, k] = mpf(k + 2) / 7 + mpf(3 * k % 5) / 3, mpf(2 * k + 3) / 5 - mpf(k * k % 3)
    v = mp.lu_solve(border, mp.matrix([0] * n + [1]))[:n]
    top = max(v, key=abs)
    v = v * (abs(top) / top)
    return v / mp.sqrt(sum(abs(x) ** 2 for x in v))


def dot(a: Any, b: Any) -> Any:
    return sum(mp.conj(x) * y for x, y in zip(a, b, strict=True))


def critical_vectors(matrix: Any, value: Any) -> tuple[Any, Any]:
    """q, p with A q = value q, A* p = conj(value) p, <p, q> = 1."""
    identity = mp.eye(matrix.rows)
    q, p = null_vector(matrix - value * identity), null_vector((matrix - value * identity).H)
    return q, p / mp.conj(dot(p, q))


def fold_coefficient(system: Formulas, z: Sequence[Any]) -> Any:
    matrix = system.jacobian(z) - (mp.eye(system.n) if system.kind == "map" else 0 * mp.eye(system.n))
    q, p = null_vector(matrix), null_vector(matrix.T)
    p = p / dot(p, q)
    return dot(p, system.derivative(z, q, q)) / 2


def hopf_coefficient(system: Formulas, z: Sequence[Any]) -> Any:
    """l1 = Re c1 / omega."""
    matrix = system.jacobian(z)
    a = characteristic(matrix)
    square = {2: lambda: a[0], 3: lambda: a[1], 4: lambda: a[1] / a[3]}[system.n]()
    omega = mp.sqrt(mp.re(square))
    q, p = critical_vectors(matrix, mpc(0, omega))
    q_ = q.apply(mp.conj)
    h11 = mp.lu_solve(matrix, -system.derivative(z, q, q_))
    h20 = mp.lu_solve(mpc(0, 2 * omega) * mp.eye(system.n) - matrix, system.derivative(z, q, q))
    total = system.derivative(z, q, q, q_) + 2 * system.derivative(z, q, h11) + system.derivative(z, q_, h20)
    return mp.re(dot(p, total)) / 2 / omega


def flip_coefficient(system: Formulas, z: Sequence[Any]) -> Any:
    matrix, identity = system.jacobian(z), mp.eye(system.n)
    q, p = null_vector(matrix + identity), null_vector((matrix + identity).T)
    p = p / dot(p, q)
    h = mp.lu_solve(identity - matrix, system.derivative(z, q, q))
    return dot(p, system.derivative(z, q, q, q) + 3 * system.derivative(z, q, h)) / 6


def torus_coefficient(system: Formulas, z: Sequence[Any]) -> Any:
    """Re d."""
    matrix, identity = system.jacobian(z), mp.eye(system.n)
    a = characteristic(matrix)
    trace = -a[1] if system.n == 2 else -a[2] + a[0]  # of the pair: the third eigenvalue is -a_0
    value = mpc(trace / 2, mp.sqrt(1 - trace**2 / 4))
    q, p = critical_vectors(matrix, value)
    q_ = q.apply(mp.conj)
    h11 = mp.lu_solve(identity - matrix, system.derivative(z, q, q_))
    h20 = mp.lu_solve(value**2 * identity - matrix, system.derivative(z, q, q))
    total = system.derivative(z, q, q, q_) + 2 * system.derivative(z, q, h11) + system.derivative(z, q_, h20)
    return mp.re(dot(p, total) / value) / 2


COEFFICIENTS = {
    "LP": ("a", fold_coefficient), "HB": ("l1", hopf_coefficient), "PD": ("c", flip_coefficient),
    "NS": ("d", torus_coefficient),
}  # fmt: skip


def _identity(system: Formulas) -> Any:
    return (1 if system.kind == "map" else 0) * mp.eye(system.n)


def _cusp(system: Formulas, z: Sequence[Any]) -> list[Any]:
    """a = 0 beside det = 0: a is <p, B(q, q)>/2 of the bordered null vectors."""
    matrix = system.jacobian(z) - _identity(system)
    n = system.n
    border = mp.matrix(n + 1, n + 1)
    border[:n, :n] = matrix
    left, right = null_vector(matrix.T), null_vector(matrix)
    for k in range(n):
        border[k, n], border[n, k] = left[k], right[k]
    unit = mp.matrix([0] * n + [1])
    q, p = mp.lu_solve(border, unit), mp.lu_solve(border.T, unit)
    return [q[n], dot(p[:n], system.derivative(z, q[:n], q[:n]))]


def _pair_product(matrix: Any, product: Any, total: Any) -> list[Any]:
    """Sum and product of a pair of eigenvalues, n = 2, or 3 with the third from the trace."""
    a = characteristic(matrix)
    if matrix.rows == 2:
        return [a[0] - product, a[1] + total]
    third = -a[2] - total
    return [a[0] + product * third, a[1] - product - third * total]


def conditions(system: Formulas, type_: str, z: Sequence[Any]) -> list[Any]:
    """What vanishes at a point of the type beside f."""
    matrix = system.jacobian(z)
    if type_ == "LP":
        return [mp.det(matrix - _identity(system))]
    if type_ == "PD":
        return [mp.det(matrix + mp.eye(system.n))]
    if type_ == "HB":
        return [on_axis(matrix)]
    if type_ == "NS":
        return [on_circle(matrix)]
    if type_ == "CP":
        return _cusp(system, z)
    if type_ == "BT":
        return _pair_product(matrix, mpf(0), mpf(0))
    if type_ == "ZH":
        a = characteristic(matrix)
        return [a[0], a[2]]
    if type_ == "GH":
        return [on_axis(matrix), hopf_coefficient(system, z)]
    if type_ == "HH":
        a = characteristic(matrix)
        return [a[3], a[1]]
    if type_ == "GPD":
        return [mp.det(matrix + mp.eye(system.n)), flip_coefficient(system, z)]
    if type_ == "CH":
        return [on_circle(matrix), torus_coefficient(system, z)]
    if type_ == "LPPD":
        return [mp.det(matrix - mp.eye(system.n)), mp.det(matrix + mp.eye(system.n))]
    totals = {"R1": 2, "R2": -2, "R3": -1, "R4": 0}
    return _pair_product(matrix, mpf(1), mpf(totals[type_]))


@dataclass(frozen=True)
class Exact:
    """The point itself (None: Newton did not lead to one nearby), and the coefficient that decides there."""

    z: Any
    coefficient: Any = None


def refined(system: Formulas, type_: str, z: Sequence[float], free: int) -> Exact:
    """Newton from (u, free parameters), with the last `free` entries of the parameters' row unknown."""
    with mp.workdps(DIGITS):
        start = [mpf(v) for v in z]

        def residual(*unknowns: Any) -> list[Any]:
            return [*system.rest(unknowns), *conditions(system, type_, unknowns)]

        assert len(start) == system.n + free
        try:
            found = mp.findroot(residual, start, tol=mpf(10) ** (-50), maxsteps=25)
        except (ValueError, ZeroDivisionError):
            return Exact(None)
        place = [mp.re(v) for v in found]
        size = max(1, max(abs(v) for v in start))
        if max(abs(a - b) for a, b in zip(place, start, strict=True)) > FAR * size:
            return Exact(None)
        known = COEFFICIENTS.get(type_)
        return Exact(place, None if known is None else known[1](system, place))


__all__ = ["COEFFICIENTS", "Exact", "Formulas", "mpmath", "refined"]
