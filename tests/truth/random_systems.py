"""Random polynomial systems with some transcendental terms, and degenerate ones whose special points have closed forms.

Coefficients are fractions of 64, coordinates are mixed by matrices of integers with determinant 1: the formulas'
numbers are exact in double precision.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import sympy

from tests.truth.exact_labels import Formulas

P, Q = sympy.symbols("p q")
SPREAD = 2.0  # of linear coefficients


def states(n: int) -> tuple[sympy.Symbol, ...]:
    return tuple(sympy.symbols(f"u0:{n}"))


def dyadic(generator: np.random.Generator, spread: float) -> sympy.Rational:
    return sympy.Rational(int(generator.integers(-int(64 * spread), int(64 * spread) + 1)), 64)


def mixing(generator: np.random.Generator, n: int) -> sympy.Matrix:
    """Integers, determinant 1: a few shears."""
    matrix = sympy.eye(n)
    for _ in range(0 if n == 1 else int(generator.integers(0, 2 * n))):
        i, j = generator.choice(n, 2, replace=False)
        matrix[int(i), :] += int(generator.integers(-2, 3)) * matrix[int(j), :]
    return matrix


def mixed(generator: np.random.Generator, system: Formulas) -> Formulas:
    """The system in coordinates v = M u."""
    matrix = mixing(generator, system.n)
    old = dict(zip(system.states, matrix.inv() * sympy.Matrix(system.states), strict=True))
    images = [e.subs(old, simultaneous=True) for e in system.equations]
    moved = tuple(sympy.expand(e) for e in matrix * sympy.Matrix(images))
    return Formulas(system.states, system.parameters, moved, system.kind)


def random_system(generator: np.random.Generator, n: int, kind: str = "flow", parameters: int = 1) -> Formulas:
    """Zero at the origin for p = q = 0."""
    u, free = states(n), (P, Q)[:parameters]
    spread = 0.8 if kind == "map" else SPREAD
    equations = []
    for i in range(n):
        terms = sum(dyadic(generator, spread) * v for v in u)
        terms += sum(dyadic(generator, 1.0) * p for p in free)
        for _ in range(n + 2):
            a, b = generator.integers(0, n, 2)
            terms += dyadic(generator, 1.0) * u[a] * u[b]
            terms += dyadic(generator, 0.5) * free[int(generator.integers(0, parameters))] * u[a]
        terms += dyadic(generator, 0.5) * u[int(generator.integers(0, n))] ** 2 * u[i]
        if generator.random() < 0.4:
            k = int(generator.integers(0, n))
            terms += dyadic(generator, 1.0) * (sympy.sin(u[k]) if generator.random() < 0.5 else sympy.exp(u[k]) - 1)
        equations.append(terms - sympy.Rational(1, 4) * u[i] ** 3)
    return mixed(generator, Formulas(u, free, tuple(equations), kind))


def with_hopf(generator: np.random.Generator, n: int) -> Formulas:
    """A pair of eigenvalues e + p +- i w beside further ones, with random nonlinear terms."""
    u = states(n)
    omega, rate = abs(dyadic(generator, 1.0)) + sympy.Rational(1, 16), dyadic(generator, 0.5)
    equations = [(P - rate) * u[0] - omega * u[1], omega * u[0] + (P - rate) * u[1]]
    equations += [-(abs(dyadic(generator, 2.0)) + sympy.Rational(1, 8)) * u[k] for k in range(2, n)]
    for i in range(n):
        for _ in range(4):
            a, b, c = generator.integers(0, n, 3)
            equations[i] += dyadic(generator, 1.0) * u[a] * u[b] + dyadic(generator, 1.0) * u[a] * u[b] * u[c]
    return mixed(generator, Formulas(u, (P,), tuple(equations)))


@dataclass(frozen=True)
class Planted:
    """A system whose labels of one type on the branch from the start stand at known values of p."""

    name: str
    system: Formulas
    type: str
    at: tuple[float, ...]
    start: tuple[float, ...]  # in the coordinates of the system
    begin: float = -1.0


def degenerate(generator: np.random.Generator) -> Iterator[Planted]:
    """Folds, branch points and Hopf points with higher order, small coefficients, near others; n = 1 ... 3."""
    x, y, z = states(3)
    r = dyadic(generator, 0.4)
    s = P - r
    small = sympy.Rational(1, 2 ** int(generator.integers(4, 24)))
    trivial = {
        "pitchfork": s * x - x**3, "weak pitchfork": small * s * x - x**3, "flat pitchfork": s * x - small * x**3,
        "quintic pitchfork": s * x - x**5, "transcritical": s * x - x**2, "weak transcritical": s * x - small * x**2,
        "nearly a pitchfork": s * x - small * x**2 - x**3, "slow crossing": small * s * x - x**2 + x**3,
        "cubic crossing": s**3 * x - x**3, "tangency": -x * (x - s**2), "tangency of order 4": -x * (x - s**4),
        "cubic exchange": s**3 * x - x**2,
        "near a second one": -x * (x - 4 * s * (s + small)),
    }  # fmt: skip
    for name, equation in trivial.items():
        places = (float(r),) if name != "near a second one" else (float(r - small), float(r))
        yield _slaved(generator, name, equation, "BP", places, 0.0, -1.0)
    folds = {
        "fold": (s + x**2, 0.0), "flat fold": (s + x**4, 0.0), "weak fold": (s + small * x**2, 0.0),
        "fold, small cubic": (s + small * x**2 + x**3 * small, 0.0), "sixth order": (s + x**6, 0.0),
    }  # fmt: skip
    for name, (equation, _) in folds.items():
        half = sympy.lambdify(x, equation.subs(P, -1))
        start = _root(half)
        if start is not None:
            at = (float(r),)
            yield _slaved(generator, name, equation, "LP", at, start, -1.0)
    n = int(generator.integers(2, 4))
    omega = abs(dyadic(generator, 1.0)) + sympy.Rational(1, 32)
    rates = {
        "Hopf": (s, -1), "slow Hopf": (small * s, -1), "cubic Hopf": (s**3, -1), "degenerate Hopf": (s, 0),
        "weak Hopf": (s, small), "two Hopf points": (s * (s + small), -1), "low frequency": (s, -1),
    }  # fmt: skip
    for name, (rate, cubic) in rates.items():
        w = small if name == "low frequency" else omega
        square = x**2 + y**2
        equations = [rate * x - w * y + cubic * x * square, w * x + rate * y + cubic * y * square, -z + x**2]
        if cubic == 0:
            equations[0] -= x * square**2
            equations[1] -= y * square**2
        system = mixed(generator, Formulas((x, y, z)[:n], (P,), tuple(equations[:n])))
        places = (float(r - small), float(r)) if name == "two Hopf points" else (float(r),)
        yield Planted(f"{name}, n = {n}", system, "HB", places, (0.0,) * n)


def _root(function) -> float | None:
    """Where a polynomial in x vanishes, on a grid from below; bisected."""
    grid = -np.geomspace(1e-3, 1e6, 400)
    values = np.array([float(function(v)) for v in grid])
    change = np.nonzero(values[1:] * values[:-1] < 0.0)[0]
    if not change.size:
        return None
    low, high = grid[change[0]], grid[change[0] + 1]
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if float(function(middle)) * float(function(high)) < 0.0 else (low, middle)
    return float(middle)


def _slaved(
    generator: np.random.Generator, name: str, equation, type_: str, at: tuple[float, ...], start: float, begin: float
) -> Planted:
    """Further states follow x; all are mixed."""
    n = int(generator.integers(1, 4))
    u = states(n)
    slopes = [dyadic(generator, 1.0) for _ in range(n - 1)]
    equations = [equation] + [-2 * (v - a * u[0]) for v, a in zip(u[1:], slopes, strict=True)]
    matrix = mixing(generator, n)
    old = dict(zip(u, matrix.inv() * sympy.Matrix(u), strict=True))
    images = matrix * sympy.Matrix([e.subs(old, simultaneous=True) for e in equations])
    place = np.array(matrix.tolist(), float) @ np.array([start, *(float(a) * start for a in slopes)])
    system = Formulas(u, (P,), tuple(sympy.expand(e) for e in images))
    return Planted(f"{name}, n = {n}", system, type_, at, tuple(map(float, place)), begin)
