"""Newton's method on G(x) = 0 until rounding decides, with the errors that rounding leaves.

G may have more equations than unknowns where they agree, and its Jacobian may nearly vanish in some directions, as that
of defining systems of special points do (`contin.problems.equilibria.defining`). Unknowns are scaled.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Protocol

import numpy as np

from contin.abi import Array
from contin.machine.elementary import cos
from contin.problems.tolerances import SETTLED, STALLED
from contin.systems.functions.grain import grain

NEWTON_BUDGET = 30
PERTURBATION = 1e-12  # of the solution, to sample the rounding errors of the defining system
ALIKE = 4.0  # rounding errors of terms, in units of them
ROUNDED = 1e-9  # ... and where all terms are rounded anew, while the curvature is below rounding errors
SAMPLES = 6
LINEAR = 0.4  # ratio of corrections from which Newton converges linearly
FOLLOWED = 2  # corrections of the other unknowns
STEADY = 0.02  # ... where the ratio is the same twice
BESIDE = 1e-2  # of the unknowns, where the size of the Jacobian is measured too
FLAT = 1e-8  # singular values this small beside its size: a direction in which the system hardly changes
CLEAR = 20.0  # times the rounding errors: a change that is none of them


class Evaluated(Protocol):
    """What `System` needs, by one kernel call each."""

    def at(self, x: Array) -> tuple[Array, Array]: ...

    def values(self, x: Array) -> Array: ...

    def terms(self, x: Array) -> Array: ...

    def around(self, x: Array) -> tuple[Array, Array, Array]: ...


@dataclass(frozen=True, eq=False)
class Solved:
    """A solution of a defining system: y, its residual (maximum norm, relative to the entries of its Jacobian) and the
    estimated error of y's last entry."""

    y: Array
    extra: Array  # further unknowns (the frequency)
    residual: float
    error: float
    noise: float  # of the residual: what it can be at a true solution
    sensitivity: float = 0.0  # of y's last entry to relative errors of the equations and their derivatives


@dataclass(frozen=True, eq=False)
class System:
    """Equations G(x) = 0.

    at : G(x) (k,), and its Jacobian.  values : G alone, (m, k), at m places (m, unknowns).  terms : sizes of the terms
    that G(x) is made of, (k,): an entry of the Jacobian may be a sum of terms that cancel, and err alike at all places.
    looked : G at rows x, (m, k), its Jacobians at the first two, (2, k, unknowns), and the terms at the first; all in
    one call, where there is one for it.  grained : values are rounded to some digits, of which short steps see nothing.
    """

    at: Callable[[Array], tuple[Array, Array]]
    values: Callable[[Array], Array]
    terms: Callable[[Array], Array] | None = None
    looked: Callable[[Array], tuple[Array, Array, Array]] | None = None
    grained: bool = False

    @classmethod
    def compiled(cls, equations: Evaluated) -> System:
        """Of equations that a kernel evaluates."""
        return cls(equations.at, equations.values, equations.terms, equations.around)

    def around(self, x: Array) -> tuple[Array, Array, Array]:
        """`looked`, also where it takes several calls."""
        if self.looked is not None:
            return self.looked(x)
        (g, matrix), beside = self.at(x[0]), self.at(x[1])
        values = np.concatenate([g[None], beside[0][None], self.values(x[2:])])
        terms = np.zeros(len(g)) if self.terms is None else self.terms(x[0])
        return values, np.array([matrix, beside[1]]), terms


def newton(system: System, x: Array, position: int) -> Solved | None:
    """Gauss-Newton on G(x) = 0 (as many equations as unknowns, or more that are consistent) until rounding decides.

    The error of x[position] is estimated from the scatter of single Newton steps from solutions perturbed by 1e-12:
    that measures how the rounding errors of G, whatever they are, reach the answer. In directions in which the
    Jacobian nearly vanishes the error is how far G stays below its rounding errors.
    """
    reached = converged(system, x, position)
    return None if reached is None else _estimated(system, reached[0], position, reached[1])


def converged(system: System, x: Array, position: int) -> tuple[Array, float] | None:
    """The solution without its errors, and what x[position] still lacks.

    Where Newton converges linearly (a degenerate solution) its geometric series is summed.
    """
    before, ratio_before, lacking, step = np.inf, 0.0, 0.0, np.zeros_like(x)
    for _ in range(NEWTON_BUDGET):
        g, matrix = system.at(x)
        if not (np.isfinite(g).all() and np.isfinite(matrix).all()):
            return None
        solution = _least_squares(matrix, -g)
        if solution is None:
            return None
        step = solution
        size = float(np.linalg.norm(step))
        ratio = size / before if before > 0.0 else 0.0
        if ratio >= 0.95 and size < STALLED:
            lacking = abs(float(step[position]))
            break
        if size > 1e3 or (ratio >= 1.0 and before < STALLED):
            return None
        if LINEAR < ratio < 0.95 and abs(ratio - ratio_before) < STEADY:  # a solution of multiplicity 1/(1 - ratio)
            step, ratio = step / (1.0 - ratio), 0.0
        x = x + step
        if size < SETTLED:
            break
        before, ratio_before = size, ratio
    else:
        if not size < STALLED:
            return None
        lacking = 10.0 * abs(float(step[position]))
    return x, lacking


def _estimated(system: System, x: Array, position: int, lacking: float) -> Solved | None:
    """The solution with its residual, and the errors of both."""
    steps, farther, places = _shifted(x.size)
    sampled, (matrix, beside), terms = system.around(x + places)
    if not np.isfinite(matrix).all():
        return None
    g, entries = sampled[0], np.abs(matrix)
    beside = np.where(np.isfinite(beside), np.abs(beside), 0.0)  # at a degenerate point all of the matrix may vanish
    sizes = np.maximum(entries, beside).max(axis=1)
    largest, biggest, epsilon = float(entries.max()), float(np.abs(x).max()), float(np.finfo(float).eps)
    left, singular, right = np.linalg.svd(matrix, full_matrices=False)
    flat = singular <= FLAT * max(float(singular[0]), float(sizes.max()))
    some = bool(flat.any())
    inverses = np.where(flat, 0.0, 1.0 / np.where(flat, 1.0, singular)) if some else 1.0 / singular
    row = (right.T[position] * inverses) @ left.T  # without the flat directions, see `_reach`
    weights, steep = np.abs(row), right[~flat] if some else right
    close, ahead, behind = sampled[2 : 2 + SAMPLES], sampled[2 + SAMPLES : -SAMPLES], sampled[-SAMPLES:]
    estimates = (steps @ steep.T) @ steep[:, position] - close @ row
    linear = farther @ matrix.T
    near = np.abs(close - g - steps @ matrix.T).max(axis=0)  # rounding errors: of short steps
    curved = np.abs(ahead - g - linear).max(axis=0)  # ... of longer ones with what is curved
    odd = np.abs(0.5 * (ahead - behind) - linear).max(axis=0)  # ... and without
    noise = max(epsilon * largest * biggest, float(near.max()), float(curved.max()))
    rounded = float(weights @ odd)  # of 1 + small, say, the steps of 1e-12 see nothing at all
    alike = ALIKE * epsilon * terms
    error = 2.0 * max(float(np.abs(estimates).max()), rounded) + lacking + float(weights @ alike)
    if system.grained:
        error += _of_grain(system, x, g, matrix, row)
    if some:
        rounded_x = epsilon * biggest * sizes  # what the unknowns' own rounding makes of it
        limits = np.maximum(CLEAR * np.maximum.reduce([near, odd, rounded_x, alike]), np.abs(g))
        error += _along(system, x, position, g, right[flat], limits)
        whole = (right.T[position] / np.maximum(singular, 1e-300)) @ left.T
        felt = float(np.abs(whole) @ alike)  # how the terms' errors reach the answer; no other estimate shows them
        if felt > error:
            limits = np.maximum(limits, alike.max())
            error = max(error, min(felt, _along(system, x, position, g, right[flat], limits)))
    size = largest or 1.0  # in units of time, of which residuals must not depend
    residual = float(np.abs(g).max()) / size
    sensitivity = float(weights @ sizes) * max(1.0, biggest)
    return Solved(x[: position + 1], x[position + 1 :], residual, error, noise / size, sensitivity)


def _of_grain(system: System, x: Array, g: Array, matrix: Array, row: Array) -> float:
    """The error of the unknown to which `row` leads that values leave which are rounded to some digits.

    Beside what reaches it directly, what it changes by while others move by their own errors: at a fold the state is
    known to the error of a slope, and the parameter to its square.
    """
    off = grain(lambda t: system.values(x + np.outer(t, generic(x.size))))
    moved = np.linalg.pinv(matrix) * off
    steps = np.concatenate([moved.T, -moved.T])
    curved = np.abs((system.values(x + steps) - g - steps @ matrix.T) @ row)
    return float(np.abs(row) @ off + np.sum(np.where(np.isfinite(curved), curved, 0.0)))


def _along(system: System, x: Array, position: int, g: Array, directions: Array, limits: Array) -> float:
    """The part of x[position] in how far G stays within its rounding errors along directions, together."""
    parts = [(abs(float(d[position])), d) for d in directions]
    return float(sum(part * _reach(system, x, position, g, d, limits) for part, d in parts if part > 0.0))


def _reach(system: System, x: Array, position: int, g: Array, direction: Array, limits: Array) -> float:
    """How far G stays within its rounding errors along a direction in which it hardly changes.

    The other unknowns follow: where branches touch, G is small along a curve.
    """
    distance = PERTURBATION
    others = np.delete(np.arange(x.size), position)

    def leaves(at: Array) -> bool:
        for _ in range(FOLLOWED):
            value, matrix = system.at(at)
            if bool(np.all(np.abs(value - g) <= limits)):
                return False
            step = _least_squares(matrix[:, others], g - value) if np.all(np.isfinite(matrix)) else None
            if step is None or not np.linalg.norm(step) < distance:
                return True
            at[others] += step
        return bool(np.any(np.abs(system.values(at[None])[0] - g) > limits))

    while distance < 0.1:
        if all(leaves(x + sign * distance * direction) for sign in (1.0, -1.0)):
            break
        distance *= 3.0
    return distance


@cache
def shifts(size: int) -> Array:
    """Perturbations of unknowns, (`SAMPLES`, size)."""
    return np.asarray(PERTURBATION * np.random.default_rng(12345).uniform(-1.0, 1.0, (SAMPLES, size)))


@cache
def _shifted(size: int) -> tuple[Array, Array, Array]:
    """Short steps and longer ones, (`SAMPLES`, size): so near, terms with cancelling parts may not change at all.

    And all places about a solution, less it: itself, one beside it, and those after the short steps and after the
    longer ones, both ways.
    """
    steps = shifts(size)
    farther = ROUNDED / PERTURBATION * steps
    return steps, farther, np.concatenate([np.zeros((1, size)), [BESIDE * generic(size)], steps, farther, -farther])


@cache
def generic(size: int) -> Array:
    """A direction in which nothing is special, (size,)."""
    return np.asarray(cos(1.0 + np.arange(size)))


def _least_squares(matrix: Array, right: Array) -> Array | None:
    try:
        if matrix.shape[0] == matrix.shape[1]:
            return np.asarray(np.linalg.solve(matrix, right))
        return np.asarray(np.linalg.lstsq(matrix, right, rcond=1e-15)[0])
    except np.linalg.LinAlgError:  # Newton ends: not verified, in words
        return None
