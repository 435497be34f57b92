"""From a homoclinic orbit to one that makes several turns: homoclinic branch switching by Lin's method.

Copies of the orbit are cut at the section farthest from the saddle. With the parameter that closes the last gap, the
times between the passages become shorter, one after the other, until the other gaps change sign; a gap that is zero
stays so, at the price of its time. (Oldeman, Champneys and Krauskopf 2003.)
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.seed import Seed
from contin.errors import ContinError, InputError, NoSolutionError
from contin.homoclinic.from_table import laid
from contin.homoclinic.interval import arc_of
from contin.homoclinic.lins_method import Arcs, Section
from contin.homoclinic.saddle_connections import ConnectionProblem
from contin.homoclinic.solved_connection import solved_connection
from contin.lowering.system import CompiledSystem
from contin.problems.orbits.mesh.layout import Profile

STEPS: Final = 400  # of a time between passages
STEP: Final = 0.2  # of them, in times of the saddle's slowest rate
DISTINCT: Final = 1e-4  # of the states' sizes: gaps that have been larger are told from errors of the interval's ends
NO_ZERO: Final = "step 1 of Lin's method (shorter times between turns): no gap changes sign"
MOST: Final = 4  # zeros of a gap that are tried
SAMPLES: Final = 20_001  # of an orbit whose turns are counted
BESIDE: Final = 0.3  # of the distance from saddle to section, within which an orbit passes its point
SHORTEST: Final = 0.2  # of the first time between passages


@dataclass(frozen=True, eq=False)
class Pulses:
    """Orbits of `count` turns near the homoclinic orbit `z` of a curve."""

    problem: ConnectionProblem
    z: Array
    count: int
    where: str

    @property
    def system(self) -> CompiledSystem:
        return self.problem.curve.orbits.system

    @property
    def saddles(self) -> Array:
        """Twice the same, (2, n)."""
        return np.tile(self.problem.curve.equilibria(self.z)[0], (2, 1))

    def seed(self, parameter: str) -> Seed:
        raise InputError(f"{self.where}: homoclinic orbits of several turns lie on curves: name two parameters")

    def locus(self, parameters: tuple[str, str]) -> list[Seed]:
        """The curve of these orbits, at the present value of the second parameter."""
        own = self.problem.parameters
        if set(parameters) != set(own):
            raise InputError(f"{self.where}: orbits of {self.count} turns are followed in {own[0]} and {own[1]}")
        failures = []
        start = self._start()
        shift = int(abs(start.gaps[0]) <= abs(start.gaps[-1]))
        for arcs in self._closed(start, 0, shift):
            try:
                return [self._joined(arcs)]
            except ContinError as error:
                failures.append(f"step {self.count} of Lin's method (all arcs as one orbit): {error}")
        told = failures[0] if failures else NO_ZERO
        raise NoSolutionError(f"{self.where}: no homoclinic orbit of {self.count} turns was found: {told}")

    # -- the copies ----------------------------------------------------------------------------------------------------

    def _start(self) -> Arcs:
        """Copies of the orbit, cut at the section, on meshes that fit."""
        curve, z = self.problem.curve, self.z
        profile, saddle = curve.orbit_of(z), curve.equilibria(z)[0]
        sizes = curve.orbits.state_sizes(profile)
        far = int(np.argmax(np.linalg.norm((profile.u - saddle) / sizes, axis=1)))
        cut = float(profile.times[far])
        point = profile.at(np.array([cut]))[0]
        p = curve.full_parameters(z)
        rate = np.asarray(self.system.value(point, p)) / sizes
        section = Section(point, rate / np.linalg.norm(rate) / sizes, self._lin_direction(sizes, cut, rate))
        before, after = arc_of(profile, 0.0, cut), arc_of(profile, cut, 1.0)
        arcs = (before, *[_one(after, before)] * (self.count - 1), after)
        gaps = np.zeros(self.count)
        own = Arcs(
            self.system, p, curve.first, saddle, section, sizes, curve.stable_count, curve.unstable_count, arcs, gaps
        )
        found = own.solved(range(self.count), (), False)
        if found is None:
            raise NoSolutionError(
                f"{self.where}: step 0 of Lin's method (copies of the orbit, with gaps) fails: Newton's method does "
                "not converge"
            )
        return found

    def _lin_direction(self, sizes: Array, cut: float, rate: Array) -> Array:
        """The adjoint solution at the section, normal to the flow; of unit length in the states' sizes."""
        psi = self.problem.adjoint_at(self.z, cut, sizes)
        along = rate / np.linalg.norm(rate)
        psi = psi - (psi @ along) * along
        size = float(np.linalg.norm(psi))
        if not size > 0.0:
            raise NoSolutionError(f"{self.where}: the adjoint solution, Lin's direction, is not determined")
        return np.asarray(sizes * psi / size)

    # -- closing the gaps ----------------------------------------------------------------------------------------------

    def _closed(self, start: Arcs, k: int, shift: int) -> Iterator[Arcs]:
        """Arcs whose gaps k + shift, .. vanish, those before being closed already.

        shift : 1 where the copies leave the first gap closed, as it depends on the parameter alone (the others on the
        time before them); 0 where it is the last one (the others on the time after them).
        """
        if k == self.count - 1:
            yield start
            return
        for at in self._zeros(start, k, shift):
            yield from self._closed(at, k + 1, shift)

    def _zeros(self, start: Arcs, k: int, shift: int) -> Iterator[Arcs]:
        """Where gap k vanishes, at times that become shorter; those at which gaps are hardly more than noise last."""
        times, gap = tuple(range(1, k + 1)), k + shift
        unknown = tuple(range(gap, self.count - 1 + shift))
        anchor = 0 if shift else self.count - 1  # closed by the parameter
        now = replace(start, gaps=np.where(np.arange(self.count) == anchor, 0.0, start.gaps))
        found, step = now.solved(unknown, times, True), self._step(start)
        shortest, largest, count = SHORTEST * start.arcs[k + 1].period, 0.0, 0
        early: list[Arcs] = []
        for _ in range(STEPS):
            if found is None or count == MOST or found.arcs[k + 1].period - step < shortest:
                break
            before = found
            found = before.shorter(k + 1, step).solved(unknown, times, True)
            if found is None:
                break
            a, b = float(before.gaps[gap]), float(found.gaps[gap])
            largest = max(largest, abs(b))
            at = self._at_zero(before, found, (gap, k + 1), times, unknown) if a * b < 0.0 else None
            if at is not None and largest > DISTINCT:
                count += 1
                yield at
            elif at is not None:
                early.append(at)
        yield from early[: -MOST - 1 : -1]

    def _step(self, arcs: Arcs) -> float:
        """By which a time between passages becomes shorter."""
        matrix = np.asarray(self.system.jacobian(arcs.saddle, arcs.p)[1])[:, : self.system.n]
        sizes = np.abs(np.linalg.eigvals(matrix))
        return float(max(STEP / sizes.max(), 0.1 * STEP / sizes.min()))

    def _at_zero(
        self, before: Arcs, after: Arcs, pair: tuple[int, int], times: tuple[int, ...], unknown: tuple[int, ...]
    ) -> Arcs | None:
        """The gap of a pair closed by the time of its arc."""
        gap, arc = pair
        near = after if abs(after.gaps[gap]) < abs(before.gaps[gap]) else before
        gaps = near.gaps.copy()
        gaps[gap] = 0.0
        rest = tuple(j for j in unknown if j != gap)
        return replace(near, gaps=gaps).solved(rest, (*times, arc), True)

    def _joined(self, arcs: Arcs) -> Seed:
        """One orbit, solved for as every other homoclinic orbit."""
        curve = self.problem.curve
        t, u = arcs.whole()
        parameter = float(arcs.p[curve.first])
        orbit = laid(t, u, arcs.sizes, parameter)
        seed = solved_connection(replace(curve, gauge=None), orbit, arcs.saddle[None], float(self.z[-2]), None)
        found = seed.problem.profile(seed.z)  # type: ignore[attr-defined]
        turns = passages(found, arcs)
        if turns != self.count:
            raise NoSolutionError(f"Newton's method came to an orbit of {turns} turns")
        return seed


def passages(profile: Profile, arcs: Arcs) -> int:
    """How often an orbit crosses the section in the sense of the flow there, beside its point."""
    u, section = profile.at(np.linspace(0.0, 1.0, SAMPLES)), arcs.section
    side = (u - section.point) @ section.normal
    up = np.flatnonzero((side[:-1] < 0.0) & (side[1:] >= 0.0))
    off = np.linalg.norm((u[up] - section.point) / arcs.sizes, axis=1)
    return int(np.sum(off < BESIDE * float(np.linalg.norm((section.point - arcs.saddle) / arcs.sizes))))


def _one(first: Profile, second: Profile) -> Profile:
    """Two parts in a row; a jump between them is taken by the second one's first node."""
    period = first.period + second.period
    h = np.concatenate([first.h * first.period, second.h * second.period]) / period
    return Profile(first.m, np.vstack([first.u, second.u[1:]]), period, h, first.parameter)
