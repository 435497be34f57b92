"""A periodic orbit from samples of one period: interpolated on an adapted mesh, then solved for by Newton."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.errors import InputError, NoSolutionError
from contin.model.evaluate import evaluate
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.problems.orbits.mesh.adaption import choose_mesh
from contin.problems.orbits.mesh.layout import Profile
from contin.problems.orbits.periodic_orbit import PeriodicOrbit
from contin.systems.away_from_samples import PLACES, away, on_even_times

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem

OFF: Final = 0.02  # part of the forcing period by which samples may miss a multiple of it
FIRST: Final = 100  # intervals that the samples are first laid on


def orbit_from_samples(
    system: CompiledSystem, t: Array, u: Array, p: Array, periods: Array, intervals: int | None = None, points: int = 4
) -> PeriodicOrbit:
    """The periodic orbit near samples u (K, n) at times t (K,), the last the first again, at parameters p.

    periods (n,) of the states, 0 where they are not angles: an angle's whole turns from the first to the last sample
    are its winding. The orbit of a forced system begins at a multiple of the forcing period, wherever t does.

    Raises InputError where t does not span a multiple of the forcing period, NoSolutionError where Newton does not
    converge, or only to an equilibrium.
    """
    t, u, p = np.asarray(t, dtype=float), np.asarray(u, dtype=float), np.asarray(p, dtype=float)
    period = float(t[-1] - t[0])
    angles = np.where(periods > 0.0, periods, 1.0)
    winding = np.where(periods > 0.0, periods * np.round((u[-1] - u[0]) / angles), 0.0)
    multiple, begin = 1, float(t[0])
    if system.is_forced:
        multiple, begin, period = _in_step(system, p, t)
    loop = _Loop(t, u, winding, begin)
    problem = OrbitProblem(system, p, 0, winding, points, intervals, multiple)
    profile = loop.profile(points, period, np.full(FIRST, 1.0 / FIRST), float(p[0]))
    for _ in range(2):
        h = choose_mesh(profile, problem.state_sizes(profile), problem.tolerance, intervals).h
        profile = loop.profile(points, period, h, float(p[0]))
    z = profile.vector()
    scale = problem.initial_scale(z, (z[-1] - 0.5, z[-1] + 0.5))
    solved = problem.at_parameter(z, float(p[0]), scale)
    if solved is None:
        raise NoSolutionError(
            "the samples are not near a periodic orbit at these parameters: Newton does not converge from them. They "
            "must cover one period, the last line the first again; check the parameters they belong to."
        )
    if problem.autonomous and problem.is_constant(solved, 1e3 * scale):
        raise NoSolutionError("the samples lead to an equilibrium, not to an orbit: its amplitude there is too small")
    orbit = problem.profile(_on_own_mesh(problem, solved, float(p[0])))
    return PeriodicOrbit(system, orbit, p.copy(), winding, multiple, _apart(system, (t, u), orbit, winding))


def _apart(system: CompiledSystem, samples: tuple[Array, Array], orbit: Profile, winding: Array) -> tuple[str, ...]:
    """A note where the orbit is not near the samples (t, u)."""
    t, u = samples
    places = np.linspace(0.0, 1.0, PLACES)
    turned = places[:, None] * winding
    note = away(system.state_names, on_even_times(t, u) - turned, orbit.at(places) - turned, "closed")
    return (f"{note}. Their period is {float(t[-1] - t[0]):.6g}, its own {orbit.period:.6g}",) if note else ()


def _on_own_mesh(problem: OrbitProblem, z: Array, parameter: float) -> Array:
    """The orbit z on a mesh laid out for it: that of the samples shows how rough they are, of a straight line rounding.

    It stays on its mesh where Newton does not converge on the other.
    """
    profile = problem.profile(z)
    h = choose_mesh(profile, problem.state_sizes(profile), problem.tolerance, problem.intervals).h
    moved = profile.on_mesh(h).vector()
    found = problem.at_parameter(moved, parameter, problem.initial_scale(moved, (z[-1] - 0.5, z[-1] + 0.5)))
    return z if found is None else found


def _in_step(system: CompiledSystem, p: Array, t: Array) -> tuple[int, float, float]:
    """(forcing periods that the samples span, the multiple of the period from which they are read, their exact length).

    The equations know the time: an orbit begins at 0 modulo the forcing period.
    """
    forcing = float(evaluate(system.forcing_period, dict(zip(system.parameter_names, p, strict=True))))
    span = float(t[-1] - t[0]) / forcing
    multiple = max(round(span), 1)
    if abs(span - multiple) > OFF * multiple:
        raise InputError(
            f"the samples span {span:.6g} forcing periods; an orbit spans a whole number of them ({forcing:.10g})"
        )
    return multiple, forcing * float(np.ceil(t[0] / forcing - 1e-9)), multiple * forcing


class _Loop:
    """The closed curve through the samples, from the time `begin` on."""

    def __init__(self, t: Array, u: Array, winding: Array, begin: float) -> None:
        from scipy.interpolate import PchipInterpolator

        part = ((t - t[0]) / (t[-1] - t[0]))[:, None]
        closed = u - part * (u[-1] - u[0] - winding)  # what does not close is spread over the period
        self.curve, self.winding = PchipInterpolator(t, closed), winding
        self.first, self.length, self.begin = float(t[0]), float(t[-1] - t[0]), begin

    def profile(self, points: int, period: float, h: Array, parameter: float) -> Profile:
        """Values at the nodes of a mesh."""
        empty = Profile(points, np.empty((len(h) * points + 1, len(self.winding))), period, h, parameter)
        turns, rest = np.divmod((self.begin - self.first) / self.length + empty.times, 1.0)
        return replace(empty, u=self.curve(self.first + rest * self.length) + turns[:, None] * self.winding)
