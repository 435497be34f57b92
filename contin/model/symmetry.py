"""Does a declared substitution u -> g(u) map solutions to solutions? Checked by sampling numbers.

For a flow u' = f(u):  Dg(u) f(u) = f(g(u)).   For a map:  g(f(u)) = f(g(u)), angles modulo their period.
"""

from __future__ import annotations

import math
import random
import warnings
from collections.abc import Mapping
from typing import Any, Final

import numpy as np

from contin.model.dual import directional
from contin.model.evaluate import evaluate_all
from contin.model.expression import Expression, depends_on, number, postorder, symbol
from contin.model.parts import TIME, State, Symmetry
from contin.model.source import Problems
from contin.model.values import parameter_values
from contin.model.vocabulary import PIECEWISE
from contin.records import Record

SAMPLES: Final = 5  # random points at which the equations are finite
TRIES: Final = 60
FAR_SAMPLES: Final = 60  # ... and of piecewise equations, farther away: beyond surfaces that no point near the start is
DECADES: Final = 5  # of distances, from 1
TOLERANCE: Final = 1e-8  # of the larger side
DIGITS: Final = 40  # of the second look at a difference, which may be rounding
_FLOOR: Final = 1e-25  # of the largest component: below it both sides are zero in the second look
_RANK_LIMIT: Final = 150  # states; Dg is tested for rank up to this size


def check_symmetries(parts: Record, problems: Problems) -> None:
    """Note every symmetry that the equations do not have, with the equation that breaks it and by how much."""
    for symmetry in parts["symmetries"]:
        message = _Check(symmetry, parts).run()
        if message:
            problems.add(("symmetries", symmetry.name), message, key=True)


class _Check:
    """One symmetry of one system."""

    def __init__(self, symmetry: Symmetry, parts: Record) -> None:
        self.symmetry = symmetry
        self.states: tuple[State, ...] = parts["states"]
        self.names = [s.name for s in self.states]
        self.equations: tuple[Expression, ...] = parts["equations"]
        self.images = [symmetry.map.get(n, symbol(n)) for n in self.names]
        self.is_map = parts["kind"] == "map"
        self.defaults = parameter_values(parts["parameters"], [])
        periods = evaluate_all([s.period or number(0) for s in self.states], self.defaults)
        self.periods = [float(v) if self.is_map else 0.0 for v in periods]

    def run(self) -> str:
        """Why it is not a symmetry, or an empty text."""
        if any(depends_on(image, [TIME]) for image in self.images):
            return "a symmetry cannot depend on time"
        chance = random.Random(f"{self.symmetry.name} {self.names}")  # the same points every time
        done = 0
        for attempt in range(TRIES):
            if done == SAMPLES:
                return self.far_away(chance)
            point = self.sample(chance, attempt)
            sides = self.sides(point, math)
            if not all(math.isfinite(v) for side in sides for v in side):
                continue
            done += 1
            worst = self.broken(point, *sides)
            if worst is not None:
                return self.message(worst, point)
            if done == 1 and len(self.names) <= _RANK_LIMIT and self.loses_rank(point):
                return "not a symmetry: the substitution is not one-to-one"
        if done == 0:
            name = self.symmetry.name
            reason = "the equations are not finite at any sampled point"
            warnings.warn(f"symmetry {name} was not checked: {reason}", stacklevel=2)
        return ""

    def far_away(self, chance: random.Random) -> str:
        """Of piecewise equations: why it is no symmetry where other formulas hold than near the start."""
        if not any(node.op in PIECEWISE for node in postorder(self.equations)):
            return ""
        for k in range(FAR_SAMPLES):
            point = self.sample(chance, 0, float(10 ** (k % DECADES)))
            try:
                sides = self.sides(point, math)
            except (OverflowError, ValueError, ZeroDivisionError):  # the equations have no value there
                continue
            finite = all(math.isfinite(v) for side in sides for v in side)
            worst = self.broken(point, *sides) if finite else None
            if worst is not None:
                return self.message(worst, point)
        return ""

    def sample(self, chance: random.Random, attempt: int, reach: float = 1.0) -> dict[str, float]:
        """A random point: general at first, nearer to the default guess when the equations are not finite there."""
        if attempt > TRIES // 2:
            point = dict(self.defaults)
        else:
            point = {n: v * chance.uniform(0.6, 1.4) + chance.uniform(-0.01, 0.01) for n, v in self.defaults.items()}
        spread = reach if attempt < TRIES // 3 else 0.1
        guesses = evaluate_all([s.value for s in self.states], self.defaults)
        for name, guess in zip(self.names, guesses, strict=True):
            centre = float(guess) if math.isfinite(guess) else 0.0
            point[name] = centre + spread * (1.0 + 0.3 * abs(centre)) * chance.uniform(-1.0, 1.0)
        point[TIME] = chance.uniform(0.0, 1.0)
        return point

    def sides(self, point: Record, lib: object) -> tuple[list[Any], list[Any]]:
        """The two sides of the condition at one point."""
        value = dict(zip(self.names, evaluate_all(self.equations, point, lib), strict=True))
        image = dict(zip(self.names, evaluate_all(self.images, point, lib), strict=True))
        after = evaluate_all(self.equations, {**point, **image}, lib)
        if self.is_map:
            return evaluate_all(self.images, {**point, **value}, lib), after
        return directional(self.images, point, value, lib), after

    def broken(self, point: Mapping[str, float], before: list[Any], after: list[Any]) -> int | None:
        """The equation with the largest relative difference of the two sides at a point, if that is not rounding."""
        if max(self.gaps(before, after)) <= TOLERANCE:
            return None
        import mpmath

        with mpmath.workdps(DIGITS):
            left, right = self.sides({n: mpmath.mpf(v) for n, v in point.items()}, mpmath)
            gaps = self.gaps(left, right, _FLOOR * (1 + max(abs(v) for v in right)))
        worst = max(range(len(gaps)), key=gaps.__getitem__)
        return worst if gaps[worst] > TOLERANCE else None

    def gaps(self, left: list[Any], right: list[Any], floor: object = 0.0) -> list[float]:
        """Difference of the sides, equation by equation, relative to the larger one; angles modulo their period."""
        found = []
        for a, b, period in zip(left, right, self.periods, strict=True):
            gap = abs(a - b)
            if period > 0:
                gap = abs(math.remainder(float(a - b), period))
            scale = max(abs(a), abs(b), period)
            found.append(0.0 if gap <= floor or scale == 0 else float(gap / scale))
        return found

    def loses_rank(self, point: Mapping[str, float]) -> bool:
        columns = [directional(self.images, point, {name: 1.0}) for name in self.names]
        jacobian = np.array(columns, dtype=float)
        return bool(np.all(np.isfinite(jacobian)) and np.linalg.matrix_rank(jacobian) < len(self.names))

    def message(self, worst: int, point: Mapping[str, float]) -> str:
        left, right = (side[worst] for side in self.sides(point, math))
        where = ", ".join(f"{k} = {v:.4g}" for k, v in list(point.items())[:10] if k != TIME)
        return (
            f"not a symmetry of the equations: the equation of {self.names[worst]} gives {right:.6g} at the image of a "
            f"point, and the image of the motion is {left:.6g}, a difference of {abs(left - right):.2g} "
            f"(at {where}{', ...' if len(point) > 11 else ''})"
        )
