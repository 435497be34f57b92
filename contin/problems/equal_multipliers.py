"""Which of the multipliers of an orbit pass the unit circle together: those that a symmetry makes equal.

Of a ring, a lattice or a torus of equal cells the uniform orbit has multipliers once for every wave vector of one
length: two or four, or more, real ones or pairs.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Final

import numpy as np

from contin.abi import Array, Vector
from contin.continuation.sample import Sample
from contin.continuation.together import Level, Together
from contin.machine import elementary
from contin.problems.coinciding import OF_ORBITS

EQUAL: Final = 1e-5  # of the way that they go in a step: multipliers this near to each other are equal
REAL: Final = 1e-6  # imaginary part, beside the modulus, of a real one that rounding has split; equal ones, so near
TURNED: Final = 0.5  # angle (radians) that a pair may turn by in one step


def passing_together(a: Sample, b: Sample, autonomous: bool, types: tuple[str, ...]) -> Iterator[Together]:
    """What all that changes between two orbits may be, where it is two or more equal multipliers that pass.

    More than one thing where others, equal too, are on the other side at b: multipliers that pass 1 and zero, say.
    autonomous : the first multiplier is the trivial one.  types : of PD (at -1), NS and BPC (at 1), those asked for.
    """
    moved = abs(b.unstable - a.unstable)
    if moved < 2:
        return
    one, other = (sample.eigenvalues[1:] if autonomous else sample.eigenvalues for sample in (a, b))
    if not (np.isfinite(one).all() and np.isfinite(other).all()):
        return
    for type_ in types:
        count = moved // 2 if type_ == "NS" else moved
        if count < 2 or (type_ == "NS" and moved % 2):
            continue
        ends = [_nearest_to_circle(_of_kind(values, type_), count) for values in (one, other)]
        if any(end is None for end in ends):
            continue
        (first, spread), (last, width) = (_mean(np.asarray(end)) for end in ends)
        way = abs(first.real) + abs(last.real)
        if first.real * last.real < 0.0 and max(spread, width) < EQUAL * way and abs((last - first).imag) < TURNED:
            level = partial(_level, type_=type_, count=count, way=(first, last), autonomous=autonomous)
            theta = {"PD": np.pi, "BPC": 0.0}.get(type_, float(0.5 * (first + last).imag))
            yield Together(type_, count, theta, level, OF_ORBITS[type_].format(count=count))


def is_repeated(values: Vector, pair: complex) -> bool:
    """True where a pair of multipliers is there more than once, to rounding."""
    return int(np.sum(np.abs(values - pair) <= REAL * abs(pair))) > 1


def repeated(values: Vector, target: complex) -> int:
    """How many multipliers are the one nearest to a target, to rounding; at least 1."""
    nearest = values[np.argmin(np.abs(values - target))]
    return int(np.sum(np.abs(values - nearest) <= REAL * abs(nearest)))


def _of_kind(values: Vector, type_: str) -> Vector:
    """log m of the real ones of one sign (PD: log(-m)), or of one of each pair."""
    values = values[np.abs(values) > 0.0]
    real = np.abs(values.imag) <= REAL * np.abs(values)
    if type_ == "NS":
        return _logarithm(values[~real & (values.imag > 0.0)])
    sign = -1.0 if type_ == "PD" else 1.0
    return _logarithm(sign * values[real & (sign * values.real > 0.0)])


def _logarithm(values: Vector) -> Vector:
    return np.asarray(elementary.log(np.abs(values)) + 1j * elementary.angle(values))


def _nearest_to_circle(logarithms: Vector, count: int) -> Vector | None:
    """So many of them; None where there are less."""
    if len(logarithms) < count:
        return None
    return np.asarray(logarithms[np.argsort(np.abs(logarithms.real), kind="stable")[:count]])


def _mean(logarithms: Vector) -> tuple[complex, float]:
    mean = complex(logarithms.mean())
    return mean, float(np.max(np.abs(logarithms - mean)))


def _level(sample: Sample, type_: str, count: int, way: tuple[complex, complex], autonomous: bool) -> Level:
    """Of so many multipliers that lie nearest to the way between two places of log m."""
    values = _of_kind(sample.eigenvalues[1:] if autonomous else sample.eigenvalues, type_)
    if len(values) < count:
        return Level(float("nan"), float("inf"))
    nearest = values[np.argsort(_off(values, way), kind="stable")[:count]]
    mean, spread = _mean(nearest)
    return Level(mean.real, spread)


def _off(values: Vector, way: tuple[complex, complex]) -> Array:
    """Distances from the straight line between two places."""
    first, chord = way[0], way[1] - way[0]
    part = np.clip(((values - first) * np.conj(chord)).real / elementary.square(abs(chord)), 0.0, 1.0)
    return np.asarray(np.abs(values - first - part * chord))
