"""Extrema (EX) of a parameter or column along a curve: zeros of its derivative by arclength.

The derivative of a column c along the curve is that of c(z) along the tangent, by the five-point difference: of order
four in the step, so that its zero is as good as c itself is (an error of c of 1e-16 moves it by some 1e-13).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from contin.abi import Array
from contin.continuation.curve import Stretch
from contin.continuation.location.found import Found, Note, where
from contin.continuation.outcome import Verified
from contin.continuation.problem import Problem, in_two_parameters
from contin.continuation.sample import Chunk, Frame, Sample
from contin.continuation.settings import Settings
from contin.linalg.vectors import dot
from contin.machine import elementary

STEP = 1e-3  # of the differences (scaled arclength)
ACCURACY = 1e-12  # of the place (scaled arclength)
TURNING = 1e-6  # part of the tangent below which the parameter stands still
SIDES = (-2.0 * STEP, -STEP, STEP, 2.0 * STEP)
SCATTER = 10.0  # times the scatter of a column, by which it must fall on the way from an extremum
CLEAR = 1e6  # times the scatter, beyond which that of points solved for again is no question
ALONG = 0.9  # cosine between the tangents on both sides of a point from which on that in the middle is
ASIDE = 0.5  # along another branch, with this one
NUDGE = 1e-9  # of the guesses from which they are: small, for another solution may be near
SAFETY = 2.0  # of a change from one mesh to the next: the finer one has an error of its own
FOURTH = np.array([1.0, -4.0, -4.0, 1.0, 6.0]) / 70.0  # at `SIDES` and 0, whose largest part is off a cubic there
CLOSER = 0.03  # of the steps, to look at what is not smooth within them
SMOOTH = 0.1  # of what the slope changes in a step: more than that off a quadratic is a corner, or errors of the column
FALLS = 0.3  # part that is left closer by: of the scatter at a corner, of the kink where the column is smooth
AT_CORNER = "where the curve has a corner"
NOT_ON_MESH = "on this mesh but not on a finer one"
NOT_FOLLOWED = "the curve cannot be followed on both sides"
HELD = 1e100  # an unknown in so large a scale is none: as the section of orbits by shooting, it counts for nothing
FAR = 100.0  # times the change of a column at an extremum from one mesh to the next: that beside it is no question
TRUNCATED = 1e-11  # part of a second derivative that no difference tells better
EPSILON = float(np.finfo(float).eps)
SIGNS = np.array([[1, 1, 1, 1, 1], [1, -1, 1, -1, -1], [-1, 1, 1, -1, 1], [1, 1, -1, -1, -1]], dtype=float)
# of rounding errors in succession

Finer: TypeAlias = tuple[Problem, Sample, Frame]  # a point as it is solved for on a finer mesh


@dataclass(frozen=True)
class Look:
    """A column next to a point, within two steps."""

    bend: float  # its second derivative by arclength
    scatter: float  # how far it is off a cubic
    kink: float  # how far its slopes are off a quadratic: about the jump of the slope at a corner
    step: float

    @property
    def is_smooth(self) -> bool:
        return self.kink <= SMOOTH * abs(self.bend) * self.step


@dataclass(frozen=True)
class Extremum:
    """`column` (a varying parameter, a state or an observable) is to be labelled where it turns."""

    column: str

    def slopes(self, problem: Problem, z: Array, tangents: Array, scale: Array) -> Array:
        """dc/ds at rows z with their unit tangents (scaled), (R,)."""
        if self.column == problem.parameters[0]:
            return np.asarray(tangents[:, -1] * scale[-1])
        step = STEP * scale * tangents
        around = np.concatenate([z + side / STEP * step for side in SIDES])
        before2, before1, after1, after2 = self.values(problem, around).reshape(len(SIDES), -1)
        return np.asarray((8.0 * (after1 - before1) - (after2 - before2)) / (12.0 * STEP))

    def values(self, problem: Problem, z: Array) -> Array:
        return np.asarray(problem.column(self.column, z), dtype=float)

    def slope(self, stretch: Stretch, sample: Sample) -> float:
        """dc/ds at one sample."""
        return float(self.slopes(stretch.problem, sample.z[None], sample.tangent[None], stretch.frame.scale)[0])

    def rounding(self, problem: Problem, z: Array, scale: Array) -> float:
        """What rounding of the unknowns, relative to their scales, and of the column itself makes of it near z."""
        moving = np.where(scale < HELD, scale, 0.0)
        around = z + EPSILON * moving * SIGNS[:, np.arange(z.size) % SIGNS.shape[1]]
        values = self.values(problem, np.vstack([z, around]))
        return float(np.abs(values[1:] - values[0]).max() + EPSILON * abs(values[0]))

    def zero(self, stretch: Stretch, a: Sample, b: Sample) -> tuple[Sample, float]:
        """The point between two at which the slopes have different signs where it vanishes; how well it is known."""

        def slope(sample: Sample) -> float:
            return self.slope(stretch, sample)

        a, b = stretch.zero(slope, a, b, ACCURACY)
        return (a if abs(slope(a)) <= abs(slope(b)) else b), stretch.distance(a, b)

    def verified(
        self, stretch: Stretch, near: Sample, width: float, ends: tuple[Sample, Sample], rising: bool
    ) -> Found | Note | None:
        """The extremum at a zero of the slope, between two ends at which the column is on the other side.

        A note where the curve cannot be followed on both sides, as beside a corner. None where the column does not
        stand out of its own scatter: one that is constant along the curve turns nowhere, although rounding gives its
        slopes signs.
        """
        problem, scale = stretch.problem, stretch.frame.scale
        rounding = self.rounding(problem, near.z, scale)
        look, corner = self._seen(stretch, near)
        if look is None or _is_aside(near, ends):
            return Note(where(stretch, near, f"EX not verified: {self.column} turns where {NOT_FOLLOWED}"))
        if not self._stands_out(stretch, near, 0.0 if corner else look.scatter, ends, rising, rounding):
            return None
        finer = problem.refined(near, stretch.frame)
        if not self._stands_out_of_mesh(stretch, near, finer, ends, rising):
            return None
        if corner:
            return Note(where(stretch, near, f"EX not verified: {self.column} turns {AT_CORNER}"))
        bend = look.bend
        if not self._turns_on_mesh(stretch, finer, bend, ends):
            return Note(where(stretch, near, f"EX not verified: {self.column} turns {NOT_ON_MESH}"))
        size = float(np.abs(self.values(problem, near.z[None]))[0])
        width += rounding / STEP / abs(bend) if bend != 0.0 else 0.0
        curvature, off = self._curvature(stretch, near, look, rounding, finer)
        kind = "maximum" if rising else "minimum"
        form = {"of": self.column, "kind": kind, "curvature": curvature, "errors": {"curvature": off}}
        places = (-1, problem.walls[-2][0] % len(near.z) - len(near.z)) if in_two_parameters(problem) else (-1,)
        error, *second = [self._error(near, scale, finer, bend, width, k) for k in places]
        residual = abs(self.slope(stretch, near)) / max(size, float(np.abs(bend)), 1e-300)
        known = dict(zip(("second",), second, strict=False))
        point = Verified("EX", near.z, residual, error, near.eigenvalues, near.unstable, form, known)
        return Found(stretch.length_of(near), point, near)

    def _curvature(
        self, stretch: Stretch, near: Sample, look: Look, rounding: float, finer: Finer | None
    ) -> tuple[float, float]:
        """The second derivative by the parameter (where that stands still: by arclength), and its error."""
        scale = stretch.frame.scale
        turning = abs(float(near.tangent[-1])) <= TURNING

        def by_parameter(bend: float, sample: Sample, scale: Array) -> float:
            return bend if turning else bend / elementary.square(float(sample.tangent[-1] * scale[-1]))

        here = by_parameter(look.bend, near, scale)
        problem, sample, frame = (stretch.problem, near, stretch.frame) if finer is None else finer
        # with half the steps what is truncated and what scatters are others, on a finer mesh its errors, too
        closer = self._look(Stretch(problem, sample, frame, stretch.settings), sample, 0.5 * look.step)
        moved = abs(here) if closer is None else abs(by_parameter(closer.bend, sample, frame.scale) - here)
        least = 2.0 * rounding / (STEP * look.step) + TRUNCATED * abs(look.bend)
        return here, SAFETY * moved + abs(by_parameter(least, near, scale))

    def _turns_on_mesh(self, stretch: Stretch, finer: Finer | None, bend: float, ends: tuple[Sample, Sample]) -> bool:
        """True where the slope changes its sign on a finer mesh, too: beside its zero there, or between the ends."""
        if finer is None or bend == 0.0:
            return True
        problem, sample, frame = finer
        here = Stretch(problem, sample, frame, stretch.settings)
        aside = max(STEP, 2.0 * abs(self.slope(here, sample) / bend))
        signs: list[bool] = []
        if aside <= stretch.distance(*ends):
            for length in (-aside, aside):
                guess = sample.z + length * frame.scale * sample.tangent
                found = problem.probe(sample, length, guess, frame, stretch.settings)
                if found is None:
                    return True  # the column was seen to fall on both sides
                signs.append(self.slope(here, found) * bend > 0.0)
        if signs == [False, True]:
            return True
        far: list[bool] = []
        for end in ends:  # at a branch point the curve through the point itself may be the other one
            refined = stretch.problem.refined(end, stretch.frame)
            if refined is None:
                return False
            other, there, metric = refined
            far.append(self.slope(Stretch(other, there, metric, stretch.settings), there) * bend > 0.0)
        return far == [False, True]

    def _error(self, near: Sample, scale: Array, finer: Finer | None, bend: float, width: float, k: int) -> float:
        """How well unknown k (a parameter, from the end) is known at an extremum that is known to `width`."""
        rate, unit = abs(float(near.tangent[k] * scale[k])), float(scale[k])
        error = width * rate + 0.5 * elementary.square(width) * unit + EPSILON * abs(float(near.z[k]))
        return error + self._moved_by_mesh(near, finer, bend, k)

    def _moved_by_mesh(self, near: Sample, finer: Finer | None, bend: float, k: int) -> float:
        """How far unknown k of the extremum moves on a finer mesh; 0 where nothing is discretised."""
        if finer is None or bend == 0.0:
            return 0.0
        problem, sample, frame = finer
        slope = float(self.slopes(problem, sample.z[None], sample.tangent[None], frame.scale)[0])
        ahead, rate = -slope / bend, abs(float(sample.tangent[k]))
        moved = abs(float(sample.z[k] - near.z[k])) + float(frame.scale[k]) * abs(ahead) * (rate + 0.5 * abs(ahead))
        return SAFETY * moved

    def is_constant(self, problem: Problem, chunk: Chunk, rows: int, frame: Frame, settings: Settings) -> bool:
        """True of a column that is the same in the first rows, to what it changes by where these are solved for again.

        Asked are the rows at which it is lowest and highest, of a column that hardly changes; on a finer mesh, too.
        """
        values = self.values(problem, chunk.z[:rows])
        ends = [chunk.sample(int(k)) for k in (np.argmin(values), np.argmax(values))]
        spread = float(np.ptp(values))
        if not spread <= CLEAR * max(self.rounding(problem, end.z, frame.scale) for end in ends):
            return False
        off = 0.0
        for end in ends:
            finer = problem.refined(end, frame)
            off += self._uncertainty(Stretch(problem, end, frame, settings), end)
            off += 0.0 if finer is None else self._moved_on_mesh(problem, end, finer)
        return spread <= SCATTER * off

    def _moved_on_mesh(self, problem: Problem, at: Sample, finer: Finer) -> float:
        """What the column changes by on a finer mesh."""
        return abs(float(self.values(finer[0], finer[1].z[None])[0]) - float(self.values(problem, at.z[None])[0]))

    def _stands_out(
        self, stretch: Stretch, at: Sample, scatter: float, ends: tuple[Sample, Sample], rising: bool, rounding: float
    ) -> bool:
        """True where the column is lower (at a maximum) at the ends by more than it is uncertain at all three places.

        How far a point is off the curve shows where it is solved for again. Where the column falls by more than `CLEAR`
        times its scatter beside the extremum nobody looks.
        """
        value = float(self.values(stretch.problem, at.z[None])[0])
        drops = (value - self.values(stretch.problem, np.array([end.z for end in ends]))) * (1.0 if rising else -1.0)
        scatter += rounding
        if drops.max() <= CLEAR * scatter:
            scatter += sum(self._uncertainty(stretch, sample) for sample in (at, *ends))
        return bool(drops.max() > SCATTER * scatter and drops.min() > -SCATTER * scatter)

    def _stands_out_of_mesh(
        self, stretch: Stretch, at: Sample, finer: Finer | None, ends: tuple[Sample, Sample], rising: bool
    ) -> bool:
        """True where the column falls on a finer mesh, too, by more than it differs there; or nothing is discretised.

        Along a branch that comes to rest, errors of the discretisation turn where the column itself does not.
        """
        if finer is None:
            return True
        sign = 1.0 if rising else -1.0
        values = self.values(stretch.problem, np.array([at.z, *(end.z for end in ends)]))
        drops, fine = (values[0] - values[1:]) * sign, [float(self.values(finer[0], finer[1].z[None])[0])]
        if drops.min() > FAR * abs(fine[0] - float(values[0])):
            return True
        for end in ends:
            refined = stretch.problem.refined(end, stretch.frame)
            if refined is None:
                return True
            fine.append(float(self.values(refined[0], refined[1].z[None])[0]))
        falls = (fine[0] - np.array(fine[1:])) * sign
        error = SAFETY * float(np.abs(falls - drops).max())
        return bool(falls.max() > error and falls.min() > -error)

    def _uncertainty(self, stretch: Stretch, sample: Sample) -> float:
        """How far the column changes when the point is solved for again, from guesses next to it on all sides.

        A solution farther off than Newton's tolerance is another one: beside a branch point the plane in which the
        point lies meets two curves.
        """
        problem, settings = stretch.problem, stretch.settings
        nudges = NUDGE * stretch.frame.scale * SIGNS[:, np.arange(sample.z.size) % SIGNS.shape[1]]
        guesses = np.ascontiguousarray(sample.z + nudges)
        solved = problem.probes(sample, np.zeros(len(guesses)), guesses, stretch.frame, settings)
        near = SCATTER * max(settings.tolerance, NUDGE)
        again = [other.z for other in solved if other is not None and stretch.distance(other, sample) <= near]
        return float(np.ptp(self.values(problem, np.array([sample.z, *again]))))

    def _scatter(self, problem: Problem, beside: Sequence[Sample], at: Sample) -> float:
        """How far the column is off a cubic at a point of the curve and at those beside it: no curvature is scatter.

        What is left of curvature is of order four, as in the slopes.
        """
        values = self.values(problem, np.array([*(sample.z for sample in beside), at.z]))
        return float(np.abs(FOURTH @ (values - values[-1])) * 6.0)

    def _seen(self, stretch: Stretch, at: Sample) -> tuple[Look | None, bool]:
        """The column next to a point, closer by where it is not smooth; True at a corner that is closer still."""
        look = self._look(stretch, at, STEP)
        if look is None or look.is_smooth:
            return look, False
        closer = self._look(stretch, at, CLOSER * STEP)
        if closer is not None and closer.scatter > FALLS * look.scatter:  # these are errors of the column itself
            return look, False
        return closer, closer is not None and closer.kink > FALLS * look.kink

    def _look(self, stretch: Stretch, at: Sample, step: float) -> Look | None:
        """At four points of the curve next to `at`; None where it cannot be followed there."""
        samples = []
        for side in np.array(SIDES) * (step / STEP):
            guess = at.z + side * stretch.frame.scale * at.tangent
            sample = stretch.problem.probe(at, side, guess, stretch.frame, stretch.settings)
            if sample is None:
                return None
            samples.append(sample)
        slopes = [self.slope(stretch, sample) for sample in samples]
        kink = abs(slopes[0] - 2.0 * slopes[1] + 2.0 * slopes[2] - slopes[3])
        return Look(_derivative(slopes, step), self._scatter(stretch.problem, samples, at), kink, step)


def _is_aside(near: Sample, ends: tuple[Sample, Sample]) -> bool:
    """True of a point on a branch that crosses between the ends: beside a branch point Newton's method may find it."""
    first, last = (end.tangent for end in ends)
    return dot(first, last) > ALONG and abs(dot(near.tangent, first)) < ASIDE


def _derivative(values: Sequence[float], step: float) -> float:
    """The five-point difference of values at -2, -1, 1 and 2 steps."""
    return float((8.0 * (values[2] - values[1]) - (values[3] - values[0])) / (12.0 * step))
