"""Curves of orbits that touch a switching surface: the equations.

F = 0, the shooting equations with the touched surfaces held, and g = h(u(s)) = 0 with s the time at which h has its
extremum. As dh/dt = 0 there, dg = h_u . du(s) + h_p dp at fixed s: first variations are enough (di Bernardo, Budd,
Champneys and Kowalczyk, Piecewise-smooth Dynamical Systems, 2008, ch. 6 and 7). z is that of `CurveByShooting`.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, Self

import numpy as np

from contin.abi import Array
from contin.loci.shooting.contacts import NEAR, Touch, touches, vertex
from contin.loci.shooting.curve import CurveByShooting, Equations
from contin.loci.shooting.expansion import Expansion
from contin.model.evaluate import evaluate
from contin.problems.shooting.layout import Nodes
from contin.problems.shooting.shot_orbits import ShootingProblem
from contin.problems.shooting.sizes import absolute_tolerances
from contin.records import Fields
from contin.simulate.flight import fly
from contin.symbolic.calculus.derivatives import derivative

BEYOND = (1e-5, 1e-4, 1e-3, 1e-2)  # (scaled) how far beyond a touching orbit it is seen how the surface is crossed


@dataclass(frozen=True, eq=False)
class GrazingCurve(CurveByShooting):
    """Nonsmooth folds: `orbits` holds the touched surfaces; `touch` is the first of them, at the start."""

    orbits: ShootingProblem
    second: int
    touch: Touch
    gauge: float | None = None  # the time, in periods, at which the extremum is looked for
    _formulas: Fields = field(default_factory=dict)  # of the touched surface, made once

    type = "LPC"

    def at(self, z: Array) -> ShootingProblem:
        """The orbits themselves, without held surfaces."""
        return replace(self.as_they_are(z), held={})

    def as_they_are(self, z: Array) -> ShootingProblem:
        """With held surfaces: without, rounding decides whether the orbit touches, crosses or slides."""
        orbits: ShootingProblem = super().at(z)
        return orbits

    @property
    def movable(self) -> bool:
        """Where several segments hold different surfaces, their phase is kept."""
        return self.orbits.count == 1

    @property
    def touched(self) -> int:
        return self.touch.surface

    def precise(self, accuracy: float) -> Self:
        return replace(self, orbits=self.orbits.precise(accuracy))

    def shifted(self, fraction: float) -> Self:
        return replace(self, gauge=(self._time - fraction) % 1.0)

    @property
    def _time(self) -> float:
        return self.touch.time if self.gauge is None else self.gauge

    def settled(self, z: Array, scale: Array) -> Self:
        known = self._found(z) if self.gauge is None else self
        found = known._extremum(z)
        return known if found is None else replace(self, gauge=found / float(z[self._states]))

    def _found(self, z: Array) -> Self:
        """With the time at which the orbit touches the surface, where nothing is known of its neighbours."""
        own = [touch for touch in touches(self.at(z), self.orbit(z), NEAR) if touch.surface == self.touch.surface]
        nearest = min(own, key=lambda touch: abs(touch.value), default=None)
        return self if nearest is None or not self.movable else replace(self, gauge=nearest.time)

    def linearise(self, z: Array, scale: Array) -> Equations | None:
        at = Expansion.of(self.as_they_are(z), self.second, self.orbit(z), self.orbit(scale), float(scale[-2]))
        special = None if at is None else self.clearance(z, at)
        if special is None or at is None:
            return None
        value, row = special
        row = row * at.units
        unit = float(np.linalg.norm(row))
        if not (np.isfinite(value) and np.isfinite(unit) and unit > 0.0):
            return None
        return Equations(np.append(at.residual, value / unit), np.vstack([at.jacobian, row / unit]))

    def turns(self, z: Array, scale: Array) -> bool:
        """True where the family of orbits in the first parameter turns round at the touching one: a fold.

        Beyond it the surface is crossed, and the tangent is that of the flow without held surfaces.
        """
        orbit, metric, width = self.orbit(z), self.orbit(scale), float(scale[-2])
        at = Expansion.of(self.as_they_are(z), self.second, orbit, metric, width)
        special = None if at is None else self.clearance(z, at)
        if special is None or at is None:
            return False
        own = np.delete(np.arange(at.rows + 2), at.rows)  # without the second parameter
        approach = (self.touch.side * special[1] * at.units)[own]

        def ahead(here: Expansion) -> Array:
            t = np.linalg.svd(here.jacobian[:, own])[2][-1]
            return np.asarray(-t * np.sign(float(approach @ t)))

        first = ahead(at)
        for distance in BEYOND:
            moved = orbit.copy()
            moved[: at.rows] += distance * first[:-1] * at.units[: at.rows]
            moved[-1] += distance * first[-1] * at.units[-1]
            beyond = Expansion.of(self.at(z), self.second, moved, metric, width)
            if beyond is not None and not any(f.touched for f in beyond.segments.flights):
                return float(first[-1] * ahead(beyond)[-1]) < 0.0
        return False

    def _extremum(self, z: Array) -> float | None:
        """Time at which h has its extremum, next to the last known."""
        problem, nodes, start = self._begin(z)
        p = problem.full_parameters(self.orbit(z))
        atol = absolute_tolerances(problem, nodes, p, problem.accuracy)

        def along(times: Array) -> Array:
            flight = fly(
                problem.system, nodes.u[self._segment], p, float(times[-1]) - start, start=start, times=times,
                rtol=problem.accuracy, atol=atol,
                budget=problem.budget, pieces=problem.held.get(self._segment),
            )  # fmt: skip
            if len(flight.u) < len(times):
                return np.full(len(times), np.nan)
            return np.array([self._values(u, p, float(t))[0] for u, t in zip(flight.u, times, strict=True)])

        time, value, _ = vertex(along, self._time * nodes.period, nodes.period)
        return time if np.isfinite(value) and time > start else None

    @property
    def _segment(self) -> int:
        return int(self.touch.time * self.orbits.count)

    def _begin(self, z: Array) -> tuple[ShootingProblem, Nodes, float]:
        nodes = Nodes.of(self.orbit(z), self.orbits.n)
        return self.as_they_are(z), nodes, self._segment * nodes.period / nodes.count

    def clearance(self, z: Array, at: Expansion) -> tuple[float, Array] | None:
        """h at its extremum, and its derivative by (u, T, q, p) in the model's units; None where there is none."""
        time = self._extremum(z)
        if time is None:
            return None
        problem, nodes, start = self._begin(z)
        n, k, p = problem.n, self._segment, problem.full_parameters(self.orbit(z))
        flight = fly(
            problem.system, nodes.u[k], p, time - start, start=start,
            variations=np.hstack([np.eye(n), np.zeros((n, 2))]),
            columns=np.append(np.full(n, -1), [n + self.second, n + problem.active]), rtol=problem.accuracy,
            atol=absolute_tolerances(problem, nodes, p, problem.accuracy), budget=problem.budget,
            pieces=problem.held.get(k),
        )  # fmt: skip
        if flight.outcome != "done":
            return None
        value, gradient = self._values(flight.end[:n], p, time)
        by_start = gradient[:n] @ flight.variations
        row = np.zeros(at.rows + 2)
        row[k * n : (k + 1) * n] = by_start[:n]
        if not problem.autonomous:  # the segment begins later if the period is longer
            row[at.rows - 1] = -k / nodes.count * float(by_start[:n] @ at.segments.directions[k])
        row[-2:] = by_start[n:] + gradient[[n + self.second, n + problem.active]]
        return value, row

    def _values(self, u: Array, p: Array, time: float) -> tuple[float, Array]:
        """h and its derivative by (u, parameters)."""
        system = self.system
        names = [*system.state_names, *system.parameter_names]
        known = {**dict(zip(names, [*u.tolist(), *p.tolist()], strict=False)), "t": time}
        formula, *slopes = self._surface_and_slopes()
        return float(evaluate(formula, known)), np.array([float(evaluate(s, known)) for s in slopes])

    def _surface_and_slopes(self) -> list[Any]:
        """h and its derivatives by states and parameters, as formulas."""
        if not self._formulas:
            names = [*self.system.state_names, *self.system.parameter_names]
            h = self.system.pieces.functions[self.touch.surface]
            self._formulas["h"] = [h, *(derivative(h, name) for name in names)]
        known: list[object] = self._formulas["h"]
        return known
