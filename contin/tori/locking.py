"""Is the rotation number locked? Then periodic solutions of q returns lie on the torus: they are solved for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Final

import numpy as np

from contin.abi import Array
from contin.errors import NoSolutionError
from contin.linalg.newton import Rules, newton
from contin.linalg.vectors import norm
from contin.tori.equations import Circle, Metric
from contin.tori.strobe import Strobe

LARGEST: Final = 30  # denominator that is looked for
FEW: Final = 6  # returns of a periodic solution beside which the motion may slow down
STILL: Final = 0.01
NEAR: Final = 0.02  # the rotation number times q to a whole number
STEPS: Final = 12
SETTLED: Final = 1e-9  # of a correction, in units of the sizes
ON_IT: Final = 0.3  # of the circle's size: how far from it a solution may be


@dataclass(frozen=True)
class Locked:
    """p/q, the parameter's value (and its error, where it is a limit), and what was found there."""

    p: int
    q: int
    value: float
    words: str
    error: float | None = None


def slowing(strobe: Strobe, metric: Metric, seen: Sequence[Circle]) -> Locked | None:
    """The periodic solution next to which the motion on the last circles slows down while the parameter stays; or None.

    q rho - p halves while the parameter moves by less than a part `STILL` of its way. Unlike at the border of locking,
    the periodic solution is there already beside the last circle.
    """
    last = seen[-1]
    for q in range(1, FEW + 1):
        p = round(last.rho * q)
        rest = abs(last.rho * q - p)
        faster = [one for one in seen if abs(one.rho * q - p) > 2.0 * rest and round(one.rho * q) == p]
        if rest > NEAR or Fraction(p, q).denominator != q or not faster:
            continue
        moved = abs(faster[-1].value - last.value)
        if moved > STILL * max(abs(one.value - last.value) for one in seen):
            continue
        try:
            words = _closed(strobe, metric, last, q, last.value)
        except NoSolutionError:
            continue  # none beside the circle: it is not this
        if words:
            return Locked(p, q, last.value, words, 2.0 * moved)
    return None


def locked_at(strobe: Strobe, metric: Metric, circle: Circle, values: Sequence[float]) -> Locked | None:
    """A periodic solution on (what was) the circle at one of the values, of q returns with p/q near rho; None: none."""
    for q in range(1, LARGEST + 1):
        p = round(circle.rho * q)
        if abs(circle.rho * q - p) > NEAR or Fraction(p, q).denominator != q:
            continue
        for value in values:
            try:
                words = _closed(strobe, metric, circle, q, value)
            except NoSolutionError:
                continue  # at this value there is none, or not within Newton's reach
            if words:
                return Locked(p, q, value, words)
    return None


def _closed(strobe: Strobe, metric: Metric, circle: Circle, q: int, value: float) -> str:
    """The periodic solution in words, or ''."""
    starts = circle.values
    gaps = [np.linalg.norm(_returned(strobe, u, q, circle.time, value)[0] / metric.sizes) for u in starts]
    size = float(np.abs(circle.deviation / metric.sizes).max())
    u, moduli = _newton(strobe, metric, starts[int(np.argmin(gaps))], q, circle.time, value)
    nearest = float(np.abs(strobe.difference(circle.values, u[None]) / metric.sizes).max(axis=1).min())
    if nearest > ON_IT * size:
        return ""
    words = "a stable" if np.sum(moduli > 1.0 + 1e-6) == 0 else "an unstable"
    return f"{words} periodic solution of {q} return{'s' * (q > 1)}"


def _returned(strobe: Strobe, u: Array, q: int, time: float, value: float) -> tuple[Array, Array, Array]:
    """phi^q(u) - u, its derivatives by u and by T."""
    x, product, by_time = u, np.eye(strobe.n), np.zeros(strobe.n)
    for _ in range(q):
        x, matrix, speed, _ = strobe.derivatives(x, time, value)
        product, by_time = matrix @ product, matrix @ by_time + speed
    return strobe.difference(x, u), product, by_time


def _newton(strobe: Strobe, metric: Metric, u: Array, q: int, time: float, value: float) -> tuple[Array, Array]:
    """A point of the periodic solution next to u, and the moduli of its multipliers.

    Corrections are the shortest ones; of an autonomous flow T is free.
    """
    start = u, time if strobe.free_time else strobe.time(value)

    def correct(at: tuple[Array, float]) -> tuple[float, tuple[Array, float]]:
        u, time = at
        gap, product, by_time = _returned(strobe, u, q, time, value)
        matrix = (product - np.eye(strobe.n)) * metric.sizes[None, :] / metric.sizes[:, None]
        if strobe.free_time:
            matrix = np.column_stack([matrix, by_time * time / metric.sizes])
        step = np.linalg.lstsq(matrix, -gap / metric.sizes, rcond=1e-10)[0]
        later = time * (1.0 + float(step[-1])) if strobe.free_time else time
        return norm(step), (u + step[: strobe.n] * metric.sizes, later)

    found = newton(correct, start, Rules(settled=SETTLED, stalled=SETTLED, far=1.0, budget=STEPS))
    if found is not None and not found.exhausted:
        gap, product, _ = _returned(strobe, found.at[0], q, found.at[1], value)
        if np.abs(gap / metric.sizes).max() < 100.0 * SETTLED:
            return found.at[0], np.abs(np.linalg.eigvals(product))
    raise NoSolutionError("no periodic solution is found")
