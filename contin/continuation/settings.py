"""Settings of a continuation run; every default stands here once."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from difflib import get_close_matches

from contin.errors import InputError
from contin.limits import MOST_INTERVALS, MOST_POINTS, check_count
from contin.records import Record
from contin.special.table import checked_codes

LOOSEST_TOLERANCE = 1e-4


@dataclass(frozen=True)
class Settings:
    """How a branch is followed. Lengths are arclengths in the problem's metric, in which the parameter's range is 1.

    step, min_step, max_step : first, smallest and largest step. A straight branch across the range takes 1/max_step
    steps, half as many of a large system.
    steps : most accepted points in each direction.
    max_angle : degrees; a step whose tangent turns by more is repeated with half the length.
    tolerance : length of the last Newton correction of a point (labelled points do not depend on it: they are
        verified to full precision).
    intervals : number of mesh intervals of an orbit; by default as many as its error needs.
    points : Gauss points an interval (collocation of order 2 points at the mesh points).
    method : of orbits, "collocation" or "shooting"; by default collocation, shooting where the flow is piecewise
    smooth. stop_at : types of labelled points at which an arm ends, e.g. ("BT",).
    """

    step: float = 0.01
    min_step: float = 1e-9
    max_step: float = 0.05
    steps: int = 20_000
    max_angle: float = 15.0
    tolerance: float = 1e-9
    intervals: int | None = None
    points: int = 4
    method: str | None = None
    stop_at: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for name in ("step", "min_step", "max_step", "max_angle", "tolerance"):
            value = getattr(self, name)
            if not (isinstance(value, int | float) and math.isfinite(value) and value > 0):
                raise InputError(f"settings.{name} must be a positive number; got {value!r}")
        if self.min_step > self.max_step:
            raise InputError(f"settings.min_step must be in (0, max_step = {self.max_step}]; got {self.min_step}")
        check_count("settings.steps", self.steps, 0)
        if self.intervals is not None:
            check_count("settings.intervals", self.intervals, 3, MOST_INTERVALS)
        check_count("settings.points", self.points, 2, MOST_POINTS)
        if self.max_angle >= 90:
            raise InputError(f"settings.max_angle must be below 90 degrees; got {self.max_angle}")

    @property
    def first_step(self) -> float:
        return min(max(self.step, self.min_step), self.max_step)

    @property
    def newton_tolerance(self) -> float:
        """`tolerance`, but never so loose that test functions would be measured off the curve."""
        return min(self.tolerance, LOOSEST_TOLERANCE)

    @classmethod
    def of(cls, given: Settings | Record | None) -> Settings:
        """Settings from a mapping (a run file's `settings:`), None (the defaults) or Settings."""
        if given is None:
            return cls()
        if isinstance(given, Settings):
            return given
        known = {f.name for f in fields(cls)}
        unknown = sorted(set(given) - known)
        if unknown:
            near = get_close_matches(unknown[0], known, n=1)
            advice = f"did you mean {near[0]!r}? " if near else ""
            raise InputError(f"settings: unknown {', '.join(unknown)}: {advice}known: {', '.join(sorted(known))}")
        chosen = dict(given)
        if "stop_at" in chosen:
            stops = chosen["stop_at"]
            chosen["stop_at"] = checked_codes("settings: stop_at", (stops,) if isinstance(stops, str) else stops)
        return cls(**chosen)
