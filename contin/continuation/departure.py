"""How a branch sets out: from a seed to the sample and metric that each of its arms marches from."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Protocol, runtime_checkable

from contin.abi import Array
from contin.continuation.arm import Arm
from contin.continuation.branch import End
from contin.continuation.course import Course
from contin.continuation.curve import Stretch
from contin.continuation.first_sample import first_sample
from contin.continuation.location.bounds import walls_passed
from contin.continuation.location.found import Found, Note
from contin.continuation.location.isolate import isolate
from contin.continuation.location.own_tests import own_tests
from contin.continuation.location.sameness import same_point
from contin.continuation.location.targets import Wanted
from contin.continuation.outcome import Verified
from contin.continuation.outset import oriented, passed_over, set_out
from contin.continuation.sample import Chunk, Frame, Sample
from contin.continuation.seed import Seed
from contin.continuation.segment import Segment
from contin.continuation.sentence import Sentence
from contin.continuation.settings import Settings
from contin.continuation.start_in_ranges import leaves_at_once, with_rounding, within_further_ranges
from contin.errors import InputError, NotFiniteError

FOLDS = ("LP", "LPC")


@runtime_checkable
class Configurable(Protocol):
    """A problem whose discretisation is chosen by the settings: a mesh, or shooting instead of collocation."""

    def configured(self, seed: Seed, settings: Settings) -> Seed:
        """A seed of this problem as the settings want it; every branch departs from that one."""


@dataclass(frozen=True, eq=False)
class Departure:
    """A seed made ready: metric, tangent and tests at the start, and the special points that it coincides with."""

    seed: Seed
    bounds: tuple[float, float]
    settings: Settings
    scale: Array
    start: Sample
    here: list[Found]
    known: list[Verified]  # points that are labelled already, shared by both arms
    notes: tuple[Sentence, ...] = ()  # what could not be told at the start

    def arm(
        self, sense: int, targets: Sequence[Wanted] = (), march: Callable[..., Chunk] | None = None
    ) -> tuple[Arm, list[Segment]] | End:
        """The arm against (-1) or along (+1) the start's tangent, with the rows before its first chunk; or its end.

        The end says why there is no arm.
        """
        seed, problem = self.seed, self.seed.problem
        outward = leaves_at_once(seed, self.start, sense, self.bounds)
        if outward is not None and not self._turns_here:
            return outward
        origin = self._origin(sense)
        if origin is None:
            where = f"{problem.parameters[0]} = {seed.z[-1]:.10g}"
            return End("corrector", f"no second point found from {where}. {problem.describe_failure(seed.z)}")
        passed = walls_passed(problem, origin.z, self.bounds)
        if passed:  # as at a fold on the bound that turns away from the range
            _, value, name = passed[0]
            text = f"{name} starts on its bound {value:.10g}, and the branch turns there"
            if seed.born:
                text = f"{name} reaches its bound {value:.10g} where the branch cannot be told from its start yet"
            return End("bound", text, {"value": value})
        wanted: tuple[Wanted, ...] = (*targets, *own_tests(problem))
        course = Course(
            problem, self.bounds, self.settings, wanted, self.known, seed.symmetries, foundling=seed.parent is None
        )
        plain = not seed.born and not self.here
        arm = Arm(course, origin, self.scale.copy(), oriented(self.start, sense), march, plain)
        return arm, [self._first_row(origin, sense)] if seed.born else []

    def _first_row(self, origin: Sample, sense: int) -> Segment:
        """The row of a branch that is born, with a note of what may have happened before it."""
        row = Segment.single(origin, self.scale)
        passed = passed_over(self.seed, origin, sense, self.scale)
        return row if passed is None else replace(row, notes=(*row.notes, passed), hiding=row.hiding + 1)

    @property
    def _turns_here(self) -> bool:
        """True at a start that is a fold to rounding: which way its tangent points says nothing."""
        return any(found.point.type in FOLDS for found in self.here)

    def origin(self, sense: int) -> Sample | None:
        """Where the arm of this sense sets out, with the start's sense; None where there is no such arm."""
        found = self._origin(sense) if sense in self.seed.arms else None
        return None if found is None else oriented(found, sense)

    def _origin(self, sense: int) -> Sample | None:
        start = oriented(self.start, sense)
        if not self.seed.born and not self.here:
            return start
        return set_out(self.seed, start, sense, self.scale, self.settings, self.bounds)


def depart(seed: Seed, bounds: tuple[float, float], settings: Settings) -> Departure:
    """Check the range and measure the start, discretised as the settings say; InputError for one outside the range."""
    if isinstance(seed.problem, Configurable):
        seed = seed.problem.configured(seed, settings)
    problem = seed.problem
    parameter = problem.parameters[0]
    if not bounds[0] < bounds[1]:
        raise InputError(f"range of {parameter}: the lower bound must be below the upper one; got {list(bounds)}")
    bounds = with_rounding(bounds, float(seed.z[-1]))
    if not seed.born and not bounds[0] <= seed.z[-1] <= bounds[1]:
        raise InputError(
            f"the start has {parameter} = {seed.z[-1]:.10g}, outside the range [{bounds[0]:g}, {bounds[1]:g}]"
        )
    seed = within_further_ranges(seed)
    problem = seed.problem
    scale = problem.initial_scale(seed.z, bounds) if seed.scale is None else seed.scale
    try:
        start, seen, edges = first_sample(seed, scale, settings)
        here = [item for item in seen if isinstance(item, Found)]
    except NotFiniteError:
        unfolded = problem.unfolded(seed.z, Frame(scale))
        if unfolded is None:
            raise
        start, point, beside = unfolded
        seed = replace(seed, z=point.z, beside=beside, arms=tuple(arm for arm in seed.arms if arm in beside))
        here = [Found(0.0, point, start)]
        seen, edges = [], ()
    known = [f.point for f in here]
    if seed.born:  # the parent is not a label of the branch, should it come back to it
        type_ = {"orbit": "BPC", "locus": "ZH"}.get(problem.kind, "BP")
        known.append(Verified(type_, seed.z, 0.0, 0.0, start.eigenvalues, 0))
    departure = Departure(seed, bounds, settings, scale, start, here, known)
    seen = [*seen, *(_up_to_arms(departure, *edges) if here and edges else ())]
    notes = (*(Sentence(text) for text in seed.remarks), *(item.said for item in seen if isinstance(item, Note)))
    return replace(departure, notes=notes)


def _up_to_arms(departure: Departure, a: Sample, b: Sample) -> Iterator[Note]:
    """What lies between the samples on both sides of a special start and those from which its arms set out.

    Points are added to those that are known, and labelled beside the start; what is left are notes.
    """
    problem, scale, start = departure.seed.problem, departure.scale, departure.start
    stretch = Stretch(problem, start, Frame(scale), departure.settings)
    for sense, edge in ((-1, a), (1, b)):
        origin = departure.origin(sense)
        if origin is None or origin.z.shape != edge.z.shape:
            continue
        if sense * (stretch.length_of(origin) - stretch.length_of(edge)) <= 0.0:
            continue
        low, high = (origin, edge) if sense < 0 else (edge, origin)
        for item in isolate(stretch, low, high):
            if isinstance(item, Note):
                yield item
            elif not any(same_point(problem, item.point, other, scale) for other in departure.known):
                departure.here.append(item)
                departure.known.append(item.point)
