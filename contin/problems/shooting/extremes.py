"""Extremes and norms of orbits found by shooting."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.problems.orbits.measured.columns import names_of
from contin.problems.shooting.sampling import SAMPLES, crossings, mesh_of, states, turning_places

if TYPE_CHECKING:
    from contin.problems.shooting.shot_family import ShotFamily

FINER = 33  # times around an extreme one,
NEIGHBOURS = 2  # as far as so many of the times to either side


def measures(problem: ShotFamily, rows: Array) -> tuple[Array, Array, Array]:
    """Smallest and largest value of what `names_of` names on the orbits of rows z, (R, k) each, and norms (R,).

    The norm is the root mean square of all states, by quadrature between the crossings of switching surfaces.
    Extremes are looked for among equal times, those of long orbits in every step, and at those crossings, where a
    solution may have a corner; then among times between the neighbours of each extreme, and there by a parabola,
    except across a crossing.
    """
    found = [_measures(problem, z) for z in rows]
    width = len(names_of(problem.system))
    both = np.array([one[:2] for one in found]).reshape(len(rows), 2, width)
    return both[:, 0], both[:, 1], np.array([one[2] for one in found])


def _measures(problem: ShotFamily, z: Array) -> tuple[Array, Array, float]:
    crossed = crossings(problem, z)
    mesh = mesh_of(problem, z, turning_places(problem, z))
    times = np.union1d(np.union1d(np.arange(SAMPLES) / SAMPLES, crossed), mesh.times)
    values = _functions(problem, z, times)
    if not np.all(np.isfinite(values)):
        nothing = np.full(len(names_of(problem.system)), np.nan)
        return nothing, nothing, np.nan
    u = values[np.searchsorted(times, mesh.times), : problem.n]
    norm = float(np.sqrt(mesh.weights @ np.einsum("kn,kn->k", u, u)))
    best = np.concatenate([np.argmin(values, axis=0), np.argmax(values, axis=0)])
    beside = np.abs(_beside(times)[best] - times[best, None]).max(axis=1)
    finer = (times[best, None] + np.linspace(-1.0, 1.0, FINER) * beside[:, None]) % 1.0
    wanted, back = np.unique(finer, return_inverse=True)
    fine = _functions(problem, z, wanted)[back.reshape(finer.shape)]  # (2 k, FINER, k)
    k = values.shape[1]
    own = fine[np.arange(2 * k), :, np.tile(np.arange(k), 2)]
    own[:k] *= -1.0
    smooth = _smooth_at(finer, np.argmax(own, axis=1), crossed)
    tops = np.maximum(_top(own, smooth), np.concatenate([-values.min(axis=0), values.max(axis=0)]))
    skip = 0 if problem.system.state_names else problem.n
    return -tops[skip:k], tops[k + skip :], norm


def _beside(times: Array) -> Array:
    """Two of the times 0 ... 1 around each of them, round the orbit, (T, 2)."""
    wide = np.concatenate([times[-NEIGHBOURS - 1 : -1] - 1.0, times, times[1 : NEIGHBOURS + 1] + 1.0])
    return np.column_stack([wide[: -2 * NEIGHBOURS], wide[2 * NEIGHBOURS :]])


def _smooth_at(times: Array, best: NDArray[np.int64], crossed: Array) -> NDArray[np.bool_]:
    """True where no surface is crossed between the neighbours of the best of each row's times."""
    rows = np.arange(len(times))
    middle = np.clip(best, 1, times.shape[1] - 2)
    low, high = times[rows, middle - 1], times[rows, middle + 1]
    if not len(crossed):
        return np.ones(len(times), dtype=bool)
    between = (crossed[None] >= low[:, None]) & (crossed[None] <= high[:, None])
    return np.asarray(~between.any(axis=1) & (low < high))


def _functions(problem: ShotFamily, z: Array, times: Array) -> Array:
    """States and observables at scaled times, (T, k); where nothing has a name, states and their norm."""
    system, u = problem.system, states(problem, z, times)
    if not system.observable_names:
        norm = np.sqrt(np.einsum("tn,tn->t", u, u) / problem.n)
        return u if system.state_names else np.column_stack([u, norm])
    p = problem.full_parameters(z)
    return np.hstack([u, np.asarray(system.observables(np.ascontiguousarray(u), p)).reshape(len(u), -1)])


def _top(values: Array, smooth: NDArray[np.bool_]) -> Array:
    """Largest value of every row of equally spaced samples, between them by a parabola where it is smooth there."""
    best = np.clip(np.argmax(values, axis=1), 1, values.shape[1] - 2)
    rows = np.arange(len(values))
    a, b, c = (values[rows, best + d] for d in (-1, 0, 1))
    bend = a - 2.0 * b + c
    shift = np.clip(0.5 * (a - c) / np.where(bend < 0.0, bend, -1.0), -1.0, 1.0)
    largest = np.maximum(np.maximum(a, b), c)
    return np.asarray(np.where(smooth & (bend < 0.0) & (np.abs(shift) < 1.0), b - 0.25 * (a - c) * shift, largest))
