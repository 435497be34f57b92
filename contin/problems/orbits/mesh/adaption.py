"""Mesh adaption: intervals placed so that each has the same error, and as many as the tolerance needs.

The error of an interval is c h^(m + 1) |u^(m + 1)| (see `contin.kernels.collocation_mesh`), so the mesh is right where
h is proportional to |u^(m + 1)|^(-1 / (m + 1)) (de Boor 1974; Russell and Christiansen 1978; AUTO does the same at a
fixed number).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.kernels.collocation_basis import basis
from contin.kernels.collocation_mesh import mesh_error
from contin.machine import elementary
from contin.problems.orbits.mesh.layout import Profile
from contin.problems.orbits.mesh.sizes import TINY_STATE
from contin.problems.orbits.mesh.small_ends import towards_small_ends

SMALLEST, LARGEST = 10, 400  # number of intervals
FLOOR = 0.15  # least density, relative to the mean: no interval becomes much longer than the others' average
WORTHWHILE = 0.6  # part of the error that a new mesh of as many intervals leaves at most
MARGIN = 0.4  # the mesh is laid out for this part of the tolerance
COARSE = 100.0  # times the tolerance: errors that no adaption has brought down
VARYING = 1e-3  # smallest modulus of a state of one sign, relative to its largest, below which it counts while small
RELATIVE = 1e-2  # ... and how much an error relative to its own size counts
CLOSED = 0.1  # change of such a state over a period, relative to its size, that a guess of a closed orbit may have


@dataclass(frozen=True, eq=False)
class MeshChoice:
    """Interval lengths, and the error that they are expected to leave."""

    h: Array
    error: float


def estimate(
    profile: Profile, sizes: Array, closed: bool = True, states: int | None = None
) -> tuple[float, Array]:  # fmt: skip
    """Largest error inside an interval relative to the states' sizes, and |u^(m + 1)| of every interval.

    closed : the solution is periodic, and its last interval followed by the first.  Where it is not, errors count
    towards small ends too, of the first `states` functions (all).
    """
    scheme = basis(profile.m)
    density = np.empty(profile.intervals)
    error = mesh_error(
        profile.vector(), profile.n, profile.m, profile.intervals, closed, scheme.top, scheme.error, sizes, density
    )
    if not closed:
        towards = towards_small_ends(profile, sizes, states) if profile.intervals > 1 else np.zeros(1)
        if towards.any():
            density = np.maximum(density, towards)
            error = max(error, float(np.max(scheme.error * elementary.pow(profile.h, profile.m + 1) * density)))
        return float(error), density
    small = _of_one_sign_and_small(profile, sizes)
    if small.size:
        density = np.maximum(density, RELATIVE * _relative_density(profile, small))
        error = max(error, float(np.max(scheme.error * elementary.pow(profile.h, profile.m + 1) * density)))
    return float(error), density


def _of_one_sign_and_small(profile: Profile, sizes: Array) -> NDArray[np.intp]:
    """States that keep their sign and are much smaller at times than at others.

    None of them is zero up to rounding, such as one that a symmetry or a frame keeps at zero: its sign and its ups and
    downs are noise, of which no mesh makes less.
    """
    across = profile.u.T
    low, high = across.min(axis=1), across.max(axis=1)
    varying = np.where(low > 0.0, low < VARYING * high, (high < 0.0) & (high > VARYING * low))
    varying &= np.maximum(high, -low) > TINY_STATE * sizes
    if not varying.any():
        return np.empty(0, np.intp)
    first, last = profile.u[0], profile.u[-1]  # of a connecting orbit they differ, and do not follow one another
    closed = np.abs(last - first) <= CLOSED * np.maximum(np.abs(first), np.abs(last))
    return np.flatnonzero(closed & varying)


def _relative_density(profile: Profile, states: NDArray[np.intp]) -> Array:
    """Largest |u^(m + 1)| of these states on every interval, relative to the size that the state has there."""
    h, m = profile.h, profile.m
    nodes = np.arange(profile.intervals)[:, None] * m + np.arange(m + 1)
    u = profile.u[nodes][:, :, states]  # (N, m + 1, k)
    top = np.einsum("j,ijk->ik", basis(m).top, u) / elementary.pow(h[:, None], m)
    jumps = 2.0 * np.abs(top - np.roll(top, 1, axis=0)) / (h + np.roll(h, 1))[:, None]
    local = np.maximum(jumps, np.roll(jumps, -1, axis=0)) / np.abs(u).max(axis=1)
    return np.asarray(local.max(axis=1))


def unresolved(profile: Profile, sizes: Array, tolerance: float, what: str, why: str, closed: bool = True) -> str:
    """That the mesh is much too coarse for `what`, in words, with `why` and what to try; empty where it is not."""
    error, _ = estimate(profile, sizes, closed)
    if not error > COARSE * tolerance:
        return ""
    return f"The mesh of {profile.intervals} intervals does not resolve the {what} (estimated error {error:.1e}): {why}"


def choose_mesh(
    profile: Profile, sizes: Array, tolerance: float, fixed: int | None, estimated: tuple[float, Array] | None = None,
    closed: bool = True,
) -> MeshChoice:  # fmt: skip
    """A mesh for this orbit with the error below `tolerance`, or with `fixed` intervals.

    estimated : what `estimate` says of the orbit, where it is known.  closed : as there.
    """
    order = profile.m + 1
    error, density = estimate(profile, sizes, closed) if estimated is None else estimated
    if not np.isfinite(error) or not density.any():
        h = np.full(fixed or max(profile.intervals, SMALLEST), 0.0)
        h[:] = 1.0 / len(h)
        return MeshChoice(h, error)
    monitor = _smoothed(elementary.pow(density, 1.0 / order), profile.h, closed)
    monitor = np.maximum(monitor, FLOOR * float(monitor @ profile.h))
    total = float(monitor @ profile.h)
    constant = basis(profile.m).error
    needed = int(np.ceil(total * elementary.pow(constant / (MARGIN * tolerance), 1.0 / order)))
    count = fixed or min(max(needed, SMALLEST), LARGEST)
    cumulated = np.concatenate([[0.0], np.cumsum(monitor * profile.h)]) / total
    mesh = np.interp(np.linspace(0.0, 1.0, count + 1), cumulated, profile.mesh)
    return MeshChoice(np.diff(mesh), constant * elementary.pow(total / count, order))


def _smoothed(values: Array, h: Array, closed: bool) -> Array:
    """Averaged with both neighbours: the estimate is rough, and lengths should change gradually."""
    first, last = (slice(-1, None), slice(0, 1)) if closed else (slice(0, 1), slice(-1, None))
    weighted = np.concatenate([values[first], values, values[last]])
    lengths = np.concatenate([h[first], h, h[last]])
    weighted *= lengths
    around: Array = (weighted[:-2] + 2.0 * values * h + weighted[2:]) / (lengths[:-2] + 2.0 * h + lengths[2:])
    return np.asarray(np.maximum(around, 0.5 * values))
