"""Whether a curve of special points is known already, up to declared symmetries and periods of angles."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Branch
from contin.continuation.seed import Seed
from contin.diagram.identity import wrapped
from contin.diagram.phase.lines import Box
from contin.problems.symmetry import every_symmetry
from contin.problems.symmetry_group import moved

if TYPE_CHECKING:
    from contin.problems.equilibria.equilibrium import EquilibriumProblem

SAME: Final = 1e-5  # scaled distance of a point from a curve
FAR: Final = 0.5  # of the distance of two rows: what is farther from the chord is not on the curve
SAMPLES: Final = 7  # rows of a curve that are looked up on another


def is_known_locus(loci: Sequence[Branch], seed: Seed, box: Box) -> bool:
    """True where the seed, or an image of it, is a point of one of the curves."""
    problem: Any = seed.problem
    same = [b for b in loci if b.locus == problem.locus and _steps(b.problem) == _steps(problem)]
    return any(_lies_on(b, problem, z, box) for z in _copies(problem, seed.z) for b in same)


def repeats(branch: Branch, loci: Sequence[Branch], box: Box) -> bool:
    """True where every sampled row of a curve is a point of one that is known."""
    problem: Any = branch.problem
    rows = np.unique(np.linspace(0, len(branch) - 1, SAMPLES).astype(int))
    for known in loci:
        if (
            known.locus == branch.locus
            and _steps(known.problem) == _steps(problem)
            and all(any(_lies_on(known, problem, z, box) for z in _copies(problem, branch.z[row])) for row in rows)
        ):
            return True
    return False


def _steps(problem: EquilibriumProblem) -> int:
    """Of cycles of a map."""
    return int(getattr(problem.system, "times", 1))


def _copies(problem: Any, z: Array) -> Iterable[Array]:
    """z and its images under the declared symmetries, null vectors left alone (they do not identify a point).

    Of cycles of a map also their other points.
    """
    yield z
    n, system = problem.n, problem.system
    p = problem.curve.full_parameters(z)
    if _steps(problem) > 1:
        for x in list(system.orbit(z[:n], p))[1:]:
            yield np.concatenate([x, z[n:]])
    for name in every_symmetry(problem):
        image = z.copy()
        image[:n] = moved(system, name, z[:n][None], p[None])[0]
        yield image


def _lies_on(branch: Branch, problem: Any, z: Array, box: Box) -> bool:
    """True where the states, kappa and parameters of z are those of a point of the curve.

    The curve is solved for beside z, with the unknown held that moves most there, so that the answer does not depend on
    how densely it was sampled.
    """
    if branch.z.shape[1] != len(z) or len(branch) < 2:
        return False
    own: Any = branch.problem
    seen = np.flatnonzero(own.identifying if own.locus != "BP" else _without(own.identifying, -3))
    scale = own.initial_scale(z, box[0])[seen]
    periods = np.concatenate([problem.state_periods, np.zeros(len(seen) - problem.n)])
    offsets = wrapped(branch.z[:, seen] - z[seen], periods) / scale
    a, d = offsets[:-1], np.diff(offsets, axis=0)
    length = np.maximum(np.sum(d * d, axis=1), 1e-300)
    t = np.clip(-np.sum(a * d, axis=1) / length, 0.0, 1.0)
    gaps = np.linalg.norm(a + t[:, None] * d, axis=1)
    row = int(np.argmin(gaps))
    if gaps[row] > FAR * np.sqrt(length[row]) + SAME:
        return False
    if gaps[row] < SAME:
        return True
    guess = (1.0 - t[row]) * branch.z[row] + t[row] * branch.z[row + 1]
    held = int(np.argmax(np.abs(d[row])))
    value = float(guess[seen[held]] - (a[row] + t[row] * d[row])[held] * scale[held])
    solved = own.at_unknown(int(seen[held]), guess, value, own.initial_scale(z, box[0]))
    if solved is None:
        return False
    return bool(np.linalg.norm(wrapped(solved[seen] - z[seen], periods) / scale) < SAME)


def _without(mask: Array, index: int) -> Array:
    kept = mask.copy()
    kept[index] = False
    return kept
