"""Curves of special and of connecting orbits in a phase diagram: which are known, and the families through them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Branch, SpecialPoint
from contin.continuation.seed import Seed
from contin.diagram.phase.lines import Box, is_orbital, smooth_rows, unit
from contin.diagram.sizes import PLAIN
from contin.problems.symmetry import every_symmetry
from contin.problems.symmetry_group import moved
from contin.simulate.natural import natural_metric

if TYPE_CHECKING:
    from contin.problems.orbits.mesh.layout import Profile
    from contin.problems.two_parameters import TwoParameterProblem

NEAR: Final = 1e-3  # distance in the unit square of a point from a curve that it is on
BESIDE: Final = 0.02  # ... of a row of a curve from the point that the curve is said to lead to
ALIKE: Final = 0.05  # relative difference of period and extent of two orbits that may be one, or images
SAMPLES: Final = 7  # rows of a curve that are looked up on another
SAME_PARAMETER, SAME_PERIOD = 1e-6, 1e-3  # of two special orbits of a line, relative


def is_known_curve(loci: Sequence[Branch], seed: Seed, box: Box) -> bool:
    """True where the seed is a point of one of the curves, or the image of one."""
    problem: Any = seed.problem
    place, marks = unit(seed.z[None, [-1, -2]], box)[0], _marks(problem, problem.columns(seed.z[None]))[0]
    return any(_passes(b, place, marks, box) for b in loci if b.locus == problem.locus and is_orbital(b))


def is_known_point(loci: Sequence[Branch], point: SpecialPoint, states: Sequence[str], place: Array, box: Box) -> bool:
    """True where a labelled orbit of a family is on one of the curves of its type: no equations are solved for that."""
    extents = [point.values[f"{name}.max"] - point.values[f"{name}.min"] for name in states]
    period = 1.0 if point.type == "HOM" else point.values["period"]
    marks = np.array([period, *extents])
    return any(_passes(b, place, marks, box) for b in loci if b.locus == point.type and is_orbital(b))


def passes_near(loci: Sequence[Branch], locus: str, place: Array, box: Box) -> bool:
    """True where a curve of this type comes near a place of the unit square."""
    rows = [unit(b.z[:, [-1, -2]], box) for b in loci if b.locus == locus and is_orbital(b)]
    return any(float(np.linalg.norm(r - place, axis=1).min()) < BESIDE for r in rows)


def repeats_curve(branch: Branch, loci: Sequence[Branch], box: Box) -> bool:
    """True where every sampled row of a curve is on one that is known."""
    rows = np.unique(np.linspace(0, len(branch) - 1, SAMPLES).astype(int))
    places, marks = unit(branch.z[:, [-1, -2]], box), _marks(branch.problem, branch.columns)
    return any(
        all(_passes(known, places[row], marks[row], box) for row in rows)
        for known in loci
        if known.locus == branch.locus and is_orbital(known)
    )


def _marks(problem: TwoParameterProblem, columns: Any) -> Array:
    """(rows, 1 + n): period (of connecting orbits: 1) and extents of the states."""
    names = problem.system.state_names
    extents = np.array([columns[f"{name}.max"] - columns[f"{name}.min"] for name in names])
    return np.column_stack([columns.get("period", np.ones_like(extents[0])), extents.T])


def _scale(branch: Branch, extents: Array) -> Array:
    """Sizes of the states (n,) along a curve from their extents (rows, n); alike for states that symmetries exchange.

    An orbit and its image then have one length. The extent of a state that rests on all orbits is rounding, and no
    size: the natural metric tells.
    """
    problem: Any = branch.problem
    system = problem.system
    sizes = extents.max(axis=0)
    p = np.array(problem.curve.base, dtype=float)
    plain = sizes > PLAIN * sizes.max()
    if not plain.all():
        own = list(system.parameter_names)
        p[[own.index(name) for name in problem.parameters]] = branch.z[0, [-1, -2]]
        middle = np.array([branch.columns[f"{s}.max"][0] + branch.columns[f"{s}.min"][0] for s in system.state_names])
        seen = np.where(plain, sizes, 0.0)
        sizes = np.maximum(sizes, natural_metric(system, 0.5 * middle, p[: system.m], seen).states)
    origin = np.zeros((1, len(sizes)))
    images = [moved(system, w, np.diag(sizes), p) - moved(system, w, origin, p) for w in every_symmetry(problem)]
    largest = np.max([sizes, *(np.abs(image).max(axis=0) for image in images)], axis=0)
    return np.where(largest > 0.0, largest, 1.0)


def _lengths(marks: Array, scale: Array) -> Array:
    """(rows, 2): period, and extent in the metric, which symmetries leave as it is."""
    return np.column_stack([marks[:, 0], np.linalg.norm(marks[:, 1:] / scale, axis=1)])


def _passes(branch: Branch, place: Array, marks: Array, box: Box) -> bool:
    """True where the curve passes this place of the unit square with an orbit that looks like this one."""
    rows = unit(branch.z[:, [-1, -2]], box)
    fine = smooth_rows(branch, rows, box)
    of_states = _marks(branch.problem, branch.columns)
    scale = _scale(branch, of_states[:, 1:])
    own, marks = _lengths(of_states, scale), _lengths(marks[None], scale)[0]
    typical = np.array([0.0, float(own[:, 1].max())])  # the extent vanishes where the curve was born
    along = np.linspace(0.0, len(rows) - 1.0, len(fine))
    a, d = fine[:-1] - place, np.diff(fine, axis=0)
    t = np.clip(-np.sum(a * d, axis=1) / np.maximum(np.sum(d * d, axis=1), 1e-300), 0.0, 1.0)
    gaps = np.linalg.norm(a + t[:, None] * d, axis=1)
    for k in np.flatnonzero(gaps < NEAR):
        here = [np.interp(along[k] + t[k] * (along[k + 1] - along[k]), np.arange(len(rows)), own[:, j]) for j in (0, 1)]
        if np.all(np.abs(here - marks) <= ALIKE * np.maximum(np.maximum(here, marks), typical)):
            return True
    return False


def families_across(locus: Branch, axis: int, value: float, found: Sequence[Branch]) -> list[Seed]:
    """Families of orbits through the points of a curve on a line, unless those points are labelled in `found`."""
    if locus.locus == "HOM" or not is_orbital(locus):
        return []
    problem: Any = locus.problem
    index = -1 if axis == 1 else -2  # where the parameter that is held stands
    column = locus.z[:, index] - value
    seeds = []
    reached = (column[1:] == 0.0) & (column[:-1] != 0.0)  # a row on the line counts with the step that leads to it
    reached[:1] |= (column[:1] == 0.0) & (column[1:2] != 0.0)
    for row in np.flatnonzero((column[:-1] * column[1:] < 0.0) | reached):
        z = _on_line(locus, int(row), index, value)
        if z is None:
            continue
        orbits, orbit = problem.curve.family(z, second=axis == 1)
        if not _is_labelled(str(locus.locus), orbits.profile(orbit), found):
            seeds.append(Seed(orbits, orbit))
    return seeds


def _on_line(locus: Branch, row: int, index: int, value: float) -> Array | None:
    """The special orbit with this value of a parameter, between a row and the next one."""
    problem: Any = locus.problem
    near = row if abs(locus.z[row, index] - value) <= abs(locus.z[row + 1, index] - value) else row + 1
    ahead = row + 1 if near == row else row
    z, other = (locus.z[k][~np.isnan(locus.z[k])] for k in (near, ahead))
    if z.size == other.size:
        t = (value - z[index]) / (other[index] - z[index])
        guess = (1.0 - t) * z + t * other
        solved = problem.at_unknown(index, guess, value, problem.initial_scale(guess, problem.first_bounds))
        if solved is not None:
            return np.asarray(solved)
    solved = problem.at_unknown(index, z, value, problem.initial_scale(z, problem.first_bounds))
    return None if solved is None else np.asarray(solved)


def _is_labelled(type_: str, profile: Profile, found: Sequence[Branch]) -> bool:
    for branch in found:
        for p in branch.points:
            if p.type == type_ and "period" in p.values:
                here = p.values[branch.parameters[0]]
                same = abs(here - profile.parameter) <= SAME_PARAMETER * max(1.0, abs(here))
                if same and abs(p.values["period"] - profile.period) <= SAME_PERIOD * profile.period:
                    return True
    return False
