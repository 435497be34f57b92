"""What is labelled at the start itself, which both arms leave and neither crosses."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from contin.continuation.curve import Stretch
from contin.continuation.departure import Departure
from contin.continuation.location.extrema import Extremum
from contin.continuation.location.found import Found
from contin.continuation.location.sameness import same_point
from contin.continuation.location.targets import Wanted
from contin.continuation.location.turning import between
from contin.continuation.location.user_value import Target
from contin.continuation.outcome import Verified
from contin.continuation.sample import Frame, Sample


def found_at_start(departure: Departure, targets: Sequence[Wanted]) -> list[Found]:
    """The special points that the start coincides with, and the user values and extrema met there, in order.

    An arm begins at an ordinary start, and beside a special one: what lies between the two is looked for here. A branch
    that is born at a special point has none of these: its start is its parent's point.
    """
    if departure.seed.born:
        return []
    ends = _ends(departure) if departure.here else None
    problem, scale, known = departure.seed.problem, departure.scale, departure.known
    wanted = [
        item
        for target in targets
        for item in _met(departure, target, ends)
        if not any(same_point(problem, item.point, other, scale) for other in known)
    ]
    return sorted([*departure.here, *wanted], key=lambda item: item.length)


def _ends(departure: Departure) -> tuple[Sample, Sample] | None:
    """The points beside a special start from which its arms set out, both with the start's sense."""
    before, after = departure.origin(-1), departure.origin(1)
    return None if before is None or after is None else (before, after)


def _met(departure: Departure, target: Wanted, ends: tuple[Sample, Sample] | None) -> Iterator[Found]:
    problem, start = departure.seed.problem, departure.start
    stretch = Stretch(problem, start, Frame(departure.scale), departure.settings)
    if isinstance(target, Extremum):
        if ends is None and target.slope(stretch, start) == 0.0:  # else an arm sees the slope change its sign
            ends = _beside(stretch)
        if ends is not None and target.slope(stretch, ends[0]) * target.slope(stretch, ends[1]) < 0.0:
            yield from (item for item in between(target, stretch, *ends) if isinstance(item, Found))
    elif isinstance(target, Target):
        if float(target.values(problem, start.z[None])[0]) == target.value:
            point = departure.here[0].point if departure.here else start
            error = target.error(stretch, start)
            yield Found(0.0, Verified("UZ", start.z, 0.0, error, point.eigenvalues, point.unstable), start)
        elif ends is not None:
            a, b = (float(target.values(problem, end.z[None])[0]) - target.value for end in ends)
            found = target.locate(stretch, ends[0].z, ends[1].z) if a * b < 0.0 else None
            yield from [] if found is None else [found]


def _beside(stretch: Stretch) -> tuple[Sample, Sample] | None:
    """Points a first step before and after an ordinary start."""
    base, step = stretch.base, stretch.settings.first_step
    sides = [
        stretch.problem.probe(base, s, base.z + s * stretch.frame.scale * base.tangent, stretch.frame, stretch.settings)
        for s in (-step, step)
    ]
    return None if sides[0] is None or sides[1] is None else (sides[0], sides[1])
