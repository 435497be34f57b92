"""Trajectories of M u' = F(u, p) with a constant mass matrix, regular or of index 1, by Radau's method of order 5.

Stages Z (3, n) of a step h solve (A^-1 x M) Z = h F(u + Z) by simplified Newton steps: with A^-1 = V diag(l) V^-1 these
are one real and one complex solve with l M/h - J. The error is that of RADAU5, (l M/h - J)^-1 (F(u) + M sum e_k z_k/h)
(Hairer and Wanner, Solving Ordinary Differential Equations II, sec. IV.8). Algebraic equations hold at all stages.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array, Vector
from contin.errors import InputError
from contin.linalg.factor import Factoriser
from contin.linalg.linear import DirectLinear
from contin.linalg.newton import Rules, newton
from contin.machine import elementary
from contin.systems.functions.mass import Mass

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

    from contin.systems.functions.function_system import FunctionSystem

_ROOT: Final = sqrt(6.0)
NODES: Final = np.array([0.0, (4.0 - _ROOT) / 10.0, (4.0 + _ROOT) / 10.0, 1.0])
_POWERS: Final = np.linalg.inv(np.vander(NODES, increasing=True))  # coefficients of the cubic through four values
_RATES: Final = (np.diag([1.0, 2.0, 3.0]) @ _POWERS[1:, 1:]).T  # dz/dx at a node from values at the nodes:
INVERSE: Final = np.vander(NODES[1:], 3, increasing=True) @ _RATES.T  # the inverse of Radau's matrix A
_VALUES, _VECTORS = np.linalg.eig(INVERSE)
_REAL: Final = int(np.argmin(np.abs(_VALUES.imag)))
_UP: Final = int(np.argmax(_VALUES.imag))
_BACK: Final = np.linalg.inv(_VECTORS)
ERROR: Final = np.array([-13.0 - 7.0 * _ROOT, -13.0 + 7.0 * _ROOT, -1.0]) / 3.0
ITERATIONS: Final = 7
STEPS: Final = 200_000
LEAST, MOST, SAFETY = 0.2, 8.0, 0.9  # by which a step changes
SINGULAR: Final = 1e12  # condition of the algebraic equations from which the index is above 1
CONSISTENT: Final = Rules(settled=1e-14, stalled=1e-8, far=1e6, budget=40)


@dataclass(frozen=True, eq=False)
class Weighed:
    """The equations at parameters p, and their linear algebra."""

    system: FunctionSystem
    mass: csc_matrix
    p: Array

    def value(self, u: Array) -> Array:
        return self.system.value(u, self.p)

    def slope(self, u: Array) -> csc_matrix:
        from scipy.sparse import csc_matrix

        return csc_matrix(self.system.slopes(u, self.p))

    def start(self, u: Array) -> Array:
        """u with its algebraic states solved for; InputError where they are not determined (index above 1)."""
        by_rows = np.diff(self.mass.tocsr().indptr) == 0
        by_columns = np.diff(self.mass.indptr) == 0
        rows, columns = np.flatnonzero(by_rows), np.flatnonzero(by_columns)
        name = f"function {self.system.model.name!r}, mass"
        if len(rows) != len(columns) or not self._rest_is_regular(~by_rows, ~by_columns):
            raise InputError(
                f"{name}: its rows depend on each other; combine the equations so that the algebraic ones have rows of "
                "zeros, and the states without mass columns of zeros, to simulate it"
            )
        if not len(rows):
            return u

        def correct(z: Array) -> tuple[float, Array] | None:
            whole = u.copy()
            whole[columns] = z
            left = self.value(whole)[rows]
            block = self.slope(whole)[rows][:, columns].tocsc()
            if not (np.all(np.isfinite(left)) and np.all(np.isfinite(block.data))):
                return None
            self._check_index(block, rows, name)
            step = DirectLinear(block, Factoriser()).solve(-left)
            return float(np.abs(step).max() / (1.0 + np.abs(z).max())), z + step

        found = newton(correct, u[columns], CONSISTENT)
        if found is None:
            raise InputError(f"{name}: the algebraic equations have no solution near the start; start closer")
        whole = u.copy()
        whole[columns] = found.at
        return whole

    def _rest_is_regular(self, rows: NDArray[np.bool_], columns: NDArray[np.bool_]) -> bool:
        return Mass(self.mass[rows][:, columns].tocsc()).is_regular

    def _check_index(self, block: csc_matrix, rows: NDArray[np.intp], name: str) -> None:
        size = float(abs(block).sum(axis=0).max())
        with np.errstate(all="ignore"):
            x = np.random.default_rng(5).normal(size=len(rows))
            grown = DirectLinear(block, Factoriser()).solve(x) if size > 0.0 else np.full(1, np.inf)
        large = float(np.abs(grown).max()) * size
        if large < SINGULAR * float(np.abs(x).max()):
            return
        listed = ", ".join(map(str, rows[:6])) + (", ..." if len(rows) > 6 else "")
        raise InputError(
            f"{name}: the index is above 1: the algebraic equations {listed} do not determine the states without mass. "
            "Equilibria and orbits can be followed; trajectories need these equations differentiated by time"
        )


def integrate_with_mass(
    system: FunctionSystem, u: Array, p: Array, times: Array, rtol: float, atol: Array, box: float
) -> tuple[Array, Array, int, str, str]:
    """(t, states, steps, outcome, why) with the states at `times` as far as the solution goes; from t = 0."""
    mass = system.model.mass_matrix
    assert mass is not None
    equations = Weighed(system, mass, np.array(p, dtype=float))
    u = equations.start(np.array(u, dtype=float))
    course = _Course(equations, rtol, atol)
    t, end, taken = 0.0, float(times[-1]), 0
    h = course.first_step(u, end)
    found = [u] * int(np.sum(times <= 0.0))
    kept = len(found)
    while kept < len(times):
        made = course.step(u, min(h, end - t))
        taken += 1
        if made is None or taken > STEPS:
            why = f"no step is small enough at t = {t:.6g}" if made is None else f"{STEPS} steps were not enough"
            return times[:kept], np.array(found).reshape(kept, len(u)), taken, "stopped", why
        Z, length, h = made
        cubic = _POWERS @ np.vstack([np.zeros(len(u)), Z])
        while kept < len(times) and times[kept] <= t + length * (1.0 + 1e-12):
            x = (times[kept] - t) / length
            found.append(u + cubic.T @ np.cumprod([1.0, x, x, x]))
            kept += 1
        t, u = t + length, u + Z[-1]
        if float(np.abs(u).max()) > box:
            why = f"left the box at t = {t:.6g}: a state exceeds {box:.6g}"
            return times[:kept], np.array(found).reshape(kept, len(u)), taken, "escaped", why
    return times, np.array(found), taken, "done", ""


class _Course:
    """Steps with factors that serve again while the length stays."""

    def __init__(self, equations: Weighed, rtol: float, atol: Array) -> None:
        self.equations, self.rtol, self.atol = equations, rtol, np.asarray(atol)
        self.tolerance = max(10.0 * np.finfo(float).eps / rtol, min(0.03, sqrt(rtol)))
        self._factored: tuple[float, DirectLinear, DirectLinear] | None = None
        self._slope: csc_matrix | None = None
        self._guess: tuple[Array, float] | None = None  # the last step's cubic, and its length

    def size(self, v: Vector, u: Array) -> float:
        """Root mean square of v in units of the tolerances at u."""
        scaled = np.abs(v) / (self.atol + self.rtol * np.abs(u))
        return float(np.sqrt(np.mean(scaled * scaled)))

    def first_step(self, u: Array, end: float) -> float:
        """From the rates of what moves, as if M were the identity on its own rows."""
        rate = np.abs(self.equations.value(u))
        weights = np.asarray(abs(self.equations.mass).sum(axis=1)).ravel()
        rate = np.where(weights > 0.0, rate / np.where(weights > 0.0, weights, 1.0), 0.0)
        size = self.size(rate, u)
        return min(end, 1e-2 / size) if np.isfinite(size) and size * end > 1e-2 else 1e-3 * end

    def _linear(self, u: Array, h: float) -> tuple[DirectLinear, DirectLinear]:
        if self._slope is None:
            self._slope, self._factored = self.equations.slope(u), None
        if self._factored is None or self._factored[0] != h:
            base = DirectLinear(-self._slope, Factoriser(), mass=self.equations.mass)
            real = base.shifted(-float(_VALUES[_REAL].real) / h)
            self._factored = h, real, base.shifted(-_VALUES[_UP] / h)
        return self._factored[1:]

    def step(self, u: Array, h: float) -> tuple[Array, float, float] | None:
        """(Z, the length taken, the next one); None where none is small enough."""
        fresh, smallest = False, 1e-14 * h + 1e-300
        while h > smallest:
            solved = self._stages(u, h)
            if solved is None:
                if fresh:
                    h, self._factored = 0.5 * h, None
                self._slope, fresh = None, True
                continue
            Z, iterations = solved
            error = self._error(u, Z, h)
            safety = SAFETY * (2 * ITERATIONS + 1) / (2 * ITERATIONS + iterations)
            factor = float(np.clip(safety * elementary.pow(max(error, 1e-10), -0.25), LEAST, MOST))
            if not error < 1.0:  # NaN too
                h *= factor if np.isfinite(factor) else LEAST
                continue
            self._guess = _POWERS @ np.vstack([np.zeros(len(u)), Z]), h
            if iterations > 3:
                self._slope = None
            return Z, h, h if 1.0 <= factor < 1.2 else h * factor
        return None

    def _error(self, u: Array, Z: Array, h: float) -> float:
        real, _ = self._linear(u, h)
        moved = self.equations.mass @ (ERROR @ Z) / h
        error = real.solve(self.equations.value(u) + moved)
        size = self.size(error, np.maximum(np.abs(u), np.abs(u + Z[-1])))
        if size >= 1.0:  # filtered once more, as at a first step
            size = min(size, self.size(real.solve(self.equations.value(u + error) + moved), u))
        return size

    def _stages(self, u: Array, h: float) -> tuple[Array, int] | None:
        Z, before = self._predicted(h, len(u)), np.inf
        real, up = self._linear(u, h)
        for k in range(ITERATIONS):
            with np.errstate(all="ignore"):
                F = np.array([self.equations.value(u + z) for z in Z])
            left = F - (self.equations.mass @ (INVERSE @ Z).T).T / h
            if not np.all(np.isfinite(left)):
                return None
            into = _BACK @ left
            change = np.outer(_VECTORS[:, _REAL], real.solve(into[_REAL].real.copy())).real
            change = change + 2.0 * np.outer(_VECTORS[:, _UP], up.solve(into[_UP])).real
            size = self.size(change, u)
            Z = Z + change
            rate = size / before
            if not np.isfinite(size) or rate >= 1.0:
                return None
            if size == 0.0 or (k > 0 and rate / (1.0 - rate) * size < self.tolerance) or size < 1e-3 * self.tolerance:
                return Z, k + 1
            before = size
        return None

    def _predicted(self, h: float, n: int) -> Array:
        if self._guess is None:
            return np.zeros((3, n))
        cubic, length = self._guess
        x = 1.0 + NODES[1:] * h / length
        return np.asarray(np.vander(x, 4, increasing=True) @ cubic - cubic.sum(axis=0))
