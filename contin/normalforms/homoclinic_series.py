"""The homoclinic orbit that leaves a Bogdanov-Takens point, as a series in eps (Lindstedt and Poincare's method).

With T = tanh(xi), and a clock that is bent, d(xi)/dt = eps omega(T), orbit and parameters are

    u(T) = u0 + sum eps^k X_k(T),   p = p0 + sum eps^k P_k,   omega = 1 + sum eps^k omega_k(T),

X_k and omega_k polynomials in T of degree k. The equation eps omega (1 - T^2) u_T = F(u, p) is solved order by order in
the states themselves, with derivatives of F up to the third: right to eps^7. What fixes clock and eps is the gauge
<p0, u - u0> = (6/a) eps^2 T^2 + (a number). Leading terms: Beyn's.

Kuznetsov, Meijer, Al-Hdaibat and Govaerts, Int. J. Bifurcation and Chaos 24 (2014) 1450057; Al-Hdaibat, Govaerts,
Kuznetsov and Meijer, SIAM J. Appl. Dyn. Syst. 15 (2016) 952, who do so in a normal form on the centre manifold.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.machine import elementary
from contin.normalforms.homoclinic import BogdanovTakensUnfolding
from contin.normalforms.jet import Jet, Real
from contin.normalforms.result import NotThisTypeError

LAST: Final = 7  # order of the equations
KEPT: Final = 5  # order of the parameters and of the orbit that is kept
MOST_STATES: Final = 6  # third derivatives are computed one by one
ROUNDS: Final = 12
SOLVED: Final = 1e-9  # of the largest coefficient
LONGEST: Final = 18.0  # of xi


@dataclass(frozen=True, eq=False)
class HomoclinicSeries:
    """Coefficients of u, (LAST + 1, LAST + 1, n) by powers of eps and T, of p, (LAST + 1, 2), and of omega."""

    orbits: Real
    parameters: Real
    clock: Real

    def at(self, eps: float, order: int = KEPT) -> Real:
        """p - p0 on the homoclinic curve, up to O(eps^6)."""
        powers = elementary.pow(eps, np.arange(order + 1.0))
        return np.asarray(powers @ self.parameters[: order + 1])

    def saddle(self, eps: float, order: int = KEPT) -> Real:
        """u - u0 at T = 1."""
        return np.asarray(self._orbit(eps, np.ones(1), order)[0])

    def orbit(self, eps: float, times: Real, order: int = KEPT) -> Real:
        """u - u0 at times (0 at T = 0), (len(times), n)."""
        xi = np.linspace(-LONGEST, LONGEST, 4001)
        powers = elementary.pow(eps, np.arange(order - 1.0))
        t = np.asarray(elementary.tanh(xi))
        speed = eps * np.vander(t, self.clock.shape[1], increasing=True) @ (powers @ self.clock[: order - 1])
        step = xi[1] - xi[0]
        clock = np.concatenate([[0.0], np.cumsum(0.5 * step * (1.0 / speed[1:] + 1.0 / speed[:-1]))])
        clock -= clock[len(xi) // 2]
        there = np.interp(times, clock, xi, left=-LONGEST, right=LONGEST)
        return self._orbit(eps, np.asarray(elementary.tanh(there)), order)

    def _orbit(self, eps: float, t: Real, order: int) -> Real:
        powers = elementary.pow(eps, np.arange(order + 1.0))
        by_t = np.einsum("k,kjn->jn", powers, self.orbits[: order + 1])
        return np.asarray(np.vander(t, len(by_t), increasing=True) @ by_t)


def homoclinic_series(jet: Jet, unfolding: BogdanovTakensUnfolding) -> HomoclinicSeries:
    """The series of a generic point; NotThisTypeError where the equations of its orders are not solved."""
    if jet.n > MOST_STATES:
        raise NotThisTypeError(f"the series is computed for up to {MOST_STATES} states")
    orders = _Orders.of(jet, unfolding)
    x = orders.first()
    for _ in range(ROUNDS):
        missed = orders.missed(x[None].astype(complex)).real[0]
        size = float(np.abs(missed).max())
        if size <= SOLVED * float(np.abs(x).max()):
            break
        x = x + np.linalg.lstsq(orders.jacobian(x), -missed, rcond=1e-12)[0]
    else:
        raise NotThisTypeError("the orders of the homoclinic series are not solved")
    u, p, clock = (part.real[0] for part in orders.parts(x[None].astype(complex)))
    return HomoclinicSeries(u, p, clock)


Numbers = NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class _Orders:
    """The equations of all orders up to LAST, in the coefficients x."""

    A: Real
    slopes: Real  # (n, 2) F_p
    second: Real  # (n, n + 2, n + 2)
    third: Real
    unfolding: BogdanovTakensUnfolding

    @classmethod
    def of(cls, jet: Jet, unfolding: BogdanovTakensUnfolding) -> _Orders:
        size = jet.n + 2
        eye = np.eye(size)
        slopes = np.stack([jet.form(eye[jet.n + k]) for k in range(2)], axis=1).real
        second, third = np.empty((jet.n, size, size)), np.empty((jet.n, size, size, size))
        for i, j in product(range(size), repeat=2):
            second[:, i, j] = jet.form(*(eye[k] for k in sorted((i, j)))).real
        known: dict[tuple[int, ...], Real] = {}
        for i, j, k in product(range(size), repeat=3):
            key = tuple(sorted((i, j, k)))
            if key not in known:
                known[key] = np.real(jet.form(*(eye[m] for m in key)))
            third[:, i, j, k] = known[key]
        return cls(np.asarray(jet.A), slopes, second, third, unfolding)

    @property
    def n(self) -> int:
        return len(self.A)

    def parts(self, x: Numbers) -> tuple[Numbers, Numbers, Numbers]:
        """Coefficients of u, p and omega, from those of x in rows."""
        rows = len(x)
        u = np.zeros((rows, LAST + 1, LAST + 1, self.n), complex)
        p = np.zeros((rows, LAST + 1, 2), complex)
        clock = np.zeros((rows, LAST, LAST + 1), complex)
        clock[:, 0, 0] = 1.0
        place = 0
        for k in range(2, LAST + 1):
            u[:, k, : k + 1] = x[:, place : place + (k + 1) * self.n].reshape(rows, k + 1, self.n)
            place += (k + 1) * self.n
        p[:, 2:] = x[:, place : place + 2 * (LAST - 1)].reshape(rows, -1, 2)
        place += 2 * (LAST - 1)
        for k in range(1, LAST - 1):
            clock[:, k, : k + 1] = x[:, place : place + k + 1]
            place += k + 1
        return u, p, clock

    def first(self) -> Real:
        """The leading terms."""
        own, n = self.unfolding, self.n
        beta = np.array([0.0, 10.0 * own.b / (7.0 * own.a)])
        u = np.zeros((LAST + 1, LAST + 1, n))
        u[2, 0] = -4.0 / own.a * own.chain.q0 + own.H @ beta
        u[2, 2] = 6.0 / own.a * own.chain.q0
        u[3, 1], u[3, 3] = 12.0 / own.a * own.chain.q1, -12.0 / own.a * own.chain.q1
        parts = [u[k, : k + 1].ravel() for k in range(2, LAST + 1)]
        p = np.zeros((LAST - 1, 2))
        p[0] = own.K @ beta
        clock = np.zeros(sum(k + 1 for k in range(1, LAST - 1)))
        return np.concatenate([*parts, p.ravel(), clock])

    def missed(self, x: Numbers) -> Numbers:
        """By how much the equations of all orders, and the gauge, are missed; for each row of x."""
        u, p, clock = self.parts(x)
        both = np.concatenate([u, np.zeros((*u.shape[:3], 2), complex)], axis=3)
        both[:, :, 0, self.n :] = p
        degree = np.arange(LAST + 1)[:, None]
        slope = np.zeros_like(u)  # (1 - T^2) u_T
        slope[:, :, :-1] += (degree * u)[:, :, 1:]
        slope[:, :, 1:] -= (degree * u)[:, :, :-1]
        found = []
        for k in range(2, LAST + 1):
            gap = -(u[:, k] @ self.A.T)
            gap[:, 0] -= p[:, k] @ self.slopes.T
            for i in range(k - 2):
                gap += _diagonals(clock[:, i, :, None, None] * slope[:, k - 1 - i, None, :, :])
            for i in range(2, k - 1):
                gap -= 0.5 * _form(self.second, both[:, i], both[:, k - i])
            for i in range(2, k - 3):
                for j in range(2, k - i - 1):
                    gap -= _form3(self.third, both[:, i], both[:, j], both[:, k - i - j]) / 6.0
            along = u[:, k] @ self.unfolding.chain.p0
            along[:, 0] = 0.0
            along[:, 2] -= 6.0 / self.unfolding.a if k == 2 else 0.0
            found += [gap[:, : k + 1].reshape(len(x), -1), along[:, : k + 1]]
        return np.concatenate(found, axis=1)

    def jacobian(self, x: Real) -> Real:
        """By complex steps, all at once: exact."""
        moved = x + 1e-30j * np.eye(len(x))
        return np.asarray(self.missed(moved).imag.T / 1e-30)


def _form(second: Real, a: Numbers, b: Numbers) -> Numbers:
    """B(a(T), b(T)), (rows, LAST + 1, n)."""
    along = np.einsum("nij,zai->zanj", second, a)
    return _diagonals(np.einsum("zanj,zbj->zabn", along, b))


def _form3(third: Real, a: Numbers, b: Numbers, c: Numbers) -> Numbers:
    two = np.einsum("zanjk,zbj->zabnk", np.einsum("nijk,zai->zanjk", third, a), b)
    rows, _, _, n, size = two.shape
    first = _diagonals(two.reshape(rows, LAST + 1, LAST + 1, n * size)).reshape(rows, LAST + 1, n, size)
    return _diagonals(np.einsum("zanj,zbj->zabn", first, c))


def _diagonals(whole: Numbers) -> Numbers:
    """Sums over a + b = k of (rows, a, b, n): products of polynomials in T, cut at degree LAST."""
    out = np.zeros((len(whole), LAST + 1, whole.shape[-1]), complex)
    for i in range(LAST + 1):
        out[:, i:] += whole[:, i, : LAST + 1 - i]
    return out
