"""Multipliers that pass the unit circle at one place, as many as a symmetry makes equal: one label for all of them.

With an even number of them no test changes its sign, and defining systems of simple points are singular there. But the
mean of log|m| over all of them is as smooth as one of them is, and vanishes where they pass: its zero is located like
that of a test, and once more on a finer mesh, which gives the error.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.curve import Stretch
from contin.continuation.location.found import Found, Note, at_point, noted
from contin.continuation.outcome import Verified
from contin.continuation.sample import Sample
from contin.continuation.together import Together
from contin.linalg.vectors import norm
from contin.machine import elementary

NARROW: Final = 1e-4  # of the step: a bracket whose ends differ by more than rounding, which gives the slope
STRAIGHT: Final = 0.1  # log|m| up to which its mean is taken as straight in the arclength
NARROWER: Final = 1e-2  # the next bracket, beside one at whose ends they are farther from the circle
FARTHER: Final = (1e-3, 1e-2, 0.1, 0.3)  # parts of the way back at which the ends of that bracket are looked for
LAST: Final = 1e-10  # arclength: of the bracket that is taken for the place
RESOLVED: Final = 1e3  # times their differences that equal ones are away from the circle at the ends of a bracket
SAFETY: Final = 2.0  # of a change from one mesh to the next: the finer one has an error of its own
ROUNDING: Final = float(np.finfo(float).eps)


def located(stretch: Stretch, a: Sample, b: Sample, together: Together) -> tuple[Sample, Sample, Found | Note] | None:
    """The place between a and b where they pass: a bracket of it, and the label or why there is none.

    None where their mean jumps over zero: other multipliers pass there than those that are meant.
    """

    def value(sample: Sample) -> float:
        return together.level(sample).mean

    accuracy = NARROW * stretch.distance(a, b)
    low, high = stretch.zero(value, a, b, accuracy)
    while accuracy > LAST and not max(abs(value(low)), abs(value(high))) < STRAIGHT:
        accuracy = max(NARROWER * accuracy, LAST)
        low, high = stretch.zero(value, low, high, accuracy)
    if not max(abs(value(low)), abs(value(high))) < STRAIGHT:
        return None
    crossed = together.type == "BPC"  # by branches, along which the equations of orbits are singular
    if crossed:
        low, high = (_on_one_side(stretch, (a, b), *pair, together) for pair in ((low, a), (high, b)))
    apart = stretch.length_of(high) - stretch.length_of(low)
    slope = (value(high) - value(low)) / apart if apart != 0.0 else 0.0
    bend = abs(float(high.tangent[-1] - low.tangent[-1]) / apart) if apart != 0.0 else 0.0
    if slope == 0.0 or not np.isfinite(slope):
        return low, high, noted(stretch, low, f"{together.type} not verified: the multipliers that pass are lost", True)
    where = _interpolated if crossed else _narrowed
    near, error = where(stretch, (a, low, high, b), together, slope, bend)
    if error is None:
        text = f"{together.type} not verified: the orbit is not found on a finer mesh"
        return low, high, noted(stretch, near, text, True)
    unstable = min(a.unstable, b.unstable)
    point = Verified(
        together.type, near.z, abs(value(near)), error, near.eigenvalues, unstable,
        vectors={"theta": together.theta, "kernel": together.count}, remark=together.words,
    )  # fmt: skip
    return low, high, Found(stretch.length_of(near), point, at_point(stretch, near, point))


def _on_one_side(
    stretch: Stretch, ends: tuple[Sample, Sample], near: Sample, end: Sample, together: Together
) -> Sample:
    """From `near` on towards `end`, the first sample with all of them inside the unit circle, or outside.

    Next to a branch point orbits are solved for the less well the nearer it is, and from guesses that have lost the
    symmetry Newton's method goes to the branches that cross there: the equal ones come apart, and between samples on
    both sides of the circle they would pass one by one. Guesses are made between the `ends`, which have it.
    """
    s_a, s_near, s_end = (stretch.length_of(sample) for sample in (ends[0], near, end))
    whole = stretch.length_of(ends[1]) - s_a
    for part in (0.0, *FARTHER):
        place = s_near + part * (s_end - s_near)
        sample = near if part == 0.0 else stretch.between(*ends, (place - s_a) / whole)
        level = None if sample is None else together.level(sample)
        if sample is not None and level is not None and abs(level.mean) > RESOLVED * level.spread:
            return sample
    return near


def _narrowed(
    stretch: Stretch, around: tuple[Sample, Sample, Sample, Sample], together: Together, slope: float, bend: float
) -> tuple[Sample, float | None]:
    """The place by secants, as near as the multipliers are equal, and its error in the parameter (see `_error`)."""
    _, low, high, _ = around
    spread = max(together.level(sample).spread for sample in (low, high))
    ends = stretch.zero(lambda sample: together.level(sample).mean, low, high, max(LAST, spread / abs(slope)))
    near = min(ends, key=lambda sample: abs(together.level(sample).mean))
    return near, _error(stretch, near, together, slope, bend)


def _interpolated(
    stretch: Stretch, around: tuple[Sample, Sample, Sample, Sample], together: Together, slope: float, bend: float
) -> tuple[Sample, float | None]:
    """The place by the cubic s(mean) through samples around it at which the multipliers are equal, and its error in the
    parameter; None where orbits are not found. Errors are those of `_error`, the mesh's at the two samples beside it.
    """
    a, low, high, b = around
    apart = stretch.length_of(high) - stretch.length_of(low)
    samples = [low, high]
    s_a, s_b = stretch.length_of(a), stretch.length_of(b)
    for place in (stretch.length_of(low) - apart, stretch.length_of(high) + apart):
        part = (place - s_a) / (s_b - s_a)
        beside = stretch.between(a, b, part) if 0.0 <= part <= 1.0 else None
        samples += [] if beside is None else [beside]
    levels, lengths = [together.level(sample) for sample in samples], [stretch.length_of(sample) for sample in samples]
    means = np.array([level.mean for level in levels])
    places = [_at_zero(means[:count], np.array(lengths[:count])) for count in range(2, len(samples) + 1)]
    near = stretch.between(a, b, (places[-1] - s_a) / (s_b - s_a))
    if near is None:  # all that is solved for is singular there: the orbit by the cubic through those beside it
        guess = stretch.hermite(low, high, apart, (places[-1] - lengths[0]) / apart)
        near = replace(low if abs(levels[0].mean) < abs(levels[1].mean) else high, z=guess)
    rate, width, moved = float(near.tangent[-1]), float(stretch.frame.scale[-1]), []
    for sample, level in zip(samples[:2], levels[:2], strict=True):
        finer = stretch.problem.refined(sample, stretch.frame)
        if finer is None:
            return near, None
        ahead = (level.mean - together.level(finer[1]).mean) / slope
        moved.append(abs(float(finer[1].z[-1] - sample.z[-1]) / width + ahead * rate))
    unsure = abs(places[-1] - places[-2]) + max(level.spread for level in levels) / abs(slope) + LAST
    error = SAFETY * max(moved) + unsure * (abs(rate) + 0.5 * bend * unsure)
    error = error * width + ROUNDING * (abs(float(near.z[-1])) + width)
    return near, error if len(samples) > 2 and np.isfinite(error) else None


def _at_zero(means: Array, lengths: Array) -> float:
    """s where the mean is 0, by Lagrange's polynomial s(mean)."""
    weights = [np.prod([other / (other - mean) for other in means if other != mean]) for mean in means]
    return float(np.dot(weights, lengths))


def _error(stretch: Stretch, near: Sample, together: Together, slope: float, bend: float) -> float | None:
    """Error of the parameter: by the mesh, by what the multipliers differ by, and by what is left at the place."""
    finer = stretch.problem.refined(near, stretch.frame)
    if finer is None:
        return None
    there = finer[1]
    here, beyond = together.level(near), together.level(there)
    rate, width = float(near.tangent[-1]), float(stretch.frame.scale[-1])
    ahead = -beyond.mean / slope
    moved = float(there.z[-1] - near.z[-1]) / width + ahead * rate
    unsure = (abs(here.mean) + here.spread + beyond.spread) / abs(slope) + LAST
    error = SAFETY * (abs(moved) + 0.5 * bend * elementary.square(ahead)) + unsure * (abs(rate) + 0.5 * bend * unsure)
    error = error * width + ROUNDING * (abs(float(near.z[-1])) + width)
    return error if np.isfinite(error) and norm(there.tangent) > 0.0 else None
