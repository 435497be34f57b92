"""Why a family of invariant circles ends: it shrinks, locks, becomes homoclinic, or is not resolved any more."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from contin.abi import Array
from contin.tori import fourier
from contin.tori.equations import Circle, Metric, Solved
from contin.tori.locking import Locked, locked_at, slowing
from contin.tori.strobe import Strobe

BEYOND: Final = (0.5, 1.0, 2.0, 4.0, 8.0, 16.0)  # steps from the last circle where periodic solutions are looked for


@dataclass(frozen=True)
class Stop:
    """Why a family ends; `at` is the parameter there where it is known."""

    reason: str
    text: str
    at: float | None = None
    locked: Locked | None = None


@dataclass(frozen=True, eq=False)
class Row:
    """A circle, with its relative error between the nodes."""

    solved: Solved
    error: float

    @property
    def circle(self) -> Circle:
        return self.solved.circle

    @property
    def tail(self) -> float:
        """The part that the highest third of the Fourier modes have of the circle."""
        return fourier.tail(self.circle.values)


def shrunk(near: list[Circle], metric: Metric, name: str) -> Stop:
    """Where the size vanishes: the parameter is an even function of the size, here a polynomial in its square."""
    squares = np.array([metric.amplitude(one) for one in near])
    squares = squares * squares
    values = [one.value for one in near]
    weights = [np.prod([b / (b - a) for b in squares if b != a]) for a in squares]
    at = float(np.dot(weights, values))
    return Stop("ns", f"the torus shrinks to a periodic solution (NS) at {name} = {at:.7g}", at)


def broken(strobe: Strobe, metric: Metric, seen: list[Circle], row: Row, name: str) -> Stop:
    """Of a circle with too large an error: it may be that the motion on it has locked, or slows down."""
    tail, circle = row.tail, row.circle
    apart = circle.value - (seen[-1].value if seen else circle.value)
    found = _explained(strobe, metric, [*seen, circle], apart, name)
    return found or Stop(
        "breaks",
        f"the torus is not resolved any more at {name} = {circle.value:.8g}: with {circle.count} nodes the highest "
        f"third of its Fourier modes holds {tail:.2g} of it, and its error is {row.error:.2g}",
        circle.value,
    )


def _explained(strobe: Strobe, metric: Metric, seen: list[Circle], apart: float, name: str) -> Stop | None:
    """What periodic solutions on the last circle, or beyond it, tell."""
    slow = slowing(strobe, metric, seen)
    if slow is not None:
        returns = abs(1.0 / (seen[-1].rho * slow.q - slow.p))
        words = (
            f"the motion on the torus slows down without bound at {name} = {slow.value:.8g} (a turn takes "
            f"{returns:.4g} returns): the torus becomes homoclinic to {slow.words}"
        )
        return Stop("homoclinic", words, slow.value, slow)
    locked = locked_at(strobe, metric, seen[-1], [seen[-1].value + part * apart for part in BEYOND])
    if locked is None:
        return None
    at = f"{name} = {locked.value:.8g}"
    words = f"the rotation number locks to {locked.p}/{locked.q}: at {at} {locked.words} lies on the torus"
    return Stop("locked", words, locked.value, locked)


def lost(strobe: Strobe, metric: Metric, seen: list[Circle], tangent: Array, step: float, troubles: list[str]) -> Stop:
    """Why no circle is found beyond the last one."""
    name = strobe.system.parameter_names[strobe.active]
    trouble = troubles[-1] if troubles else "the step is below the smallest"
    if not seen:
        return Stop("corrector", f"no torus is found beside the point: {trouble}")
    last = seen[-1]
    apart = step * float(tangent[-1]) * metric.width
    found = _explained(strobe, metric, seen, apart, name)
    return found or Stop("corrector", f"at {name} = {last.value:.8g}: no torus a step further: {trouble}", last.value)
