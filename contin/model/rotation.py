"""Do the equations commute with a declared rotation u' = xi(u), that is, Df(u) xi(u) = Dxi(u) f(u)? Sampled."""

from __future__ import annotations

import math
import random
from typing import Final

from contin.model.dual import directional
from contin.model.evaluate import evaluate_all
from contin.model.expression import number
from contin.model.source import Problems
from contin.model.values import parameter_values
from contin.records import Record

SAMPLES: Final = 3
TRIES: Final = 30
TOLERANCE: Final = 1e-8  # of the largest component


def check_rotation(parts: Record, problems: Problems) -> None:
    """Note the component in which the two sides differ most, if they do."""
    names = [s.name for s in parts["states"]]
    generator = [parts["rotation"].get(n, number(0)) for n in names]
    defaults = parameter_values(parts["parameters"], [])
    chance = random.Random("rotation")
    done = 0
    for _ in range(TRIES):
        point = {n: v * chance.uniform(0.7, 1.3) for n, v in defaults.items()}
        point |= {n: chance.uniform(-1.5, 1.5) for n in names}
        along = dict(zip(names, evaluate_all(generator, point), strict=True))
        motion = dict(zip(names, evaluate_all(parts["equations"], point), strict=True))
        left, right = directional(parts["equations"], point, along), directional(generator, point, motion)
        if not all(math.isfinite(v) for v in (*left, *right)):
            continue
        gaps = [abs(a - b) for a, b in zip(left, right, strict=True)]
        scale = max(1e-3, *(abs(v) for v in (*left, *right)))
        if max(gaps) > TOLERANCE * scale:
            worst = names[gaps.index(max(gaps))]
            problems.add(
                ("rotation",),
                f"not a symmetry of the equations: Df xi = Dxi f fails by {max(gaps):.2g} in the component {worst}",
                key=True,
            )
            return
        done += 1
        if done == SAMPLES:
            return
