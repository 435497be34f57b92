"""Does a declared substitution u -> g(u) map solutions to solutions? Checked by sampling numbers.

For a flow u' = f(u):  Dg(u) f(u) = f(g(u)).   For a map:  g(f(u)) = f(g(u)), angles modulo their period.
"""

from __future__ import annotations

import math
import random
import warnings
from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from contin.model.dual import directional
from contin.model.evaluate import evaluate_all
from contin.model.expression import Expression, depends_on, number, symbol
from contin.model.parts import TIME, State, Symmetry
from contin.model.source import Problems
from contin.model.values import parameter_values

SAMPLES: Final = 5  # random points at which the equations are finite
TRIES: Final = 60
TOLERANCE: Final = 1e-8  # of the larger side, or of the largest component
_RANK_LIMIT: Final = 150  # states; Dg is tested for rank up to this size


def check_symmetries(parts: Mapping[str, Any], problems: Problems) -> None:
    """Note every symmetry that the equations do not have, with the equation that breaks it and by how much."""
    states: tuple[State, ...] = parts["states"]
    for symmetry in parts["symmetries"]:
        message = _broken(symmetry, states, parts)
        if message:
            problems.add(("symmetries", symmetry.name), message, key=True)


def _broken(symmetry: Symmetry, states: Sequence[State], parts: Mapping[str, Any]) -> str:
    names = [s.name for s in states]
    equations: tuple[Expression, ...] = parts["equations"]
    images = [symmetry.map.get(n, symbol(n)) for n in names]
    if depends_on_time(images):
        return "a symmetry cannot depend on time"
    defaults = parameter_values(parts["parameters"], [])
    periods = [float(v) for v in evaluate_all([s.period or number(0) for s in states], defaults)]
    chance = random.Random(f"{symmetry.name} {names}")  # the same points every time
    done = 0
    for attempt in range(TRIES):
        if done == SAMPLES:
            return ""
        point = _sample(names, defaults, states, chance, attempt)
        sides = _sides(names, equations, images, point, parts["kind"])
        if sides is None:
            continue
        done += 1
        left, right = sides
        gap = np.abs(left - right)
        if parts["kind"] == "map":
            for i, period in enumerate(periods):
                if period > 0:
                    gap[i] = abs(math.remainder(left[i] - right[i], period))
        scale = np.maximum(np.maximum(np.abs(left), np.abs(right)), 1e-3 * max(1.0, float(np.abs(right).max())))
        worst = int(np.argmax(gap / scale))
        if gap[worst] > TOLERANCE * scale[worst]:
            return _message(names, worst, left, right, point)
        if len(names) <= _RANK_LIMIT and done == 1 and _loses_rank(names, images, point):
            return "not a symmetry: the substitution is not one-to-one"
    if done == 0:
        warnings.warn(
            f"symmetry {symmetry.name} was not checked: the equations are not finite at any sampled point", stacklevel=2
        )
    return ""


def depends_on_time(expressions: Sequence[Expression]) -> bool:
    """True where the time of a forced flow occurs."""
    return any(depends_on(e, [TIME]) for e in expressions)


def _sample(
    names: list[str], defaults: Mapping[str, float], states: Sequence[State], chance: random.Random, attempt: int
) -> dict[str, float]:
    """A random point: general at first, nearer to the default guess when the equations are not finite there."""
    point = {name: v * chance.uniform(0.6, 1.4) + chance.uniform(-0.01, 0.01) for name, v in defaults.items()}
    if attempt > TRIES // 2:
        point = dict(defaults)
    spread = 1.0 if attempt < TRIES // 3 else 0.1
    guesses = evaluate_all([s.value for s in states], defaults)
    for name, guess in zip(names, guesses, strict=True):
        centre = float(guess) if math.isfinite(guess) else 0.0
        point[name] = centre + spread * (1.0 + 0.3 * abs(centre)) * chance.uniform(-1.0, 1.0)
    point[TIME] = chance.uniform(0.0, 1.0)
    return point


def _sides(
    names: list[str],
    equations: Sequence[Expression],
    images: Sequence[Expression],
    point: dict[str, float],
    kind: str,
) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """The two sides of the condition, or None where they are not finite."""
    value = dict(zip(names, evaluate_all(equations, point), strict=True))
    image = dict(zip(names, evaluate_all(images, point), strict=True))
    after = evaluate_all(equations, {**point, **image})
    if kind == "map":
        before = evaluate_all(images, {**point, **value})
    else:
        before = directional(images, point, value)
    left, right = np.array(before, dtype=float), np.array(after, dtype=float)
    return (left, right) if np.all(np.isfinite(left)) and np.all(np.isfinite(right)) else None


def _loses_rank(names: list[str], images: Sequence[Expression], point: Mapping[str, float]) -> bool:
    columns = [directional(images, point, {name: 1.0}) for name in names]
    jacobian = np.array(columns, dtype=float)
    return bool(np.all(np.isfinite(jacobian)) and np.linalg.matrix_rank(jacobian) < len(names))


def _message(
    names: list[str],
    worst: int,
    left: NDArray[np.float64],
    right: NDArray[np.float64],
    point: Mapping[str, float],
) -> str:
    where = ", ".join(f"{k} = {v:.4g}" for k, v in list(point.items())[:10] if k != TIME)
    return (
        f"not a symmetry of the equations: the equation of {names[worst]} gives {right[worst]:.6g} at the image of a "
        f"point, and the image of the motion is {left[worst]:.6g}, a "
        f"difference of {abs(left[worst] - right[worst]):.2g} (at {where}{', ...' if len(point) > 11 else ''})"
    )
