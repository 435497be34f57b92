"""Cycles of maps as a continuation problem in all their points at once.

Unknowns are (x_1, ..., x_k, p) with f(x_1) = x_2, ..., f(x_k) = x_1. The k-th iterate has the same solutions in far
fewer unknowns, but it is so strongly curved for long cycles that Newton jumps from one of them to another; here every
equation is as tame as the map. Special points and normal forms are those of the iterate at x_1, where multipliers are
of order one, and are carried to the other points.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import cast, overload

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array, Vector
from contin.continuation import march as python_march
from contin.continuation.branch import SpecialPoint
from contin.continuation.location.halting import HALF_PERIOD
from contin.continuation.outcome import Corner, Jump, Outcome, Rejected, Verified
from contin.continuation.problem import Renewal
from contin.continuation.sample import Chunk, Frame, Sample
from contin.continuation.seed import Seed
from contin.continuation.settings import Settings
from contin.errors import NotFiniteError
from contin.kernels.floquet import multipliers as multipliers_of
from contin.linalg.spectrum import count_and_tests, in_order, spectrum
from contin.machine import elementary
from contin.problems.at_fixed_parameter import at_parameter
from contin.problems.dense_march import DenseMarch
from contin.problems.equilibria import special_points
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.problems.equilibria.fixed_points import OfFixedPoints
from contin.problems.maps import borders, unrolled
from contin.special.table import test_on_branch
from contin.systems.iterate import IteratedSystem

SINGULAR = 1e-9
LONGEST = 64  # period to which the explorer follows a cascade of doublings
SAME = 1e-6
NEUTRAL = 1e-11  # distance of a multiplier from 1 that corrections to the rows leave: it is 1
STANDING = 1e-9  # slope dp/ds (scaled) at rows of a continuum, zero but for those


@dataclass(frozen=True, eq=False)
class CycleMarch(DenseMarch):
    """The march with the multipliers of the cycle."""

    problem: CycleProblem

    def stability(self, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        values = self.problem.multipliers(z)
        _, tests = count_and_tests(values, True)
        count, _ = count_and_tests(values[~_neutral(values)], True)
        return tests[2:], count, values


@dataclass(frozen=True, eq=False)
class CycleProblem(OfFixedPoints):
    """Cycles of period k of a map; `inner` is the problem of fixed points of its k-th iterate."""

    kind = "fixed-point"
    maximum_chunk = 25

    @property
    def system(self) -> IteratedSystem:
        assert isinstance(self.inner.system, IteratedSystem)
        return self.inner.system

    @property
    def period(self) -> int:
        return self.system.times

    @cached_property
    def angle_periods(self) -> Array:
        return np.tile(self.inner.angle_periods, self.period)

    # between the cycle and its first point ----------------------------------------------------------------------------

    def lift(self, z: Array) -> Array:
        """All points (x_1, ..., x_k, p) of the cycle through (x_1, p)."""
        return np.concatenate([*self.system.orbit(z[:-1], self.inner.full_parameters(z)), z[-1:]])

    def first(self, z: Array) -> Array:
        """(x_1, p)."""
        return np.append(z[: self.n], z[-1])

    def shifted(self, z: Array, steps: int) -> Array:
        """The same cycle (or a tangent of it) from another of its points."""
        return np.append(np.roll(z[:-1], -steps * self.n), z[-1])

    def _inner_frame(self, frame: Frame) -> Frame:
        scale = self.first(frame.scale)
        scale[:-1] /= np.sqrt(self.period)
        return Frame(scale, frame.reference)

    def _inner_sample(self, sample: Sample) -> Sample:
        return replace(sample, z=self.first(sample.z), tangent=self.first(sample.tangent))

    @overload
    def _lifted(self, found: Verified) -> Verified: ...
    @overload
    def _lifted(self, found: Outcome) -> Outcome: ...
    def _lifted(self, found: Outcome) -> Outcome:
        if not isinstance(found, Verified):
            return found
        z = self.lift(found.z)
        return replace(found, z=z, eigenvalues=self.multipliers(z))

    # evaluation -------------------------------------------------------------------------------------------------------

    def linearise(self, z: Array) -> tuple[Array, Array]:
        """F (k n,) = (f(x_k) - x_1, f(x_1) - x_2, ...) and its Jacobian (k n, k n + 1), unscaled."""
        n, k = self.n, self.period
        p = self.inner.full_parameters(z)
        points = z[:-1].reshape(k, n)
        values, matrices = self.system.base.jacobians(points, np.broadcast_to(p, (k, len(p))))
        here = np.arange(k)
        row = (here + 1) % k
        f, blocks, slopes = np.empty((k, n)), np.zeros((k, n, k, n)), np.empty((k, n))
        f[row], slopes[row] = values - points[row], matrices[:, :, n + self.active]
        blocks[row, :, here] = matrices[:, :, :n]
        jacobian = np.column_stack([blocks.reshape(k * n, k * n), slopes.ravel()])
        jacobian[np.arange(k * n), np.arange(k * n)] -= 1.0
        return f.ravel(), jacobian

    def linear_part(self, z: Array) -> Array:
        """The product of the map's Jacobians around the cycle, whose eigenvalues are the multipliers."""
        p = self.inner.full_parameters(z)
        points = z[:-1].reshape(self.period, self.n)
        product = np.eye(self.n)
        for matrix in self.system.base.jacobians(points, np.broadcast_to(p, (len(points), len(p))))[1]:
            product = matrix[:, : self.n] @ product
        return product

    def multipliers(self, z: Array) -> NDArray[np.complex128]:
        """Eigenvalues of that product without forming it: in a chaotic map's cycles some are 1e10 and others 1e-40.

        The product has rounding errors of the large ones, and with them the small ones change sign from row to row.
        """
        points = z[:-1].reshape(self.period, self.n)
        others = np.broadcast_to(self.inner.full_parameters(z), (self.period, self.inner.system.m))
        slopes = self.system.base.jacobians(points, others)[1][:, :, : self.n]
        if np.isfinite(slopes).all():
            sizes = np.abs(points).max(axis=0)
            sizes = np.maximum(sizes, 1e-6 * (float(sizes.max()) or 1.0))
            basis, re, im = np.full((self.n, self.n), np.nan), np.full(self.n, np.nan), np.full(self.n, np.nan)
            if multipliers_of(np.ascontiguousarray(slopes * sizes / sizes[:, None]), 0, basis, re, im):
                return in_order(re + 1j * im)
        return spectrum(self.linear_part(z))[0]

    # the engine's contract --------------------------------------------------------------------------------------------

    def initial_scale(self, z: Array, bounds: tuple[float, float]) -> Array:
        scale = self.inner.initial_scale(self.first(z), bounds)
        sizes = scale[:-1] / np.sqrt(self.n)
        largest = np.abs(z[:-1].reshape(self.period, self.n)).max(axis=0)
        sizes = np.where(self.inner.angle_periods > 0.0, sizes, np.maximum(sizes, largest))
        return np.append(np.sqrt(self.n * self.period) * np.tile(sizes, self.period), scale[-1])

    def tangents(self, z: Array, scale: Array) -> Sequence[Array]:
        _, jacobian = self.linearise(z)
        if not np.all(np.isfinite(jacobian)):
            raise NotFiniteError(f"no branch passes here: {self.describe_failure(z)}")
        _, singular, right = np.linalg.svd(jacobian * scale / scale[:-1, None])
        if singular[-1] > SINGULAR * singular[0]:
            return [right[-1]]
        inner = self._inner_frame(Frame(scale)).scale
        crossing = self.inner.tangents(self.first(z), inner)
        lifted = [carried(self, self.first(z), t * inner)[0] / scale for t in crossing]
        return [t / np.linalg.norm(t) for t in lifted]

    def march(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        bounds: tuple[float, float], settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        march = CycleMarch(self)
        chunk = python_march.march(march, origin, before, length, frame, step, limit, bounds, settings, loop)
        return borders.cut_at_border(self, chunk)

    def separated(self, a: Array, b: Array) -> bool:
        """True where a point of the cycle comes across a surface on which the map jumps."""
        return borders.crosses(self, a, b)

    def foretold(self, origin: Sample, before: Sample | None, frame: Frame) -> Renewal | None:
        """The end at a surface on which the map jumps."""
        return borders.foretold(self, origin, frame)

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        return python_march.probe(CycleMarch(self), base, length, guess, frame, settings)

    def at_parameter(self, guess: Array, value: float, scale: Array) -> Array | None:
        return at_parameter(self, guess, value, scale)

    def explain(self, a: Sample, b: Sample) -> tuple[str, ...] | None:
        if _in_continuum(a, b):
            a, b = (replace(s, tests=np.concatenate([[1.0, 1.0], s.tests[2:]])) for s in (a, b))
        return special_points.explain(True, a, b)

    def test_of(self, type_: str) -> int | None:
        return test_on_branch(type_)

    def verify(self, type_: str, near: Sample, frame: Frame) -> Outcome:
        found: Outcome
        try:
            found = self._lifted(self.inner.verify(type_, self._inner_sample(near), self._inner_frame(frame)))
        except np.linalg.LinAlgError:  # a point from which the iterates escape
            found = Rejected("the iterates beside this point are not finite", suspect=True)
        return unrolled.sharper(self, found, type_, near, frame)

    def with_iterates_form(self, point: Verified, frame: Frame) -> Outcome:
        """A point in all points of the cycle, with the normal form of the iterate."""
        found = self.inner.described(replace(point, z=self.first(point.z)), self._inner_frame(frame))
        return replace(found, z=point.z, eigenvalues=point.eigenvalues) if isinstance(found, Verified) else found

    def verify_compound(self, a: Sample, b: Sample, frame: Frame) -> Sequence[Outcome]:
        sides = self._inner_sample(a), self._inner_sample(b)
        return [self._lifted(item) for item in self.inner.verify_compound(*sides, self._inner_frame(frame))]

    def verify_corner(self, a: Sample, b: Sample, frame: Frame) -> Outcome | Jump | None:
        sides = self._inner_sample(a), self._inner_sample(b)
        found = self.inner.verify_corner(*sides, self._inner_frame(frame))
        return found if found is None or isinstance(found, Jump) else self._lifted(found)

    def cross_corner(
        self, last: Sample, frame: Frame, settings: Settings
    ) -> tuple[Sample, Verified | Corner | Jump | None] | None:
        inner = self._inner_frame(frame)
        crossed = self.inner.cross_corner(self._inner_sample(last), inner, settings)
        if crossed is None:
            return None
        beyond, point = crossed
        z, tangent = self.lift(beyond.z), carried(self, beyond.z, beyond.tangent * inner.scale)[0] / frame.scale
        base = replace(last, z=z, tangent=tangent / np.linalg.norm(tangent))
        sample = self.probe(base, 0.0, z, frame, settings)
        if sample is None or self.separated(last.z, sample.z):
            return None
        return (sample, self._lifted(point) if isinstance(point, Verified) else point)

    def reverses(self, z: Array, tangent: Array, scale: Array, symmetries: Sequence[str]) -> bool:
        if HALF_PERIOD in symmetries and self._halves(z, tangent):
            return True
        return self.inner.reverses(self.first(z), self.first(tangent), self.first(scale), symmetries)

    def _halves(self, z: Array, tangent: Array) -> bool:
        """True where the second half of the cycle repeats the first and `tangent` drives them apart."""
        half = self.n * self.period // 2
        gap = z[:half] - z[half:-1]
        periods = self.angle_periods[:half]
        gap[periods > 0] -= (periods * np.round(gap / np.where(periods > 0, periods, 1.0)))[periods > 0]
        size = float(np.abs(z[:-1]).max(initial=1e-300))
        speed = float(np.abs(tangent[:-1]).max(initial=1e-300))
        same = float(np.abs(gap).max()) <= SAME * size
        return same and float(np.abs(tangent[:half] + tangent[half:-1]).max()) <= 1e-3 * speed

    def columns(self, z: Array) -> dict[str, Array]:
        """Those of the first point, `x`; then of each state all iterates `x.1 ... x.k`, and `x.min`, `x.max`."""
        columns = self.inner.columns(np.column_stack([z[:, : self.n], z[:, -1]]))
        points = z[:, :-1].reshape(len(z), self.period, self.n)
        for i, name in enumerate(self.system.state_names):
            columns.update({f"{name}.{j + 1}": points[:, j, i] for j in range(self.period)})
            columns[f"{name}.min"], columns[f"{name}.max"] = points[:, :, i].min(axis=1), points[:, :, i].max(axis=1)
        return columns

    def at_first(self, point: SpecialPoint) -> SpecialPoint:
        """The point as a fixed point of the iterate."""
        scale = self._inner_frame(Frame(point.scale)).scale if point.scale.size else point.scale
        vectors = dict(point.vectors)
        if "beside" in vectors:  # a place on the branch, which is a cycle
            vectors["beside"] = self.first(vectors["beside"])
        first, tangent = self.first(point.z), self.first(point.tangent)
        return replace(point, z=first, tangent=tangent, scale=scale, vectors=vectors)

    def explain_columns(self, z: Array) -> str | None:
        """The first observable that is not finite at z, and why."""
        return self.inner.explain_columns(self.first(z))

    def describe_failure(self, z: Array) -> str:
        return self.inner.describe_failure(self.first(z))


def _neutral(values: NDArray[np.complex128]) -> NDArray[np.bool_]:
    return np.abs(values - 1.0) < NEUTRAL


def _in_continuum(a: Sample, b: Sample) -> bool:
    """True for two of the cycles that a (piecewise) linear map has at one parameter, where one of them doubles.

    Neither the parameter nor the multiplier 1 moves between them: the signs of their tests are those of rounding.
    """
    return all(abs(float(s.tangent[-1])) < STANDING and bool(_neutral(s.eigenvalues).any()) for s in (a, b))


def carried(problem: CycleProblem, z: Array, *path: Array) -> list[Array]:
    """Derivatives of all points of a cycle along a path z(s) of its first point and the parameter.

    path = (z',) or (z', z''), each (n + 1,), at z = z(0); returns as many vectors (k n + 1,), by the chain rule
    x_(j+1)' = Df[z_j'], x_(j+1)'' = D^2f[z_j', z_j''] + Df[z_j''] with z_j = (x_j, p).
    """
    base, p, n = problem.system.base, problem.inner.full_parameters(z), problem.n
    x = z[:-1]
    current: list[Vector] = []
    for v in path:
        wide = np.zeros(n + base.m)
        wide[:n], wide[n + problem.active] = v[:-1], v[-1]
        current.append(wide)
    found: list[list[Array]] = [[] for _ in path]
    for _ in range(problem.period):
        for store, v in zip(found, current, strict=True):
            store.append(v[:n].copy())
        x_next, matrix = base.jacobian(x, p)
        second = matrix @ current[1] + base.derivative(x, p, current[0], current[0]) if len(path) > 1 else None
        current[0][:n] = matrix @ current[0]
        if second is not None:
            current[1][:n] = second
        x = x_next
    return [np.append(np.concatenate(store), v[-1]) for store, v in zip(found, path, strict=True)]


def lifted(seed: Seed, symmetries: tuple[str, ...] | None = None) -> Seed:
    """A seed of the iterate's fixed points as one of cycles."""
    assert seed.direction is not None
    assert seed.curvature is not None
    assert seed.scale is not None
    inner = cast("EquilibriumProblem", seed.problem)
    problem = CycleProblem(inner)
    raw = carried(problem, seed.z, seed.direction * seed.scale, seed.curvature * seed.scale)
    sizes = np.sqrt(problem.period) * np.tile(seed.scale[:-1], problem.period)
    scale = np.append(sizes, seed.scale[-1])
    d, c = raw[0] / scale, raw[1] / scale
    norm = float(np.linalg.norm(d))
    d, c = d / norm, c / elementary.square(norm)
    return replace(
        seed, problem=problem, z=problem.lift(seed.z), direction=d, curvature=c - float(c @ d) * d, scale=scale,
        symmetries=seed.symmetries if symmetries is None else symmetries,
        beside={arm: problem.lift(at) for arm, at in seed.beside.items()},
    )  # fmt: skip
