"""Connecting orbits to and from cycles as a continuation problem: a boundary-value problem with columns of its own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from contin.abi import Array
from contin.bvp.boundary_problem import BoundaryProblem
from contin.bvp.functionals import columns_of
from contin.continuation import march as python_march
from contin.continuation.outcome import Outcome
from contin.continuation.problem import Problem
from contin.continuation.sample import Chunk, Frame, Sample
from contin.continuation.seed import Seed
from contin.continuation.settings import Settings
from contin.homoclinic.bent_manifolds import bends
from contin.homoclinic.ends_of_connection import EndsOfConnection
from contin.homoclinic.hyperbolic_ends import beyond
from contin.homoclinic.parts_of_vectors import with_parts
from contin.linalg.newton import Rules, by_steps
from contin.linalg.vectors import norm
from contin.machine import elementary
from contin.problems.orbits.mesh.finer import on_half_lengths
from contin.problems.orbits.mesh.layout import Profile
from contin.problems.two_parameters import OnAdaptiveMesh
from contin.symbolic.passes.connecting import MISS

UNBOUNDED = (-np.inf, np.inf)
NEWTON = Rules(settled=1e-11, stalled=1e-7, budget=15)
CHUNK = 5  # a step takes some 50 ms
POINTS = 6  # Gauss points an interval: orbits of many turns, whose errors grow on the way, want a high order


@dataclass(frozen=True, eq=False)
class Isolated(BoundaryProblem):
    """Through a solution one branch passes, whose tangent the condensed equations give: no crossings are looked for."""

    def configured(self, seed: Seed, settings: Settings) -> Seed:
        """On the mesh that is asked for; the settings' default number of Gauss points is not."""
        own = self.points if settings.points == Settings().points else settings.points
        return super().configured(seed, replace(settings, points=own))

    def tangents(self, z: Array, scale: Array) -> Sequence[Array]:
        row = np.zeros(z.size)
        row[-1] = 1.0
        here = self.linearisation(z, row, scale)
        if here is None or here.sign == 0.0:
            return super().tangents(z, scale)
        t = here.solve(np.append(np.zeros(z.size - 1), 1.0))
        size = norm(t)
        return [t / size] if np.isfinite(size) else super().tangents(z, scale)

    def natural_sizes(self, z: Array, profile: Profile, width: float) -> Array:
        """No part of a mode, an eigenvector or an equilibrium is smaller than a part of the whole, or of the state.

        Some vanish (of driven flows, in invariant planes), to rounding, which says nothing of their size.
        """
        sizes = super().natural_sizes(z, profile, width)
        return with_parts(sizes, np.abs(profile.u).max(axis=0), self.two.names)


@dataclass(frozen=True, eq=False)
class Homotopy(Isolated):
    """On the way to a connecting orbit: no special points are looked for."""

    def explain(self, a: Sample, b: Sample) -> tuple[str, ...] | None:
        return ()

    def verify_compound(self, a: Sample, b: Sample, frame: Frame) -> Sequence[Outcome]:
        return ()


@dataclass(frozen=True, eq=False)
class ConnectionToCycle(Isolated, EndsOfConnection):
    """One parameter varies."""

    kind = "connection"
    maximum_chunk = CHUNK

    @property
    def has_stability(self) -> bool:
        return False

    @property
    def free_names(self) -> tuple[str, ...]:
        """None of the user's, beside those that `parameters` names."""
        return ()

    def constants(self) -> dict[str, float]:
        known = super().constants()
        return {name: known[name] for name in self.model.parameter_names if name in known}

    def default_range(self, parameter: str) -> tuple[float, float] | None:
        return self.model.parameter_range(parameter, {**self.model.default_parameters({}), **self.constants()})

    def orbit_at(self, z: Array) -> Profile:
        """The connecting orbit alone, with its time."""
        whole, n = self.profile(z), len(self.model.state_names)
        return replace(whole, u=whole.u[:, :n].copy(), period=self.time(z))

    def refined(self, sample: Sample, frame: Frame) -> tuple[Problem, Sample, Frame] | None:
        """On a mesh of half the lengths, the ends on their manifolds to second order (see `bends`)."""
        own = self.bent(sample.z)
        found = on_half_lengths(own, sample, frame)
        return None if found is None else (own, *found)

    def bent(self, z: Array) -> Self:
        """The equations whose ends lie on the manifolds to second order, as far as the orbit z tells of these.

        One end's bend is turned round where what both move the parameters by would cancel: it is for errors.
        """
        first, last = ({k: v for k, v in bends(self, z).items() if k.endswith(end)} for end in (":1", ":2"))
        moved = [self._moved_by(self._missing(parts), z) for parts in (first, last)]
        if moved[0] * moved[1] < 0.0:
            last = {name: -value for name, value in last.items()}
        return self._missing({**first, **last})

    def _missing(self, parts: Mapping[str, float]) -> Self:
        """The equations whose ends miss the linear spaces by these parts."""
        base = self.base.copy()
        for name, value in {MISS: 1.0, **parts}.items():
            base[self.two.parameters.index(name)] = value
        return replace(self, base=base, spaces={})

    def _moved_by(self, other: Self, z: Array) -> float:
        """Of the parameters, to first order: across their curve where there are two; 0 where it does not tell."""
        ones = np.ones_like(z)
        t = self.tangents(z, ones)[0]
        here, there = self.linearisation(z, t, ones), other.linearisation(z, t, ones)
        if here is None or there is None or here.sign == 0.0:
            return 0.0
        return self.across(here.solve(np.append(here.residual - there.residual, 0.0)), t)

    def across(self, move: Array, _: Array) -> float:
        """Of a move, the part that matters for the parameters, with its sign; the tangent."""
        return float(move[-1])

    def left_reach(self, z: Array) -> tuple[int, str] | None:
        for k, row in enumerate(z):
            text = beyond(self, row[~np.isnan(row)])
            if text is not None:
                return k, text
        return None

    def time(self, z: Array) -> float:
        """Of the connecting orbit between its ends."""
        p = dict(zip(self.two.parameters, self.full_parameters(z)[:-1].tolist(), strict=True))
        period = self.two.free.index(f"period:{self.cycles[0]}")
        return float(p["T:"]) * float(z[self.two.n_states + period])

    def columns(self, z: Array) -> dict[str, Array]:
        """Parameters, smallest and largest values of the states on the connecting orbit and the cycle(s), periods."""
        found, names = columns_of(self, z), self.model.state_names
        columns = {name: found[name] for name in self.parameters}
        for name in names:
            columns |= {f"{name}.{end}": found[f"{name}.{end}"] for end in ("min", "max")}
        for place in (1, 2):
            mark = "" if place == 1 else "2"
            if place not in self.cycles:
                columns |= {f"{name}.saddle{mark}": found[f"{name}:saddle{place}"] for name in names}
                continue
            mark = "" if len(self.cycles) == 1 else mark
            columns[f"period{mark}"] = found[f"period:{place}"]
            for name in names:
                columns |= {f"{name}.cycle{mark}.{end}": found[f"{name}:cycle{place}.{end}"] for end in ("min", "max")}
            k = 0
            while f"sigma{k}:{place}" in found:
                columns[f"multiplier{mark}{f'.{k + 1}' if k else ''}"] = elementary.exp(found[f"sigma{k}:{place}"])
                k += 1
        return columns

    def column_names(self) -> tuple[str, ...]:
        return (*self.parameters, *(f"{name}.{end}" for name in self.model.state_names for end in ("min", "max")))

    def describe_failure(self, z: Array) -> str:
        return "The connecting orbit, or its cycle, is not resolved any more. " + super().describe_failure(z)


@dataclass(frozen=True, eq=False)
class CurveOfConnections(OnAdaptiveMesh, ConnectionToCycle):
    """The second parameter is solved for, within bounds of its own."""

    second: str = ""
    kind = "locus"
    locus = "HOM"  # type: ignore[assignment]
    first_bounds: tuple[float, float] = UNBOUNDED
    second_bounds: tuple[float, float] = UNBOUNDED

    @cached_property
    def parameters(self) -> tuple[str, ...]:
        return (self.two.parameters[self.active], self.second)

    @property
    def place(self) -> int:
        """Of the second parameter in z: a constant function, whose first value stands for it."""
        return self.two.n_states + self.two.free.index(self.second)

    def across(self, move: Array, tangent: Array) -> float:
        return float(move[-1] * tangent[self.place] - move[self.place] * tangent[-1])

    def within(self, first: tuple[float, float], second: tuple[float, float]) -> CurveOfConnections:
        return replace(self, first_bounds=first, second_bounds=second)

    @property
    def walls(self) -> Sequence[tuple[int, float, float]]:
        return [(self.place, *self.second_bounds), (-1, *self.first_bounds)]

    def at_unknown(self, index: int, guess: Array, value: float, scale: Array) -> Array | None:
        """Solved with one of both parameters fixed."""
        if index % guess.size == guess.size - 1:
            return self.at_parameter(guess, value, scale)
        z = guess.copy()
        profile = self.profile(z)
        z[: profile.u.size].reshape(profile.u.shape)[:, index] = value
        row = np.zeros(z.size)
        row[index] = 1.0

        def step(z: Array) -> Array | None:
            here = self.linearisation(z, row, scale)
            return None if here is None or here.sign == 0.0 else here.solve(np.append(-here.residual, 0.0))

        found = by_steps(step, z, scale, NEWTON)
        return None if found is None else found.at

    def explain(self, a: Sample, b: Sample) -> tuple[str, ...] | None:
        """Turns of the curve in the plane of the parameters are no special points."""
        return ()

    def verify_compound(self, a: Sample, b: Sample, frame: Frame) -> Sequence[Outcome]:
        return ()

    def march(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        bounds: tuple[float, float], settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        still = replace(self, angle_periods=np.zeros(origin.z.size - 1))
        limit = min(limit, CHUNK)
        return python_march.march(
            still, origin, before, length, frame, step, limit, bounds, settings, loop, walled=self
        )
