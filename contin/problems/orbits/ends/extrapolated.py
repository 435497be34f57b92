"""The parameter that a family of growing period approaches, from the slopes dp/dT of two of its orbits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from contin.machine import elementary

APART = 1.05  # ratio of two rates from which their terms are told apart
LONGEST = 100.0  # period gained between two orbits, in units of a rate, beyond which one says nothing of the other
CORRECTION = 0.1  # largest second term relative to the first
LEFT_OUT = 0.1  # part of the second term that may still be missing


@dataclass(frozen=True)
class Limit:
    """Distance of an orbit's parameter from its limit, and how far two orbits disagree on that."""

    step: float
    drift: float
    spiral: bool
    rate: float
    doubt: float = 0.0  # what terms that are left out may make (of second order)

    @property
    def disagreement(self) -> float:
        """The two orbits' relative to what remains."""
        return self.drift / abs(self.step) if self.step != 0.0 else 0.0


def extrapolated(
    slowest: Sequence[complex], visits: Sequence[int], slopes: Sequence[float], gained: float, moved: float
) -> Limit:
    """From the slopes dp/dT of two orbits whose periods differ by `gained` and whose parameters by `moved`."""
    k = 1.0 / sum(count / abs(value.real) for count, value in zip(visits, slowest, strict=True))
    q = k * max(value.imag / abs(value.real) for value in slowest)
    if q > 0.0:
        steps = _of_spiral(k, q, slopes, gained)
    else:
        steps = [slope / k for slope in slopes]
    drift = abs(moved + steps[0] - steps[1])
    return Limit(steps[0], drift, q > 0.0, k, drift * _hidden(k, q, gained) if q > 0.0 else 0.0)


def _of_spiral(k: float, q: float, slopes: Sequence[float], gained: float) -> list[float]:
    """p* - p at both orbits from p - p* = exp(-k t) (a cos q t + b sin q t), whose slopes are known at t = 0, -gained.

    Both from the slopes, so that what the parameters say is a check: second derivatives from the four numbers, exact
    for cubics alone, are wrong by the same part at both orbits, which their agreement does not show.
    """
    angle, grown = q * gained, elementary.exp(k * gained)
    sine, cosine = float(elementary.sin(angle)), float(elementary.cos(angle))
    here = slopes[0]  # q b - k a
    if sine == 0.0:
        return [np.inf, -np.inf]
    across = -(slopes[1] / grown - here * cosine) / sine  # -(q a + k b)
    square = k * k + q * q
    a, b = -(k * here + q * across) / square, (q * here - k * across) / square
    return [-a, -grown * (a * cosine - b * sine)]


def _hidden(k: float, q: float, gained: float) -> float:
    """How many times larger than the drift the error of a step is that terms of second order make: exp(-2 k t) by 1,
    cos(2 q t) and sin(2 q t).

    Slopes at two orbits near each other fit any such term, and leave of it what a cubic leaves: the drift alone says
    little (two orbits at an angle of 0.16 agree to a thousandth of their common error).
    """
    largest = 0.0
    for w, c, s in ((0.0, 1.0, 0.0), (2.0 * q, 1.0, 0.0), (2.0 * q, 0.0, 1.0)):
        cosine, sine = (float(f(-w * gained)) for f in (elementary.cos, elementary.sin))
        grown = float(elementary.exp(2.0 * k * gained))
        before = grown * (c * cosine + s * sine)
        slopes = (w * s - 2.0 * k * c, grown * (w * (s * cosine - c * sine)) - 2.0 * k * before)
        steps = _of_spiral(k, q, slopes, gained)
        drift = abs(c - before + steps[0] - steps[1])
        largest = max(largest, abs(steps[0] + c) / drift if drift > 0.0 else np.inf)
    return largest


def with_next(first: Limit, next_: Limit, slopes: Sequence[float], gained: float, moved: float, wanted: float) -> Limit:
    """The first limit, or, where it is better known, p* = p - a - b from p - p* = a exp(-k t) + b exp(-k' t).

    The other leading rate of the saddle, or the square of the first term, makes the second one (Lin's method; Sandstede
    1993). The slopes of the two orbits give a and b, and their parameters say how well both fit.
    """
    k, faster = first.rate, min(next_.rate, 2.0 * first.rate)
    if first.spiral or next_.spiral or faster < APART * k or faster * gained > LONGEST:
        return first
    there = np.array([[k, faster], [k * elementary.exp(k * gained), faster * elementary.exp(faster * gained)]])
    a, b = np.linalg.solve(there, [-slopes[0], -slopes[1]])
    missed = abs(moved + a * elementary.expm1(k * gained) + b * elementary.expm1(faster * gained))
    doubt = LEFT_OUT * abs(b)
    known = missed * max(1.0, abs(a + b) / abs(moved)) if moved != 0.0 else np.inf
    if abs(b) > CORRECTION * abs(a):
        return first
    if not max(known, doubt) < wanted:
        return replace(first, doubt=float(abs(b)))
    return Limit(float(-a - b), float(missed), False, k, float(doubt))
