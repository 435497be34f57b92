"""Families of orbits that turn round again and again, each time with a longer period: they have no end.

Beside orbits homoclinic to a periodic orbit the folds of a family accumulate, in turn, at the two parameter values
where its invariant manifolds are tangent, and every two turns add one more loop near that orbit: its period.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import pairwise
from typing import Final

from contin.continuation.arm import Arm
from contin.continuation.branch import End
from contin.continuation.segment import Segment

TURNS: Final = 4  # folds on each side from which two limits are foretold
SHRINKING: Final = 0.5  # distance of two folds on one side, relative to that of the two before, at most
EVEN: Final = 0.1  # ... and by how much two such ratios differ at most
REGULAR: Final = 0.02  # relative difference of the last two gains of period
ALIKE: Final = 0.1  # ... and of the gains on the two sides
APART: Final = 10.0  # the two limits are further apart than their sides' last folds, times this


def until_repeating(segments: Iterable[Segment], arm: Arm) -> Iterator[Segment]:
    """The segments of an arm, up to the fold at which it is clear that there will always be another."""
    if arm.problem.kind != "orbit":
        yield from segments
        return
    folds: list[tuple[float, float]] = []  # parameter, period
    for segment in segments:
        for mark in segment.found:
            if mark.point.type == "LPC":
                z = mark.point.z
                folds.append((float(z[-1]), float(arm.problem.columns(z[None])["period"][0])))
        yield segment
        end = None if arm.is_over() else _repeats(folds, arm)
        if end is not None:
            arm.end = end
            return


def _repeats(folds: list[tuple[float, float]], arm: Arm) -> End | None:
    if len(folds) < 2 * TURNS:
        return None
    recent = folds[-2 * TURNS :]
    limits, gains = [], []
    for side in (recent[0::2], recent[1::2]):
        moves = [b[0] - a[0] for a, b in pairwise(side)]
        periods = [b[1] - a[1] for a, b in pairwise(side)]
        if 0.0 in moves or min(periods) <= 0.0:
            return None
        ratio, before = moves[-1] / moves[-2], moves[-2] / moves[-3]
        if not abs(ratio) < SHRINKING or abs(ratio - before) > EVEN or abs(periods[-1] / periods[-2] - 1.0) > REGULAR:
            return None
        limits.append((side[-1][0] + moves[-1] * ratio / (1.0 - ratio), abs(moves[-1])))
        gains.append(periods[-1])
    (a, last_a), (b, last_b) = sorted(limits)
    if abs(gains[0] / gains[1] - 1.0) > ALIKE or b - a < APART * (last_a + last_b):
        return None
    name, gain = arm.problem.parameters[0], 0.5 * (gains[0] + gains[1])
    text = (
        f"the family turns round for ever, near {name} = {a:.8g} and {b:.8g}, and every two turns add {gain:.5g} to "
        "its period: orbits homoclinic to a periodic orbit of about that period exist between these values"
    )
    data = {
        "at": {name: 0.5 * (a + b)}, "error": 0.5 * (b - a), "between": [a, b], "cycle": {"period": gain},
        "saddle": None, "eigenvalues": [], "saddle_quantity": None, "spiral": True,
    }  # fmt: skip
    return End("homoclinic", text, data)
