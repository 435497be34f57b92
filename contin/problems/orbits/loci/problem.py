"""Curves of LPC, PD and NS of periodic orbits in two parameters, as a continuation problem."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.branch import End, SpecialPoint
from contin.continuation.departure import Seed
from contin.continuation.problem import Chunk, Frame, Renewal, Sample, Verified
from contin.continuation.settings import Settings
from contin.errors import InputError
from contin.problems.orbits.layout import extrema
from contin.problems.orbits.loci import events
from contin.problems.orbits.loci.curve import Corrected, OrbitCurve
from contin.problems.orbits.loci.march import march
from contin.problems.orbits.loci.renewal import renew

SMALL = 1e-2  # relative amplitude below which an orbit is its Hopf point
PROBE_TOLERANCE = 1e-10


@dataclass(frozen=True, eq=False)
class OrbitLocusProblem:
    """See `contin.problems.orbits.loci.curve` for the unknowns and equations."""

    curve: OrbitCurve
    second_bounds: tuple[float, float] = (-np.inf, np.inf)
    first_bounds: tuple[float, float] = (-np.inf, np.inf)

    kind = "locus"
    maximum_chunk = 40  # a step takes about 1 ms

    @property
    def locus(self) -> str:
        return self.curve.type

    @property
    def system(self) -> Any:
        return self.curve.orbits.system

    @cached_property
    def parameters(self) -> tuple[str, ...]:
        names = self.system.parameter_names
        return names[self.curve.first], names[self.curve.second]

    @property
    def angle_periods(self) -> Array:
        return np.zeros(0)

    def within(self, first: tuple[float, float], second: tuple[float, float]) -> OrbitLocusProblem:
        """The same curve with ranges of both parameters."""
        return replace(self, first_bounds=first, second_bounds=second)

    @property
    def walls(self) -> Sequence[tuple[int, float, float]]:
        return [(-2, *self.second_bounds), (-1, *self.first_bounds)]

    @property
    def identifying(self) -> NDArray[np.bool_]:
        return np.ones(1, bool)

    @property
    def growing(self) -> NDArray[np.bool_]:
        return np.zeros(2, bool)

    def constants(self) -> dict[str, float]:
        return self.curve.orbits.constants()

    def default_range(self, parameter: str) -> tuple[float, float] | None:
        return self.curve.orbits.default_range(parameter)

    # -- the engine's contract ----------------------------------------------------------------------------------------

    def initial_scale(self, z: Array, bounds: tuple[float, float]) -> Array:
        widths = [hi - lo for lo, hi in (bounds, self.second_bounds)]
        first, second = (
            w if np.isfinite(w) else max(1.0, abs(float(x))) for w, x in zip(widths, (z[-1], z[-2]), strict=True)
        )
        own = self.curve.at(z).initial_scale(self.curve.orbit(z), (0.0, first))
        return self.curve.join(own, second, 1.0)

    def tangents(self, z: Array, scale: Array) -> Sequence[Array]:
        """The curve's own tangent."""
        self.curve.settle(z, scale)
        guide = np.zeros(z.size)
        guide[-1] = 1.0
        found = self.curve.correct(z, guide, 0.0, z, scale, np.inf)
        if isinstance(found, str):
            raise InputError(f"the curve of {self.locus} cannot be followed from here: its equations are singular")
        return [found.tangent]

    def measured(self, sample: Sample, frame: Frame) -> Sample:
        """The same point with its tests and tangent anew."""
        self.curve.settle(sample.z, frame.scale)
        found = self.curve.correct(sample.z, sample.tangent, 0.0, sample.z, frame.scale, np.inf)
        if isinstance(found, str):
            return sample
        self.curve.follow(found, frame.scale)
        return replace(self.sample(found), tangent=sample.tangent if sample.tests.size else found.tangent)

    def sample(self, found: Corrected) -> Sample:
        """Tests, number of unstable multipliers (critical ones not counted) and all multipliers."""
        values, further = found.multipliers, self.curve.further(found.z)
        tests, count = events.tests_of(self.locus, self.others(values, found.z), further, found.speed)
        return Sample(found.z, found.tangent, tests, count, values)

    def march(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        bounds: tuple[float, float], settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        return march(self, origin, before, length, frame, step, min(limit, self.maximum_chunk), settings)

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        tolerance = min(settings.tolerance, PROBE_TOLERANCE)
        found = self.curve.correct(base.z, base.tangent, length, guess, frame.scale, tolerance)
        return None if isinstance(found, str) else self.sample(found)

    def turned_over(self, before: Array, after: Array) -> bool:
        """True where the orbit between these has shrunk to a point: seen from its mean it lies on the other side."""
        if self.curve.orbits.winding.any():
            return False
        nodes = self.curve.profile(before).u.size
        n = self.curve.orbits.n
        a, b = (z[:nodes].reshape(-1, n) for z in (before, after))
        return float(np.sum((a - a.mean(axis=0)) * (b - b.mean(axis=0)))) < 0.0

    def multipliers(self, z: Array) -> NDArray[np.complex128]:
        return self.curve.at(z).multipliers(self.curve.orbit(z))

    def others(self, values: NDArray[np.complex128], z: Array) -> NDArray[np.complex128]:
        """The multipliers without the trivial and the critical ones."""
        left = list(values[1:] if self.curve.orbits.autonomous else values)
        for target in events.critical(self.locus, self.curve.further(z)):
            if left:
                left.pop(min(range(len(left)), key=lambda k: abs(left[k] - target)))
        return np.array(left, complex)

    def at_parameter(self, guess: Array, value: float, scale: Array) -> Array | None:
        return self.at_unknown(-1, guess, value, scale)

    def at_unknown(self, index: int, guess: Array, value: float, scale: Array) -> Array | None:
        fixed = np.zeros(guess.size)
        fixed[index] = 1.0
        z0 = guess.copy()
        z0[index] = value
        found = self.curve.correct(z0, fixed, 0.0, z0, scale, 1e-12, exact=False)
        if isinstance(found, str):
            return None
        z = found.z.copy()
        z[index] = value
        return z

    def explain(self, a: Sample, b: Sample) -> tuple[str, ...] | None:
        return events.explain(self.locus, a, b)

    def watch(self, type_: str) -> int | None:
        return events.watch(self.locus, type_)

    def verify(self, type_: str, near: Sample, frame: Frame) -> Verified | str:
        return events.verify(self, type_, near, frame)

    def verify_compound(self, a: Sample, b: Sample, frame: Frame) -> Sequence[Verified | str]:
        changed = a.tests[2:] * b.tests[2:] < 0.0
        return [self.verify(t, a, frame) for t, c in zip(events.NAMES[self.locus], changed, strict=True) if c]

    def verify_corner(self, a: Sample, b: Sample, frame: Frame) -> Verified | str | None:
        return None

    def cross_corner(self, last: Sample, frame: Frame, settings: Settings) -> tuple[Sample, Verified | None] | None:
        return None

    def reverses(self, z: Array, tangent: Array, symmetries: Sequence[str]) -> bool:
        return False

    def renew(
        self, origin: Sample, before: Sample | None, loop: Sample | None, frame: Frame, settings: Settings
    ) -> Renewal:
        profile = self.curve.profile(origin.z)
        sizes = self.curve.orbits.sizes(self.curve.orbit(origin.z), self.curve.orbit(frame.scale))
        if float(np.max(np.ptp(profile.u, axis=0) / sizes)) < SMALL and not self.curve.orbits.winding.any():
            where = ", ".join(f"{k} = {v:.8g}" for k, v in zip(self.parameters, origin.z[[-1, -2]], strict=True))
            end = End("hopf", f"the orbit shrank to a Hopf point at {where}")
            return Renewal(frame.scale, origin, before, loop, end)
        return renew(self, origin, before, frame, settings)

    def same_point(self, a: Verified, b: Verified, scale: Array) -> bool:
        near = np.abs(a.z[[-1, -2]] - b.z[[-1, -2]]) <= 1e-7 * scale[[-1, -2]]
        periods = self.curve.profile(a.z).period, self.curve.profile(b.z).period
        return bool(near.all()) and abs(periods[0] - periods[1]) < 1e-5 * periods[0]

    def columns(self, z: Array) -> dict[str, Array]:
        """Both parameters, period, and smallest and largest value over the orbit of every state and observable."""
        first, second = self.parameters
        functions = [*self.system.state_names, *self.system.observable_names]
        columns: dict[str, Array] = {first: z[:, -1].copy(), second: z[:, -2].copy(), "period": np.empty(len(z))}
        low, high = np.empty((len(z), len(functions))), np.empty((len(z), len(functions)))
        padding = np.argmax(~np.isnan(z), axis=1) if len(z) else np.empty(0, int)
        for skipped in np.unique(padding):  # rows on meshes of one size together
            chosen = np.flatnonzero(padding == skipped)
            part = z[chosen][:, skipped:]
            profile = self.curve.profile(part[0])
            nodes = profile.u.size
            columns["period"][chosen] = part[:, nodes]
            u = part[:, :nodes].reshape(len(part), -1, profile.n)
            low[chosen], high[chosen] = extrema(self._functions(u, part), profile.m)
        for k, name in enumerate(functions):
            columns[f"{name}.min"], columns[f"{name}.max"] = low[:, k], high[:, k]
        if self.locus == "NS":
            columns["cos.theta"] = z[:, -3].copy()
            columns["neutral"] = np.abs(z[:, -3]) > 1.0  # type: ignore[assignment]
        return columns

    def _functions(self, u: Array, rows: Array) -> Array:
        """States and observables at nodes u (R, K, n), (R, K, k)."""
        if not self.system.observable_names:
            return u
        count, nodes, n = u.shape
        p = np.tile(self.curve.at(rows[0]).full_parameters(rows[0]), (count * nodes, 1))
        p[:, self.curve.first] = np.repeat(rows[:, -1], nodes)
        p[:, self.curve.second] = np.repeat(rows[:, -2], nodes)
        observed = self.system.observables(np.ascontiguousarray(u.reshape(-1, n)), p)
        return np.concatenate([u, np.asarray(observed).reshape(count, nodes, -1)], axis=2)

    def remarks(self, z: Array) -> Sequence[str]:
        return ()

    def describe_failure(self, z: Array) -> str:
        return self.curve.at(z).describe_failure(self.curve.orbit(z))

    # -- leaving the curve --------------------------------------------------------------------------------------------

    def departures(self, point: SpecialPoint, parameter: str, orbits: bool) -> list[Seed]:
        return []

    def switch(self, point: SpecialPoint, parameter: str) -> list[Seed]:
        """The family of orbits through the point, in one parameter."""
        names = list(self.system.parameter_names)
        if parameter not in names:
            raise InputError(f"no parameter {parameter!r}; the model has {', '.join(names)}")
        orbits = self.curve.at(point.z)
        orbit = self.curve.orbit(point.z)
        if parameter != self.parameters[0]:
            orbits = orbits.with_active(parameter, orbit)
            orbit[-1] = orbits.base[orbits.active]
        return [Seed(orbits, orbit)]

    def loci(self, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
        raise InputError(
            f"{point.branch}.{point.label}: curves through {point.type} are not started from here; start them from an "
            "LPC, PD or NS of a family of orbits"
        )
