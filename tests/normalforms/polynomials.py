"""Truncated power series in several variables: vector fields and maps whose normal forms are known by construction.

A series is a dict {exponents: coefficient}. `hide` takes a normal form, adds hyperbolic directions, and applies a
polynomial change of coordinates; the Taylor coefficients of the result are exact up to rounding.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from itertools import combinations_with_replacement, permutations, product

import numpy as np

Series = dict[tuple[int, ...], float]


def add(*terms: Series) -> Series:
    total: Series = {}
    for term in terms:
        for e, c in term.items():
            total[e] = total.get(e, 0.0) + c
    return total


def scale(a: Series, factor: float) -> Series:
    return {e: factor * c for e, c in a.items()}


class Truncated:
    """Series in `size` variables up to a degree as vectors of coefficients, whose products are sums over a table."""

    def __init__(self, size: int, order: int) -> None:
        self.exponents = exponents(size, 0, order)
        self.place = {e: k for k, e in enumerate(self.exponents)}
        every = np.array(self.exponents, dtype=int).reshape(-1, size)
        degree, digits = every.sum(axis=1), (order + 1) ** np.arange(size)
        codes = every @ digits
        by_code = np.argsort(codes)
        pairs = [(k, np.flatnonzero(degree <= order - degree[k])) for k in range(len(every))]
        self.first = np.concatenate([np.full(len(js), k) for k, js in pairs])
        self.second = np.concatenate([js for _, js in pairs])
        self.product = by_code[np.searchsorted(codes, codes[self.first] + codes[self.second], sorter=by_code)]

    def vector(self, series: Series) -> np.ndarray:
        v = np.zeros(len(self.exponents))
        for e, c in series.items():
            if e in self.place:
                v[self.place[e]] = c
        return v

    def series(self, vector: np.ndarray) -> Series:
        return {self.exponents[k]: float(vector[k]) for k in np.flatnonzero(vector)}

    def times(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return np.bincount(self.product, a[self.first] * b[self.second], len(a))


truncated = cache(Truncated)


def multiply(a: Series, b: Series, order: int) -> Series:
    if not a or not b:
        return {}
    space = truncated(len(next(iter(a))), order)
    return space.series(space.times(space.vector(a), space.vector(b)))


def compose(a: Series, inner: list[Series], order: int) -> Series:
    """a(inner_1, inner_2, ...), inner without constant terms."""
    space = truncated(len(next(iter(inner[0]))), order)
    one = np.zeros(len(space.exponents))
    one[space.place[(0,) * len(space.exponents[0])]] = 1.0
    powers = [[one, space.vector(g)] for g in inner]
    total = np.zeros(len(one))
    for e, c in a.items():
        if sum(e) > order:
            continue
        term = c * one
        for j, k in enumerate(e):
            while len(powers[j]) <= k:
                powers[j].append(space.times(powers[j][-1], powers[j][1]))
            if k:
                term = space.times(term, powers[j][k])
        total += term
    return space.series(total)


def derivative(a: Series, j: int) -> Series:
    return {tuple(k - (i == j) for i, k in enumerate(e)): e[j] * c for e, c in a.items() if e[j]}


def variable(j: int, size: int) -> Series:
    return {tuple(int(i == j) for i in range(size)): 1.0}


def exponents(size: int, low: int, high: int):
    return [e for e in product(range(high + 1), repeat=size) if low <= sum(e) <= high]


@dataclass
class PolynomialJet:
    """The jet at the origin of u' = F(u, p) (or u -> F) with polynomial F: n series in n + parameters variables."""

    field: list[Series]
    parameters: int = 0
    kind: str = "flow"
    scale: np.ndarray | None = None
    calls: int = 0

    @property
    def n(self) -> int:
        return len(self.field)

    @property
    def A(self) -> np.ndarray:
        return np.array([self.form(d) for d in np.eye(self.n + self.parameters)[: self.n]]).T

    @cached_property
    def second_sizes(self) -> np.ndarray:
        n, eye = self.n, np.eye(self.n + self.parameters)
        sizes = np.empty((n, n, n))
        for j, k in combinations_with_replacement(range(n), 2):
            sizes[:, j, k] = sizes[:, k, j] = np.abs(self.form(eye[j], eye[k]))
        return sizes

    def form(self, *directions):
        self.calls += 1
        k = len(directions)
        out = np.zeros(self.n, dtype=np.result_type(float, *directions))
        d = np.array(directions)
        orders = np.array(list(permutations(range(k))))
        for i, series in enumerate(self.field):
            for e, c in series.items():
                if sum(e) == k:
                    where = [j for j, m in enumerate(e) for _ in range(m)]
                    out[i] += c * d[orders, where].prod(axis=1).sum()
        return out


def invert(change: list[Series], order: int) -> list[Series]:
    """T^-1 up to `order` for T(x) = x + (terms of degree >= 2)."""
    size = len(change)
    rest = [add(t, scale(variable(j, size), -1.0)) for j, t in enumerate(change)]
    inverse = [variable(j, size) for j in range(size)]
    for _ in range(order):
        inverse = [add(variable(j, size), scale(compose(rest[j], inverse, order), -1.0)) for j in range(size)]
    return inverse


def near_identity(rng, n: int, parameters: int, order: int, size: float = 0.3) -> list[Series]:
    """A random change x -> x + (degrees 2 to order, with the parameters as variables that stay)."""
    total = n + parameters
    change = []
    for j in range(total):
        t = variable(j, total)
        if j < n:
            t = add(t, {e: size * rng.normal() for e in exponents(total, 2, order)})
        change.append(t)
    return change


def conjugate(
    field: list[Series], change: list[Series], parameters: int, order: int, kind: str = "flow"
) -> list[Series]:
    """The same system in u = change(x): DT(x) f(x) (map: T(f(x))) at x = T^-1(u). `field` has no parameter rows."""
    n = len(field)
    total = n + parameters
    inverse = invert(change, order)
    rows = field + [variable(n + i, total) if kind == "map" else {} for i in range(parameters)]
    moved = []
    for i in range(n):
        if kind == "map":
            in_x = compose(change[i], rows, order)
        else:
            in_x = add(*(multiply(derivative(change[i], j), rows[j], order) for j in range(n)))
        moved.append(compose(in_x, inverse, order))
    return moved


def linear_change(field: list[Series], matrix: np.ndarray, parameters: int, order: int) -> list[Series]:
    """The same system in u = matrix x."""
    n = len(field)
    total = n + parameters
    inverse = np.linalg.inv(matrix)
    inner: list[Series] = [
        {tuple(int(i == j) for i in range(total)): inverse[k, j] for j in range(n)} for k in range(n)
    ] + [variable(n + i, total) for i in range(parameters)]
    in_u = [compose(f, inner, order) for f in field]
    return [add(*(scale(in_u[j], matrix[i, j]) for j in range(n))) for i in range(n)]


def embed(centre: list[Series], rates: list[float], parameters: int, rng, order: int) -> list[Series]:
    """Append hyperbolic directions v' = rate v + random terms that vanish at v = 0, and let v enter the centre too.

    v = 0 stays invariant, so the centre manifold's normal form is untouched.
    """
    m, s = len(centre), len(rates)
    total = m + s + parameters

    def widen(e):
        return (*e[:m], *(0,) * s, *e[m:])

    field = [{widen(e): c for e, c in f.items()} for f in centre]
    mixed = [e for e in exponents(total, 2, min(order, 3)) if any(e[m : m + s])]
    for f in field:
        f.update({e: 0.3 * rng.normal() for e in mixed})
    for k, rate in enumerate(rates):
        f = scale(variable(m + k, total), rate)
        field.append(add(f, {e: 0.3 * rng.normal() for e in mixed}))
    return field


def hide(centre, rates, rng, order, parameters=0, kind="flow", units=None):
    """A PolynomialJet with the given normal form, and the matrix T whose first columns are the centre directions."""
    field = embed(centre, rates, parameters, rng, order)
    n = len(field)
    field = conjugate(field, near_identity(rng, n, parameters, order), parameters, order, kind)
    left, right = (np.linalg.qr(rng.normal(size=(n, n)))[0] for _ in range(2))
    matrix = left * np.exp(0.5 * rng.normal(size=n)) @ right
    if units is not None:
        matrix = np.asarray(units)[:, None] * matrix
    return PolynomialJet(linear_change(field, matrix, parameters, order), parameters, kind), matrix


def rotation_field(value: complex, powers: dict[int, complex], unfolding: list[dict[int, complex]] | None = None):
    """w' = value w + sum_k powers[k] w |w|^(2k) + sum_i p_i sum_k unfolding[i][k] w |w|^(2k), in (Re w, Im w, p)."""
    unfolding = unfolding or []
    total = 2 + len(unfolding)
    x, y = variable(0, total), variable(1, total)
    square = add(multiply(x, x, 9), multiply(y, y, 9))
    real: Series = {}
    imag: Series = {}

    def include(coefficient: complex, k: int, factor: Series | None) -> None:
        nonlocal real, imag
        radial: Series = {(0,) * total: 1.0}
        for _ in range(k):
            radial = multiply(radial, square, 9)
        if factor is not None:
            radial = multiply(radial, factor, 9)
        a, b = complex(coefficient).real, complex(coefficient).imag
        real = add(real, multiply(radial, add(scale(x, a), scale(y, -b)), 9))
        imag = add(imag, multiply(radial, add(scale(x, b), scale(y, a)), 9))

    include(value, 0, None)
    for k, c in powers.items():
        include(c, k, None)
    for i, terms in enumerate(unfolding):
        for k, c in terms.items():
            include(c, k, variable(2 + i, total))
    return [real, imag]
