"""Invariant circles along a parameter by pseudo-arclength, from where they have no size, to where they end."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from contin.abi import Array
from contin.errors import NoSolutionError
from contin.machine import elementary
from contin.tori import fourier
from contin.tori.equations import Circle, Metric, Solved, solve
from contin.tori.locking import Locked, locked_at, slowing
from contin.tori.looks import error_of, residual_between
from contin.tori.strobe import Strobe

FINE: Final = 1e-6  # relative residual of a circle between its nodes, beyond which it gets more of them
POOR: Final = 1e-4  # ... and relative error
BROKEN: Final = 1e-3  # ... which a circle with the most nodes may have, and what else is no circle any more
GAIN: Final = 3.0  # more nodes are no use that do not make the error so many times smaller
GROWTH: Final = 1.4  # of the number of nodes at a time
MOST_NODES: Final = 201
MOST_UNKNOWNS: Final = 1200
CREEPING: Final = 0.02  # of the longest step so far: a step so short tries leaps first, over a resonance
LEAPS: Final = (30.0, 10.0, 3.0)
TRIES: Final = (0.6, 1.5, 0.3, 2.3, 0.15, 0.06, 0.02)  # steps beside one that fails: resonances are narrow gaps
BEYOND: Final = (0.5, 1.0, 2.0, 4.0, 8.0, 16.0)  # steps from the last circle where periodic solutions are looked for
QUICKER: Final = 1.4  # of the step, after one that went well


@dataclass(frozen=True)
class Plan:
    """How a family is followed: steps in the metric, the most rows, the largest turn (degrees), Newton's tolerance."""

    bounds: tuple[float, float]
    step: float = 0.01
    least: float = 1e-6
    largest: float = 0.05
    steps: int = 200
    angle: float = 15.0
    tolerance: float = 1e-9
    nodes: int | None = None  # a fixed number of them


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


def most_nodes(strobe: Strobe) -> int:
    return min(MOST_NODES, MOST_UNKNOWNS // strobe.n) | 1


def follow(strobe: Strobe, metric: Metric, first: Circle, tangent: Array, plan: Plan) -> Iterator[Row | Stop]:
    """Rows from `first` (a circle without size, to which `tangent` gives one), and at last why there is no other."""
    circle, step, name = first, plan.step, strobe.system.parameter_names[strobe.active]
    seen: list[Circle] = []
    taken: list[float] = []
    for _ in range(plan.steps):
        found = None
        troubles: list[str] = []
        for length in _lengths(step, max(taken, default=step), plan):
            try:
                found = _next(strobe, metric, circle, tangent, length, plan, bool(seen))
                break
            except NoSolutionError as error:
                troubles.append(str(error))
        if found is None:
            yield _lost(strobe, metric, seen, tangent, step, troubles, plan)
            return
        if seen and _passed(circle, found.circle, metric):
            yield _shrunk([*seen[-2:], found.circle], metric, name)
            return
        outside = not plan.bounds[0] <= found.circle.value <= plan.bounds[1]
        if outside:
            edge = plan.bounds[0] if found.circle.value < plan.bounds[0] else plan.bounds[1]
            yield from _edge(strobe, metric, circle, found.circle, edge, plan, name)
            return
        if found.error > BROKEN:
            yield found
            yield _broken(strobe, metric, seen, found, name)
            return
        yield found
        seen.append(found.circle)
        circle, tangent = found.circle, found.solved.tangent
        taken.append(length)
        step = min(plan.largest, length * QUICKER if length >= step else length)
    yield Stop("steps", f"all {plan.steps} steps used up")


def _lengths(step: float, longest: float, plan: Plan) -> list[float]:
    """Steps to be tried in turn: some are longer, to get over a resonance."""
    parts = [*(LEAPS if step < CREEPING * longest else ()), 1.0, *TRIES]
    return [part * step for part in parts if plan.least <= part * step <= plan.largest]


def _next(
    strobe: Strobe, metric: Metric, circle: Circle, tangent: Array, step: float, plan: Plan, turning: bool
) -> Row:
    """The circle a step on, with as many nodes as its error needs."""
    guess = _ahead(circle, tangent, step, metric)
    solved = solve(strobe, metric, guess, tangent, plan.tolerance, fixed=False)
    turn = float(np.clip(solved.tangent @ tangent, -1.0, 1.0))
    if turning and turn < elementary.cos(np.deg2rad(plan.angle)):
        raise NoSolutionError("the branch turns by more than the largest angle")
    if plan.bounds[0] <= solved.circle.value <= plan.bounds[1]:
        return _refined(strobe, metric, solved, plan)
    return Row(solved, 0.0)


def _refined(strobe: Strobe, metric: Metric, solved: Solved, plan: Plan) -> Row:
    """With as many nodes as are of use."""
    residual = residual_between(strobe, metric, solved.circle)
    while plan.nodes is None and (residual > FINE or error_of(solved.circle, residual) > POOR):
        count = int(GROWTH * solved.circle.count) | 1
        if count > most_nodes(strobe):
            break
        finer = solved.circle.resampled(count)
        along = _resampled(solved.tangent, metric, solved.circle, count)
        solved = solve(strobe, metric, finer, along, plan.tolerance, fixed=False)
        last, residual = residual, residual_between(strobe, metric, solved.circle)
        if residual > last / GAIN and error_of(solved.circle, residual) < BROKEN:
            break
    return Row(solved, error_of(solved.circle, residual))


def _ahead(circle: Circle, tangent: Array, step: float, metric: Metric) -> Circle:
    weight = 1.0 / np.sqrt(circle.values.size)
    moved = (step * tangent[:-1]).reshape(circle.values.shape) * metric.sizes / weight
    return replace(circle, values=circle.values + moved, value=circle.value + step * float(tangent[-1]) * metric.width)


def _resampled(tangent: Array, metric: Metric, circle: Circle, count: int) -> Array:
    """The tangent at another number of nodes."""
    parts = replace(circle, values=tangent[:-1].reshape(circle.values.shape) * np.sqrt(circle.values.size))
    finer = parts.resampled(count).values
    along = np.append(finer.ravel() / np.sqrt(finer.size), tangent[-1])
    return np.asarray(along / np.linalg.norm(along))


def _passed(before: Circle, after: Circle, metric: Metric) -> bool:
    """Whether the circle went through zero size: then each of its points is on the other side."""
    a = before.resampled(after.count).deviation / metric.sizes
    return float(np.sum(a * (after.deviation / metric.sizes))) < 0.0


def _shrunk(near: list[Circle], metric: Metric, name: str) -> Stop:
    """Where the size vanishes: the parameter is an even function of the size, here a polynomial in its square."""
    squares = np.array([metric.amplitude(one) for one in near])
    squares = squares * squares
    values = [one.value for one in near]
    weights = [np.prod([b / (b - a) for b in squares if b != a]) for a in squares]
    at = float(np.dot(weights, values))
    return Stop("ns", f"the torus shrinks to a periodic solution (NS) at {name} = {at:.7g}", at)


def _edge(
    strobe: Strobe, metric: Metric, before: Circle, after: Circle, edge: float, plan: Plan, name: str
) -> Iterator[Row | Stop]:
    """The circle at a bound, between two."""
    part = (edge - before.value) / (after.value - before.value)
    near = before.resampled(after.count)
    guess = Circle(
        near.values + part * (after.values - near.values), near.rho + part * (after.rho - near.rho),
        near.time + part * (after.time - near.time), edge,
    )  # fmt: skip
    try:
        tangent = np.append(np.zeros(guess.values.size), 1.0)
        solved = solve(strobe, metric, guess, tangent, plan.tolerance, fixed=True)
        yield Row(solved, error_of(solved.circle, residual_between(strobe, metric, solved.circle)))
    except NoSolutionError as error:  # a resonance lies on the bound: the rows end before it
        yield Stop("bound", f"{name} passes {edge:.8g}, where no torus is solved for: {error}", edge)
        return
    yield Stop("bound", f"{name} reached {edge:.8g}", edge)


def _broken(strobe: Strobe, metric: Metric, seen: list[Circle], row: Row, name: str) -> Stop:
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


def _lost(
    strobe: Strobe, metric: Metric, seen: list[Circle], tangent: Array, step: float, troubles: list[str], plan: Plan
) -> Stop:
    """Why no circle is found beyond the last one."""
    name = strobe.system.parameter_names[strobe.active]
    trouble = troubles[-1] if troubles else "the step is below the smallest"
    if not seen:
        return Stop("corrector", f"no torus is found beside the point: {trouble}")
    last = seen[-1]
    apart = step * float(tangent[-1]) * metric.width
    found = _explained(strobe, metric, seen, apart, name)
    return found or Stop("corrector", f"at {name} = {last.value:.8g}: no torus a step further: {trouble}", last.value)
