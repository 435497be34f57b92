"""Taylor coefficients of a centre manifold and of the normal form on it, to any order, each computed when asked for.

The manifold u = u0 + sum h_v w^v and the normal form w' = diag(lambda) w + sum g_v w^v (map: w -> ...) satisfy the
homological equation H_w(w) G(w) = F(H(w)) (map: H(G(w)) = F(H(w))). At order v it reads

    (A - lambda.v) h_v = sum_j g_vj q_j + S_v - R_v         (map: lambda^v for lambda.v)

with R_v from products of lower coefficients in the Taylor series of F, and S_v from lower ones in H_w G. Where
lambda.v = lambda_j (resonance) the matrix is singular, g_vj = <p_j, R_v - S_v>, and <p_j, h_v> = 0 fixes h_v.
Active parameters are further centre coordinates that do not move; v counts them last. Coefficients are Taylor's (no
factorials): h_20 here is half of Kuznetsov's h_20.

Of M u' = F, M singular or not, the left side is M H_w(w) G(w): A - lambda.v M, g_vj M q_j, M S_v, and <p_j, M h_v> = 0.

Sources: Kuznetsov, SIAM J. Numer. Anal. 36 (1999) 1104; Kuznetsov, Elements of Applied Bifurcation Theory, 3rd ed.,
sec. 8.7; Kuznetsov and Meijer, SIAM J. Sci. Comput. 26 (2005) 1932 (maps).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from itertools import product
from math import factorial

import numpy as np

from contin.abi import Vector
from contin.normalforms.jet import Jet, Real, lift, mass_of, otherwise, size_of_terms, uncertain
from contin.normalforms.linear import EigenPair, solve_with_growth
from contin.normalforms.poles import NEAR, off_beside_pole
from contin.normalforms.result import TRUST

Index = tuple[int, ...]
RESONANCE = 1e-6  # relative distance at which lambda.v counts as equal to lambda_j
LONG = 4
ROUNDED = 16.0 * float(np.finfo(float).eps) / TRUST  # of what the terms are, in units of `TRUST`


class CentreManifold:
    """Coefficients h_v and g_v over the eigenvectors `pairs` (semisimple critical eigenvalues) of a jet.

    `h(v)` is an (n,) array, `g(v, j)` a number (zero where v is not resonant with j), `magnitude(v, j)` the sum of the
    moduli of the summands of g(v, j), against which rounding in it is measured (errors of differences in units of
    `TRUST` with them, and what coefficients h beside poles are off by). v has one entry for each pair, then one
    for each active parameter (those may be left out).

    drift (n + parameters,) : estimated errors of the states and active parameters, which count beside poles.
    """

    def __init__(self, jet: Jet, pairs: Sequence[EigenPair], drift: Real | None = None) -> None:
        self.jet, self.drift = jet, drift
        self._mass = mass_of(jet)
        self.values = np.array([pair.value for pair in pairs], dtype=complex)
        is_real = not np.any(self.values.imag) and not any(np.iscomplexobj(pair.right) for pair in pairs)
        self._dtype = float if is_real else complex  # of all coefficients: real forms take a third of the time
        self.right = np.array([pair.right for pair in pairs], dtype=self._dtype)
        self.left = np.array([pair.left for pair in pairs], dtype=self._dtype)
        self.m = len(pairs)
        self._listed: list[complex] = self.values.tolist()
        self._h: dict[Index, Vector] = {}
        self._g: dict[Index, dict[int, complex]] = {}
        self._rhs: dict[Index, Vector] = {}
        self._terms: dict[Index, list[tuple[float, list[Vector], Vector]]] = {}  # weights, directions and forms of R_v
        self._directions: dict[Index, Vector] = {}
        self._largest = max([1.0 if jet.kind == "map" else 0.0, *map(abs, self._listed)])
        self._sizes: dict[Index, Real] = {}
        self._off: dict[Index, list[Vector]] = {}  # how far h_v may be off, where it lies beside a pole

    def h(self, *index: int) -> Vector:
        return self._coefficient(self._full(index))

    def g(self, index: Index, j: int) -> complex:
        return self._normal(self._full(index)).get(j, 0.0)

    def magnitude(self, index: Index, j: int) -> float:
        v = self._full(index)
        if j not in self._normal(v):
            return 0.0
        if v not in self._sizes:
            self._sizes[v] = self._sum_of_moduli(v)
        return float(np.abs(self.left[j]) @ self._sizes[v])

    def _full(self, index: Index) -> Index:
        return (*index, *(0,) * (self.m + self.jet.parameters - len(index)))

    def _unit(self, index: Index) -> int | None:
        return index.index(1) if sum(index) == 1 else None

    def _coefficient(self, v: Index) -> Vector:
        unit = self._unit(v)
        if unit is not None and unit < self.m:
            eigenvector: Vector = self.right[unit]
            return eigenvector
        if v not in self._h:
            multiplier = self._multiplier(v)
            shift = multiplier if self._dtype is complex else multiplier.real
            self._solve(v, shift, list(self._normal(v)))
        return self._h[v]

    def _solve(self, v: Index, shift: complex, resonant: list[int]) -> None:
        """h_v of (A - shift M) h = S_v - R_v, bordered where pairs are resonant."""
        matrix = self.jet.A - shift * (np.eye(self.jet.n) if self._mass is None else self._mass)
        borders = self._borders(resonant) if resonant else (None, None)
        self._h[v], growth = solve_with_growth(matrix, -self._inhomogeneity(v), *borders)
        if growth > NEAR and self._unit(v) is None:
            self._off[v] = off_beside_pole(self.jet, matrix, borders, self._direction(v), self.drift)

    def _borders(self, resonant: list[int]) -> tuple[Vector, Vector]:
        """M q_j and M^T p_j as columns."""
        right, left, mass = self.right[resonant].T, self.left[resonant].T, self._mass
        return (right, left) if mass is None else (mass @ right, mass.T @ left)

    def _weighed(self, h: Vector) -> Vector:
        return h if self._mass is None else self._mass @ h

    def _normal(self, v: Index) -> dict[int, complex]:
        """g_v as {j: value} for every j that is resonant with v; the linear part diag(lambda) is not among them."""
        unit = self._unit(v)
        if unit is not None and unit < self.m:
            return {}
        if v not in self._g:
            resonant = self._resonant(v)
            self._g[v] = {}
            for j in resonant:
                self._g[v][j] = complex(np.vdot(self.left[j], self._inhomogeneity(v)))
        return self._g[v]

    def _multiplier(self, v: Index) -> complex:
        if self.jet.kind == "map":
            return complex(np.prod(self.values ** np.array(v[: self.m])))
        return complex(sum(power * value for power, value in zip(v, self._listed, strict=False)))

    def _resonant(self, v: Index) -> list[int]:
        multiplier, close = self._multiplier(v), RESONANCE * self._largest
        return [j for j, value in enumerate(self._listed) if abs(multiplier - value) <= close]

    def _inhomogeneity(self, v: Index) -> Vector:
        """R_v - S_v."""
        if v not in self._rhs:
            total: Vector = np.zeros(self.jet.n, dtype=self._dtype)
            for weight, _, form in self._products(v):
                total += weight * form
            for coefficient, u in self._transport(v):
                factor = coefficient if self._dtype is complex else coefficient.real
                total = total - factor * self._weighed(self._coefficient(u))
            self._rhs[v] = total
        return self._rhs[v]

    def _sum_of_moduli(self, v: Index) -> Real:
        """Of the summands of R_v - S_v, component by component."""
        sizes: Real = np.zeros(self.jet.n)
        for weight, directions, form in self._products(v):
            sizes = sizes + np.abs(weight * form)
            if 1 < len(directions) < LONG:  # longer ones are evaluated along their directions: `rounding` sees theirs
                sizes = sizes + ROUNDED * weight * size_of_terms(self.jet, *directions)
            if otherwise(self.jet) and len(directions) > 1:
                sizes = sizes + weight * uncertain(self.jet, *directions) / TRUST
        for coefficient, u in self._transport(v):
            sizes = sizes + np.abs(coefficient * self._weighed(self._coefficient(u)))
        return sizes + self._beside_poles(v) if self._off else sizes

    def _beside_poles(self, v: Index) -> Real:
        """What errors of the coefficients in R_v make of it, in units of `TRUST`."""
        found: Real = np.zeros(self.jet.n)
        for weight, parts in weighted_partitions(v):
            for place, part in enumerate(parts):
                others = [self._direction(other) for k, other in enumerate(parts) if k != place]
                moved = [lift(off, self.jet.parameters) for off in self._off.get(part, ())]
                if moved:
                    sizes = [np.abs(self.jet.form(off, *others)) for off in moved]
                    found = found + weight * np.max(sizes, axis=0) / TRUST
        return found

    def _products(self, v: Index) -> list[tuple[float, list[Vector], Vector]]:
        """R_v = sum of weight F[directions]; for a parameter alone, A h + F_p = sum g q."""
        known = self._terms.get(v)
        if known is None:
            known = self._terms[v] = [(w, given, self.jet.form(*given)) for w, given in self._multilinear(v)]
        return known

    def _multilinear(self, v: Index) -> Iterator[tuple[float, list[Vector]]]:
        if sum(v) == 1:
            yield 1.0, [lift(np.zeros(self.jet.n), self.jet.parameters, v.index(1) - self.m)]
            return
        for weight, parts in weighted_partitions(v):
            yield weight, [self._direction(part) for part in parts]

    def _direction(self, v: Index) -> Vector:
        known = self._directions.get(v)
        if known is not None:
            return known
        direction = np.zeros(self.jet.n + self.jet.parameters, dtype=self._dtype)
        unit = self._unit(v)
        if unit is not None and unit >= self.m:
            direction[self.jet.n + unit - self.m] = 1.0
        direction[: self.jet.n] = self._coefficient(v)
        self._directions[v] = direction
        return direction

    def _transport(self, v: Index) -> Iterator[tuple[complex, Index]]:
        """The pairs (c, u) of S_v = sum c h_u: where terms of H_w G (or H(G)) below v's own meet in w^v."""
        if self.jet.kind == "map":
            yield from self._composition(v)
            return
        for k in below(v):
            if k == v:
                continue
            for j, g in self._normal(k).items():
                u = tuple(a - b + (i == j) for i, (a, b) in enumerate(zip(v, k, strict=True)))
                yield u[j] * g, u

    def _composition(self, v: Index) -> Iterator[tuple[complex, Index]]:
        """Coefficients of w^v in G(w)^u for every u != v of degree 2 to |v|."""
        size = len(v)
        series: list[dict[Index, complex]] = []
        for j in range(size):
            unit = tuple(int(i == j) for i in range(size))
            terms = {unit: complex(self.values[j]) if j < self.m else 1.0}
            if j < self.m:
                for k in below(v):
                    if k != v and j in self._normal(k):
                        terms[k] = terms.get(k, 0.0) + self._normal(k)[j]
            series.append(terms)
        degree = sum(v)
        parameters = sum(v[self.m :])
        for u in product(*(range(degree + 1) for _ in range(size))):
            if u == v or not 2 <= sum(u) <= degree or sum(u[self.m :]) > parameters:
                continue
            coefficient = _power(series, u, v)
            if coefficient != 0.0:
                yield coefficient, u


@lru_cache(maxsize=4096)
def below(v: Index) -> tuple[Index, ...]:
    """Every k with 0 <= k <= v in each entry, except zero."""
    return tuple(k for k in product(*(range(a + 1) for a in v)) if any(k))


@lru_cache(maxsize=4096)
def partitions(v: Index) -> tuple[tuple[Index, ...], ...]:
    """Every multiset of two or more nonzero indices with sum v.

    >>> partitions((1, 1))
    (((1, 0), (0, 1)),)
    """
    return tuple(parts for parts in _multisets(v, v) if len(parts) > 1)


@lru_cache(maxsize=4096)
def weighted_partitions(v: Index) -> tuple[tuple[float, tuple[Index, ...]], ...]:
    """Those of `partitions`, each with the product of 1/k! over parts that occur k times."""
    found = []
    for parts in partitions(v):
        weight = 1.0
        for part in set(parts):
            weight /= factorial(parts.count(part))
        found.append((weight, parts))
    return tuple(found)


def _multisets(v: Index, largest: Index) -> Iterator[tuple[Index, ...]]:
    if not any(v):
        yield ()
        return
    for k in below(v):
        if k <= largest:
            rest = tuple(a - b for a, b in zip(v, k, strict=True))
            for parts in _multisets(rest, k):
                yield (k, *parts)


def _power(series: Sequence[dict[Index, complex]], u: Index, v: Index) -> complex:
    """Coefficient of w^v in the product of series[j]^u[j]."""
    total: dict[Index, complex] = {tuple(0 for _ in v): 1.0}
    for terms, exponent in zip(series, u, strict=True):
        for _ in range(exponent):
            grown: dict[Index, complex] = {}
            for a, x in total.items():
                for b, y in terms.items():
                    c = tuple(i + j for i, j in zip(a, b, strict=True))
                    if all(i <= j for i, j in zip(c, v, strict=True)):
                        grown[c] = grown.get(c, 0.0) + x * y
            total = grown
    return total.get(v, 0.0)
