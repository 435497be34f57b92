"""How far from a special point a branch is taken up, so that nothing happens unseen between it and the next row.

Near its start a branch is z(s) = z + s direction + s^2 curvature / 2 in scaled unknowns. It is taken up at the largest
of a ladder of distances s between which and the next smaller one no test changes sign. Events nearer to the start than
both would be hidden; three things tell them: the turn of the parameter that direction and curvature foretell, the
number of unstable eigenvalues, which but for the critical ones is known at the start, and, where another eigenvalue is
nearer to the stability boundary than eigenvalues move up to s, the sample at the smallest distance.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.location.bounds import walls_passed
from contin.continuation.problem import Problem
from contin.continuation.sample import Frame, Sample
from contin.continuation.seed import Seed
from contin.continuation.sentence import Sentence
from contin.continuation.settings import Settings
from contin.machine import elementary

BEFORE_TURN = 0.3  # part of the way from a start to where the parameter turns, at which a branch is taken up
STILL_TOLD = 0.75  # part of the distance at which a branch is told from its neighbours, at which it is told as well
CRITICAL = 1e-8  # distance from the stability boundary, relative to an eigenvalue's size, of one that may be on it,
ON_CIRCLE = 1e-6  # ... of a multiplier, and
ZERO = 1e-9  # size, relative to the largest, of an eigenvalue that may be zero
MULTIPLIERS = ("orbit", "fixed-point")  # kinds of branches whose eigenvalues are multipliers


def oriented(sample: Sample, sense: int) -> Sample:
    """The sample with its tangent turned, for sense -1."""
    if sense > 0:
        return sample
    tests = sample.tests.copy()
    tests[:2] *= -1.0  # dp/ds and det [J; t] turn with the tangent
    return replace(sample, tangent=-sample.tangent, tests=tests)


def set_out(
    seed: Seed, start: Sample, sense: int, scale: Array, settings: Settings, bounds: tuple[float, float]
) -> Sample | None:
    """The sample just off a special start from which its arm marches; None where there is none.

    start : at the seed's z, its tangent turned by `sense`.
    """
    problem, frame = seed.problem, Frame(scale)
    if sense in seed.beside:
        offset = (seed.beside[sense] - start.z) / scale
        found = problem.probe(start, float(start.tangent @ offset), seed.beside[sense], frame, settings)
        if found is None or float(found.tangent @ offset) > 0.0:
            return found
        return oriented(found, -1)  # at a cusp both arms leave to one side
    bend = np.zeros_like(scale) if seed.curvature is None else seed.curvature

    def beside(size: float) -> Sample | None:
        guess = start.z + scale * (size * start.tangent + 0.5 * elementary.square(size) * bend)
        found = problem.probe(start, size, guess, frame, settings)
        if found is None or problem.separated(start.z, found.z):
            return None
        offset = (found.z - start.z) / scale
        ahead = float(offset @ start.tangent) > 0.9 * float(np.linalg.norm(offset))
        return found if ahead and found.tangent @ start.tangent > 0.8 else None

    first = settings.first_step if seed.reach is None else 10.0 * seed.reach
    ladder = first * elementary.pow(10.0, -np.arange(1.0, 5.5, 0.5))
    if seed.reach is not None:  # nearer to the start than that, branches may not be told apart
        ladder = np.insert(ladder, 1, STILL_TOLD * seed.reach)
    born = Birth.of(seed)
    turn = _turn(seed, sense, scale)
    if turn is not None and BEFORE_TURN * turn < ladder[0]:
        below = ladder[ladder < BEFORE_TURN * turn]
        near = below if len(below) > 1 else BEFORE_TURN * turn * np.array([1.0, 0.3])
        found = _first_alike(beside, near, born, problem, bounds)
        if found is not None:
            return found
    return _first_alike(beside, ladder, born, problem, bounds)


def passed_over(seed: Seed, origin: Sample, sense: int, scale: Array) -> Sentence | None:
    """What is known to have happened between the start and an arm's first sample; None where nothing is."""
    nearer = "nearer to the start than the branch can be followed from there"
    where = f"{seed.problem.parameters[0]} = {seed.z[-1]:.10g}"
    slope = 0.0 if seed.direction is None or _turn(seed, sense, scale) is None else sense * float(seed.direction[-1])
    if slope * float(origin.tangent[-1]) < 0.0:
        return Sentence(f"a fold {nearer} is not labelled", where)
    born = Birth.of(seed)
    if born is not None and not born.allows(origin):
        counts = f"unstable is {born.unstable} at the start and {origin.unstable} next to it"
        text = f"{counts}, for which critical eigenvalues do not account: a bifurcation {nearer}"
        return Sentence(text, where)
    return None


@dataclass(frozen=True, eq=False)
class Birth:
    """What is known of stability where a branch is born.

    `unstable` : without the `critical` eigenvalues.  `values` (k,), `distances` (k,) : all eigenvalues, and how far
    they are from the stability boundary, infinite for critical ones.
    """

    unstable: int
    critical: int
    distances: Array
    values: NDArray[np.complex128]
    multipliers: bool

    @classmethod
    def of(cls, seed: Seed) -> Birth | None:
        """None where the eigenvalues at the seed are not known."""
        if seed.measured is None:
            return None
        unstable, values = seed.measured
        multipliers = seed.problem.kind in MULTIPLIERS or seed.problem.of_special_orbits
        return cls._told(unstable, values, multipliers, counted=False)

    @classmethod
    def _told(cls, unstable: int, values: NDArray[np.complex128], multipliers: bool, counted: bool) -> Birth:
        """counted : whether critical eigenvalues that are on the unstable side are counted in `unstable`."""
        values = values[np.isfinite(values)]
        size = np.abs(values)
        growth = size - 1.0 if multipliers else values.real
        near = np.abs(growth) <= (ON_CIRCLE if multipliers else CRITICAL) * size
        if not multipliers and len(size):
            near |= size <= ZERO * float(size.max())
        unstable -= int(np.count_nonzero(near & (growth > 0.0))) if counted else 0
        distances = np.where(near, np.inf, np.abs(growth))
        return cls(unstable, int(np.count_nonzero(near)), distances, values, multipliers)

    def allows(self, sample: Sample) -> bool:
        """True where the number of unstable eigenvalues is one that critical ones alone lead to."""
        return 0 <= sample.unstable - self.unstable <= self.critical

    def is_near(self, sample: Sample) -> bool:
        """True where an eigenvalue is nearer to the stability boundary than it moves up to the sample."""
        seen = sample.eigenvalues[np.isfinite(sample.eigenvalues)]
        if not len(seen) or not len(self.values):
            return False
        moved = np.abs(seen[:, None] - self.values).min(axis=0)
        return bool(np.any(self.distances <= 2.0 * moved))

    def leads_to(self, nearest: Sample, sample: Sample) -> bool:
        """True where next to the start as many eigenvalues are unstable as at the sample, but for critical ones."""
        beside = Birth._told(nearest.unstable, nearest.eigenvalues, self.multipliers, counted=True)
        return beside.allows(sample)


def _first_alike(
    beside: Callable[[float], Sample | None], sizes: Iterable[float], born: Birth | None, problem: Problem,
    bounds: tuple[float, float],
) -> Sample | None:  # fmt: skip
    """The first sample that is as the one nearer to the start: nothing happens between the start and it."""
    accepted = outside = nearest = None
    sizes = list(sizes)
    for size in sizes:
        found = beside(size)
        if found is None:
            continue
        if walls_passed(problem, found.z, bounds):
            outside = found
            continue
        if accepted is not None and _alike(accepted, found) and (born is None or born.allows(found)):
            if born is None or not born.is_near(accepted):
                return accepted
            nearest = beside(sizes[-1]) if nearest is None else nearest
            if nearest is None or born.leads_to(nearest, accepted):
                return accepted
        accepted = found
    return accepted or outside


def _turn(seed: Seed, sense: int, scale: Array) -> float | None:
    """The scaled distance s at which p turns along z + s direction + s^2 curvature / 2; None where it does not.

    Beside a transcritical point whose branch is nearly vertical that is a fold, nearer to the start than the first row
    would be. None too for one so near that in double precision the parameter is the same there.
    """
    if seed.direction is None or seed.curvature is None:
        return None
    slope, curve = sense * float(seed.direction[-1]), float(seed.curvature[-1])
    if slope * curve >= 0.0:
        return None
    gained = 0.5 * slope * slope / abs(curve) * scale[-1]
    resolved = 4.0 * float(np.spacing(max(abs(float(seed.z[-1])), float(scale[-1]))))
    return -slope / curve if gained > resolved else None


def _alike(a: Sample, b: Sample) -> bool:
    """True where the signs of the tests (those that are known) and the unstable count are the same."""
    products = a.tests * b.tests
    return a.unstable == b.unstable and bool(np.all((products > 0.0) | np.isnan(products)))
