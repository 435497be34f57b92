"""Families whose period grows without bound: the homoclinic or heteroclinic orbit that they approach."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.continuation.branch import End
from contin.continuation.outcome import Verified
from contin.continuation.sample import Frame, Sample
from contin.continuation.settings import Settings
from contin.machine import elementary
from contin.problems.orbits.ends.agreement import AGREED, error_of_limit
from contin.problems.orbits.ends.distances import extent_of
from contin.problems.orbits.ends.extrapolated import extrapolated, with_next
from contin.problems.orbits.ends.saddles import Saddle, rounded, saddles_and_elsewhere
from contin.problems.orbits.ends.stays import time_away
from contin.problems.orbits.mesh.layout import Profile
from contin.problems.orbits.mesh.peaks import extrema
from contin.records import Fields

if TYPE_CHECKING:
    from contin.problems.orbits.family import FamilyOfOrbits

LEVELS = 3  # rates of a saddle that are tried
RELAXED = 3.0  # periods, in units of a slower rate, from which its term would be seen; before it is like a constant
FADES = 0.5  # part of a faster rate at which dp/dT must fall: the two constants of a spiral fit any two orbits
FITS = 0.1  # part of what the parameter moved that a faster rate may leave unexplained
ELSEWHERE = 0.02  # part of what the period gained that an orbit may gain away from saddles where it is slow there, too
PRECISE = Settings(tolerance=1e-11)
ROUNDING = 2e-11  # of the range: what Newton's last steps leave of a limit
FINER = 2.0  # the finer mesh has an error of its own


def diverged(
    problem: FamilyOfOrbits, origin: Sample, before: Sample, frame: Frame, failed: bool = False
) -> tuple[End, Verified] | None:
    """The homoclinic or heteroclinic orbit that a family with growing period approaches.

    With v visits of saddles with leading rates r, p - p* = A exp(-k T), 1 / k = sum of 1 / r over the visits, so
    p* = p + (dp/dT) / k. Where the leading eigenvalues are r +- i w, p - p* = A exp(-k T) cos(q T + c), q = k w / r,
    whose A and c the slopes of two orbits give. Slopes are those of the tangents. The limit is believed when two orbits
    agree on it and the remaining distance is small, and the orbits' extrema, too, are near their limits
    e* = e + (de/dT) / k: those of Lotka and Volterra's predator and prey linger at a saddle, and grow for ever. The
    slowest direction of a saddle may have no part in it (a skew product, the phase of a frame that turns with the
    state, a flip): faster rates are tried after it, once the period is so long that its term could be seen, and
    where they explain how the parameter moved (Plant's bursting neuron has rates of 0.00015, 0.0059 and 0.012: the
    third makes limits of two orbits of period 985, and of period 23,000, that are wrong by 200 times their errors).

    failed : the corrector can go no further; then two orbits need not agree, the march's tangents do, and what remains
        counts as error.
    """
    profile, sizes = problem.profile(origin.z), problem.sizes(origin.z, frame.scale)
    earlier = problem.profile(before.z)
    gained = profile.period - earlier.period
    if not gained > 0.0:
        return None
    saddles, elsewhere = saddles_and_elsewhere(problem, profile, sizes, earlier)
    if not saddles:
        return None
    if elsewhere:
        away, before_away = (time_away(problem, saddles, orbit, sizes) for orbit in (profile, earlier))
        if abs(away - before_away) > ELSEWHERE * gained:
            return None
    slopes = [_slope(problem, sample, frame, failed) for sample in (origin, before)]
    if np.isnan(slopes).any():
        return None
    width = float(frame.scale[-1])
    moved = profile.parameter - earlier.parameter
    growth = _growth(profile, earlier, sizes, problem.winding) / gained
    visits = [s.visits for s in saddles]
    rates = list(zip(*(s.by_rate for s in saddles), strict=False))
    limits = [extrapolated(slowest, visits, slopes, gained, moved) for slowest in rates[:LEVELS]]
    seen = limits[0].rate * profile.period > RELAXED
    fading = _fading(slopes, gained)
    used = [seen and fading > FADES * one.rate and (failed or one.drift <= FITS * abs(moved)) for one in limits]
    if not failed and len(saddles) == 1:
        pairs = pairwise(limits)
        limits = [with_next(*pair, slopes, gained, moved, AGREED * width) for pair in pairs] + limits[-1:]
    limits = limits[:1] + [limit for limit, fits in zip(limits[1:], used[1:], strict=True) if fits]
    if failed:
        limits = sorted(limits, key=lambda limit: limit.disagreement)[:1]
    for level, limit in enumerate(limits):
        error = error_of_limit(limit, moved, gained, growth, width, failed, first=level == 0)
        if error is None:
            continue
        at = profile.parameter + limit.step
        at_limit = [s.at(problem, at, sizes) for s in saddles]
        doubt = error
        doubt += (2.0 * abs(limit.step) + abs(moved)) * limit.rate * profile.period * _changed(saddles, at_limit)
        doubt += ROUNDING * width + _by_mesh(problem, origin, frame, slopes[0], limit.step)
        return _connection(problem, origin, profile, at_limit, at, doubt)
    return None


def _by_mesh(problem: FamilyOfOrbits, origin: Sample, frame: Frame, slope: float, step: float) -> float:
    """What the mesh's own error does to a limit that is a step away: parameter and slope dp/dT on half the lengths.

    Where there is no orbit on that mesh the two differ by more than what remains between the orbit and its limit.
    """
    refined = problem.refined(origin, frame)
    there = np.nan if refined is None else _by_period(problem, refined[1].tangent, refined[1], refined[2])
    if refined is None or np.isnan(there) or slope == 0.0:
        return abs(step)
    z, back = refined[1].z, origin.z[problem.period_place(origin.z)]  # at the period of the orbit
    moved = float(z[-1] + there * (back - z[problem.period_place(z)]) - origin.z[-1])
    return FINER * (abs(moved) + abs((there / slope - 1.0) * step))


def _slope(problem: FamilyOfOrbits, sample: Sample, frame: Frame, failed: bool) -> float:
    """dp/dT; NaN where it is not known."""
    exact = problem.probe(sample, 0.0, sample.z, frame, PRECISE)  # the march's tangents are not exact enough here
    if exact is None and not failed:
        return np.nan
    return _by_period(problem, sample.tangent if exact is None else exact.tangent, sample, frame)


def _by_period(problem: FamilyOfOrbits, tangent: Array, sample: Sample, frame: Frame) -> float:
    """dp/dT along a tangent at a sample; NaN where the period stands still."""
    raw, position = tangent * frame.scale, problem.period_place(sample.z)
    return float(raw[-1] / raw[position]) if raw[position] != 0.0 else np.nan


def _fading(slopes: Sequence[float], gained: float) -> float:
    """The rate at which dp/dT has become smaller from one orbit to the next; infinite where its sign has changed."""
    here, before = slopes
    return float(elementary.log(before / here)) / gained if before * here > 0.0 else np.inf


def _changed(saddles: list[Saddle], at_limit: list[Saddle]) -> float:
    """Largest change of a leading eigenvalue from here to the limit, relative to its rate: that of log(p - p*) / (k T)
    at both orbits."""
    return max(
        abs(one.leading - other.leading) / abs(one.leading.real) for one, other in zip(saddles, at_limit, strict=True)
    )


def _growth(profile: Profile, earlier: Profile, sizes: Array, winding: Array) -> float:
    """Largest change of an extremum between two orbits, relative to the extent; not of angles that go round: their
    extrema say where a period begins, and they cannot grow."""
    now, then = (np.array(extrema(orbit.u[None], orbit.m))[:, 0] for orbit in (profile, earlier))
    changes = np.abs(now - then) / sizes
    return float(np.max(changes, initial=0.0, where=np.asarray(winding == 0.0))) / extent_of(profile, sizes)


def _connection(
    problem: FamilyOfOrbits, origin: Sample, profile: Profile, saddles: list[Saddle], limit: float, error: float
) -> tuple[End, Verified]:
    name, names = problem.parameters[0], problem.system.state_names
    data: Fields = {"at": {name: limit}, "error": error, "spiral": any(s.leading.imag > 0.0 for s in saddles)}
    kind = "homoclinic" if len(saddles) == 1 else "heteroclinic"
    sizes = np.abs(profile.u).max(axis=0)
    states = [dict(zip(names, rounded(s.u, sizes).tolist(), strict=True)) for s in saddles]
    described = ["(" + ", ".join(f"{k} = {v:.8g}" for k, v in state.items()) + ")" for state in states]
    if len(saddles) == 1:
        data |= {"saddle": states[0], "eigenvalues": saddles[0].eigenvalues, "saddle_quantity": saddles[0].quantity}
        data["passes"] = saddles[0].visits
    else:
        data["saddles"] = [
            {"state": state, "eigenvalues": s.eigenvalues, "saddle_quantity": s.quantity}
            for state, s in zip(states, saddles, strict=True)
        ]
    text = (
        f"the period grows without bound (here {profile.period:.6g}): {kind} orbit at {name} = {limit:.12g} "
        f"+- {error:.1e}, "
        f"saddle{'s' if len(saddles) > 1 else ''} {', '.join(described)}"
    )
    z = origin.z.copy()
    z[-1] = limit  # the last orbit stands for the connecting one
    point = Verified(
        "HOM", z, float(abs(limit - profile.parameter)), error, origin.eigenvalues, origin.unstable,
        normal_form={"at": {name: limit}} | ({"kind": kind} if kind == "heteroclinic" else {}),
    )  # fmt: skip
    return End(kind, text, data), point
