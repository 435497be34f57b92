"""Invariant circles along a parameter by pseudo-arclength, from where they have no size, to where they end."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from contin.abi import Array
from contin.errors import NoSolutionError
from contin.machine import elementary
from contin.tori.ends import Row, Stop, broken, lost, shrunk
from contin.tori.equations import Circle, Metric, Solved, solve
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
            yield lost(strobe, metric, seen, tangent, step, troubles)
            return
        if seen and _passed(circle, found.circle, metric):
            yield shrunk([*seen[-2:], found.circle], metric, name)
            return
        outside = not plan.bounds[0] <= found.circle.value <= plan.bounds[1]
        if outside:
            edge = plan.bounds[0] if found.circle.value < plan.bounds[0] else plan.bounds[1]
            yield from _edge(strobe, metric, circle, found.circle, edge, plan, name)
            return
        if found.error > BROKEN:
            yield found
            yield broken(strobe, metric, seen, found, name)
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
        along = _resampled(solved.tangent, solved.circle, count)
        solved = solve(strobe, metric, finer, along, plan.tolerance, fixed=False)
        last, residual = residual, residual_between(strobe, metric, solved.circle)
        if residual > last / GAIN and error_of(solved.circle, residual) < BROKEN:
            break
    return Row(solved, error_of(solved.circle, residual))


def _ahead(circle: Circle, tangent: Array, step: float, metric: Metric) -> Circle:
    weight = 1.0 / np.sqrt(circle.values.size)
    moved = (step * tangent[:-1]).reshape(circle.values.shape) * metric.sizes / weight
    return replace(circle, values=circle.values + moved, value=circle.value + step * float(tangent[-1]) * metric.width)


def _resampled(tangent: Array, circle: Circle, count: int) -> Array:
    """The tangent at another number of nodes."""
    parts = replace(circle, values=tangent[:-1].reshape(circle.values.shape) * np.sqrt(circle.values.size))
    finer = parts.resampled(count).values
    along = np.append(finer.ravel() / np.sqrt(finer.size), tangent[-1])
    return np.asarray(along / np.linalg.norm(along))


def _passed(before: Circle, after: Circle, metric: Metric) -> bool:
    """Whether the circle went through zero size: then each of its points is on the other side."""
    a = before.resampled(after.count).deviation / metric.sizes
    return float(np.sum(a * (after.deviation / metric.sizes))) < 0.0


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
