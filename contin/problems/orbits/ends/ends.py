"""Where a family of periodic orbits ends: it shrinks to a Hopf point, or its period grows without bound at a saddle."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array, Vector
from contin.continuation.branch import End
from contin.continuation.outcome import Verified
from contin.continuation.sample import Frame, Sample
from contin.machine import elementary
from contin.problems.equilibria import defining
from contin.problems.equilibria.scaled import ScaledSystem
from contin.problems.orbits.ends.distances import extent_of
from contin.problems.orbits.ends.invariant_circle import invariant_circle
from contin.problems.orbits.ends.multiply_traversed import joined
from contin.problems.orbits.ends.saddles import equilibria_of
from contin.problems.orbits.ends.unbounded_period import diverged
from contin.problems.orbits.ends.vertical import unbounded
from contin.problems.orbits.linearised.multipliers import of_rest
from contin.problems.orbits.march.slow_passage import dwelling
from contin.problems.orbits.mesh.layout import Profile
from contin.systems.described import states_in_words

if TYPE_CHECKING:
    from contin.problems.orbits.family import FamilyOfOrbits
    from contin.problems.orbits.orbit_equations import OrbitEquations


SMALL = 0.12  # amplitude (relative to the states' sizes) below which a shrinking orbit may end at a Hopf point
MISSED = 0.5  # ... and its distance from where the amplitude's fall foretells that point, relative to what remains
VERTICAL = 1e-6  # ... or relative to the range
VANISHED = 1e-5  # amplitude of a shrinking orbit on an equilibrium: what it says beyond, of squares, is rounding
LINGERING = 0.3  # part of the period spent near equilibria from which an approach to a homoclinic orbit is looked for


@dataclass(frozen=True, eq=False)
class Ending:
    """The end, a last row and a labelled point for it."""

    end: End
    last: Sample | None = None
    point: Verified | None = None


def ending(problem: OrbitEquations, origin: Sample, before: Sample | None, frame: Frame) -> Ending | None:
    """The end that an orbit has reached, or None."""
    if before is None:
        return None
    found = shrunk(problem, origin, before, frame)
    if found is not None:
        return found
    resting = vanished(problem, origin, before, frame)
    if resting is not None:
        return Ending(resting)
    grown = unbounded(problem, origin, frame) or joined(problem, origin.z, before.z, frame.scale)
    if grown is not None:
        return Ending(grown)
    return connected(problem, origin, before, frame)


def connected(problem: FamilyOfOrbits, origin: Sample, before: Sample, frame: Frame) -> Ending | None:
    """The connecting orbit, or the fold of equilibria, that a family with growing period has come to."""
    if not _lingers(problem, origin, frame):
        return None
    reached = diverged(problem, origin, before, frame) or invariant_circle(problem, origin, before, frame)
    return None if reached is None else Ending(reached[0], None, reached[1])


def foretold(problem: FamilyOfOrbits, origin: Sample, before: Sample, frame: Frame) -> Ending | None:
    """The homoclinic or heteroclinic orbit that a family was near whose corrector fails: the last orbits agree on it
    less well than elsewhere, and its error says so.
    """
    if not _lingers(problem, origin, frame):
        return None
    reached = diverged(problem, origin, before, frame, failed=True)
    return None if reached is None else Ending(reached[0], None, reached[1])


def _lingers(problem: FamilyOfOrbits, origin: Sample, frame: Frame) -> bool:
    sizes = problem.sizes(origin.z, frame.scale)
    return bool(problem.autonomous and dwelling(problem, problem.profile(origin.z), sizes) >= LINGERING)


def _vanishing(profile: Profile, earlier: Profile, sizes: Array) -> float:
    """Where the square of the amplitude, linear in the parameter beside a Hopf point, vanishes."""
    now, then = elementary.square(extent_of(profile, sizes)), elementary.square(extent_of(earlier, sizes))
    return profile.parameter - now * (profile.parameter - earlier.parameter) / (now - then)


def _shrinking(
    problem: OrbitEquations | FamilyOfOrbits, origin: Sample, before: Sample, frame: Frame, limit: float
) -> float | None:
    """The extent of an orbit, in units of the states' sizes, where it is below a limit and falls to an equilibrium."""
    if problem.winding.any() or not problem.autonomous:
        return None
    sizes = problem.sizes(origin.z, frame.scale)
    size = extent_of(problem.profile(origin.z), sizes)
    return size if size <= limit and size < extent_of(problem.profile(before.z), sizes) else None


def vanished(problem: OrbitEquations, origin: Sample, before: Sample, frame: Frame) -> End | None:
    """The equilibrium without a Hopf point, such as a doubly degenerate one, onto which a family shrinks."""
    size = _shrinking(problem, origin, before, frame, VANISHED)
    if size is None:
        return None
    profile = problem.profile(origin.z)
    name, centre = problem.parameters[0], profile.weights @ profile.u
    where = states_in_words(problem.system.state_names, centre, lambda k: f"= {centre[k]:.6g}")
    at = f"at {name} = {profile.parameter:.10g} ({where}), period {profile.period:.3g}"
    text = f"the orbits shrink to an equilibrium that is no Hopf point {at}; amplitude {size:.0e}"
    return End("degenerate", text, {"at": {name: profile.parameter}})


def shrunk(problem: FamilyOfOrbits, origin: Sample, before: Sample, frame: Frame) -> Ending | None:
    """The Hopf point on which a family with falling amplitude closes."""
    size = _shrinking(problem, origin, before, frame, SMALL)
    if size is None:
        return None
    profile, sizes = problem.profile(origin.z), problem.sizes(origin.z, frame.scale)
    rest = equilibria_of(problem)
    centre = profile.weights @ profile.u
    z = rest.at_parameter(np.append(centre, profile.parameter), profile.parameter, np.append(sizes, frame.scale[-1]))
    if z is None:
        return None
    metric = np.append(np.sqrt(problem.n) * sizes, frame.scale[-1])
    local = ScaledSystem(rest, metric)
    omega = 2.0 * np.pi / profile.period
    nearby = defining.hopf_nearby(local, z / metric, omega)
    if nearby is None:
        return None
    y, frequency = nearby
    if abs(frequency - omega) > 0.2 * omega or float(np.linalg.norm(y - z / metric)) > 2.0 * size:
        return None
    at = float(y[-1] * metric[-1])
    missed = abs(at - _vanishing(profile, problem.profile(before.z), sizes))
    if missed > MISSED * abs(at - profile.parameter) + VERTICAL * float(frame.scale[-1]):
        return None
    solved = defining.critical_pair(local, y, lambda w: 1j * w, lambda w: 1j, frequency)
    if solved is None or solved.residual > 1e-8:
        return None
    found, frequency = solved.y * metric, abs(float(solved.extra[0]))
    point = replace(
        profile, u=np.tile(found[:-1], (len(profile.u), 1)), period=2.0 * np.pi / frequency, parameter=float(found[-1])
    )
    values: Vector = np.linalg.eigvals(rest.linear_part(found))
    unstable, multipliers = of_rest(values, frequency, point.period)
    name = problem.parameters[0]
    where = states_in_words(problem.system.state_names, found[:-1], lambda k: f"= {found[k]:.10g}")
    text = f"the orbits shrink to the Hopf point at {name} = {found[-1]:.12g} ({where}), period {point.period:.10g}"
    end = End("hopf", text, {"at": {name: float(found[-1])}, "error": solved.error * float(frame.scale[-1])})
    last = Sample(point.vector(), origin.tangent, origin.tests, unstable, multipliers)
    return Ending(end, last)
