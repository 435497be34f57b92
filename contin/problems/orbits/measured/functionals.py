"""Numbers of an orbit and their derivatives: integrals, largest and smallest values, values at the start, the period.

An integral over the orbit is a quadrature with the nodes of every interval (Gauss and Lobatto, of degree 2 m - 1); a
largest value is that of the piecewise polynomial, with the derivative of the formula where it is taken.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from contin.abi import Array
from contin.kernels.collocation_basis import interpolation
from contin.model.expression import Expression, number, power
from contin.model.model import Model
from contin.model.parts import Functional
from contin.model.relations import PERIOD, Relation
from contin.problems.orbits.mesh.layout import Profile
from contin.problems.orbits.mesh.peaks import may_hold_largest
from contin.problems.quantities import Quantities, evaluated
from contin.symbolic.calculus.derivatives import sparse_jacobian

SAMPLES: Final = 33  # of an interval, in which the largest value is looked for
SHARP: Final = 1e-9  # part of an interval to which its place is found


@dataclass(frozen=True, eq=False)
class Slopes:
    """Derivatives of one number by the node values (K, n), the period, and all parameters with the time (p_size,)."""

    u: Array
    period: float
    p: Array


@dataclass(frozen=True, eq=False)
class OrbitConditions:
    """Conditions c = 0 on orbits of a model."""

    model: Model
    relations: tuple[Relation, ...]

    @cached_property
    def functionals(self) -> dict[str, Functional]:
        return {name: f for relation in self.relations for name, f in relation.functionals.items()}

    @cached_property
    def _inner(self) -> Quantities:
        """What stands in the functionals; of a norm the square."""
        two = number(2)
        kinds = self.functionals.values()
        return Quantities(self.model, tuple(power(f.inner, two) if f.kind == "norm" else f.inner for f in kinds))

    @cached_property
    def _names(self) -> list[str]:
        return [*self.functionals, PERIOD, *self.model.parameter_names]

    @cached_property
    def _slopes(self) -> dict[tuple[int, int], Expression]:
        return sparse_jacobian([r.residual for r in self.relations], self._names)

    def values(self, profile: Profile, p: Array) -> Array:
        """c (k,); p (p_size,) as at the time 0."""
        return evaluated([r.residual for r in self.relations], self.numbers(profile, p))

    def numbers(self, profile: Profile, p: Array) -> dict[str, float]:
        """The functionals, the period and the parameters by name."""
        found = self._measured(profile, p, slopes=False)
        known = dict(zip(self.model.parameter_names, p.tolist(), strict=False))
        return {name: value for name, (value, _) in found.items()} | {PERIOD: profile.period} | known

    def linearise(self, profile: Profile, p: Array) -> tuple[Array, list[Slopes]]:
        """c (k,) and its derivatives."""
        found = self._measured(profile, p, slopes=True)
        known = dict(zip(self.model.parameter_names, p.tolist(), strict=False))
        values = {name: value for name, (value, _) in found.items()} | {PERIOD: profile.period} | known
        slopes = [Slopes(np.zeros_like(profile.u), 0.0, np.zeros(p.size)) for _ in self.relations]
        weights = evaluated(list(self._slopes.values()), values)
        count = len(self.functionals)
        for (k, j), weight in zip(self._slopes, weights, strict=True):
            total = slopes[k]
            if j < count:
                one = found[self._names[j]][1]
                total = Slopes(total.u + weight * one.u, total.period + weight * one.period, total.p + weight * one.p)
            elif j == count:
                total = Slopes(total.u, total.period + weight, total.p)
            else:
                total.p[j - count - 1] += weight
            slopes[k] = total
        return evaluated([r.residual for r in self.relations], values), slopes

    def _measured(self, profile: Profile, p: Array, slopes: bool) -> dict[str, tuple[float, Slopes]]:
        if not self.functionals:
            return {}
        rows = np.tile(p, (len(profile.u), 1))
        if self.model.forcing is not None:
            rows[:, -1] = profile.period * profile.times
        table = self._inner.along(profile.u, rows)
        integrals = any(f.kind in ("integral", "mean", "norm") for f in self.functionals.values())
        derivatives = None
        if slopes and integrals:
            derivatives = np.array([self._inner.at(u, row)[1] for u, row in zip(profile.u, rows, strict=True)])
        return {
            name: self._one(f.kind, k, profile, rows, table[:, k], derivatives)
            for k, (name, f) in enumerate(self.functionals.items())
        }

    def _one(
        self, kind: str, k: int, profile: Profile, rows: Array, values: Array, derivatives: Array | None
    ) -> tuple[float, Slopes]:
        n, size = profile.n, rows.shape[1]
        empty = Slopes(np.zeros_like(profile.u), 0.0, np.zeros(size))
        if kind in ("start", "end"):
            node = 0 if kind == "start" else -1
            by = self._inner.at(profile.u[node], rows[node])[1][k]
            empty.u[node] = by[:n]
            return float(values[node]), Slopes(empty.u, 0.0, by[n:].copy())
        if kind in ("max", "min"):
            return self._extreme(1.0 if kind == "max" else -1.0, k, profile, rows, values)
        weights = profile.weights
        mean = float(weights @ values)
        value = {"integral": profile.period * mean, "mean": mean, "norm": float(np.sqrt(max(mean, 0.0)))}[kind]
        if derivatives is None:
            return value, empty
        by_mean = Slopes(weights[:, None] * derivatives[:, k, :n], 0.0, weights @ derivatives[:, k, n:])
        if self.model.forcing is not None:  # the time at a node grows with the period
            by_mean = Slopes(by_mean.u, float(weights @ (derivatives[:, k, -1] * profile.times)), by_mean.p)
        factor = {"integral": profile.period, "mean": 1.0, "norm": 0.5 / value if value > 0.0 else 0.0}[kind]
        by_period = factor * by_mean.period + (mean if kind == "integral" else 0.0)
        return value, Slopes(factor * by_mean.u, by_period, factor * by_mean.p)

    def _extreme(self, sign: float, k: int, profile: Profile, rows: Array, values: Array) -> tuple[float, Slopes]:
        """The largest value of sign times a formula, by the intervals that can hold it."""
        m, n, count = profile.m, profile.n, profile.intervals
        pieces = sign * values[(np.arange(count) * m)[:, None] + np.arange(m + 1)]
        around = np.flatnonzero(may_hold_largest(pieces[None])[0]).tolist()
        starts = np.concatenate([[0.0], np.cumsum(profile.h)])

        def at(interval: int, x: Array) -> tuple[Array, Array, Array]:
            """States, parameters with the time, and interpolation weights at points of an interval."""
            weights = interpolation(m, x)
            times = np.tile(rows[0], (len(x), 1))
            if self.model.forcing is not None:
                times[:, -1] = profile.period * (starts[interval] + x * profile.h[interval])
            return weights @ profile.u[interval * m : interval * m + m + 1], times, weights

        best = (-np.inf, 0, 0.0)
        for interval in around:
            low, high = 0.0, 1.0
            while high - low > SHARP:
                x = np.linspace(low, high, SAMPLES)
                u, times, _ = at(interval, x)
                sampled = sign * self._inner.along(u, times)[:, k]
                j = int(np.argmax(sampled))
                best = max(best, (float(sampled[j]), interval, float(x[j])))
                low, high = float(x[max(j - 1, 0)]), float(x[min(j + 1, SAMPLES - 1)])
        found, interval, place = best
        u, row, weights = (a[0] for a in at(interval, np.array([place])))
        by = self._inner.at(u, row)[1][k]
        by_u = np.zeros_like(profile.u)
        by_u[interval * m : interval * m + m + 1] = weights[:, None] * by[:n]
        by_p = by[n:].copy()
        by_period = 0.0
        if self.model.forcing is not None:
            by_period = float(by[-1]) * float(starts[interval] + place * profile.h[interval])
            by_p[-1] = 0.0
        return sign * found, Slopes(by_u, by_period, by_p)
