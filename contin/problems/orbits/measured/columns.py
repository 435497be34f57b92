"""Columns of families and curves of orbits: extrema over the orbit, for all rows on meshes of one size at once.

Rows are padded with NaN on the left to a common length, see `contin.problems.orbits.mesh.layout`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.kernels.collocation_basis import basis
from contin.problems.orbits.mesh.layout import Profile
from contin.problems.orbits.mesh.peaks import extrema

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem


def of_one_size(z: Array) -> Iterator[tuple[NDArray[np.intp], Array]]:
    """Groups of rows z: their indices, and the rows without padding."""
    if len(z) and not np.isnan(z[:, 0]).any():
        yield np.arange(len(z)), z
        return
    padding = np.argmax(~np.isnan(z), axis=1) if len(z) else np.empty(0, int)
    for skipped in np.unique(padding):
        chosen = np.flatnonzero(padding == skipped)
        yield chosen, z[chosen][:, skipped:]


def orbit_columns(
    z: Array, names: Sequence[str], profile: Callable[[Array], Profile], functions: Callable[[Array, Array], Array]
) -> dict[str, Array]:
    """`name.min` and `name.max` of every function over the orbits of rows z.

    profile : the orbit of one row, whose node values stand at the row's beginning.  functions(u, rows) : values
    (R, K, k) of the k named functions at nodes u (R, K, n) of orbits whose rows are given.
    """
    low, high = np.empty((len(z), len(names))), np.empty((len(z), len(names)))
    for chosen, rows in of_one_size(z):
        first = profile(rows[0])
        u = rows[:, : first.u.size].reshape(len(rows), -1, first.n)
        low[chosen], high[chosen] = extrema(functions(u, rows), first.m)
    columns = {}
    for k, name in enumerate(names):
        columns[f"{name}.min"], columns[f"{name}.max"] = low[:, k], high[:, k]
    return columns


def periods(z: Array, profile: Callable[[Array], Profile]) -> Array:
    """Periods of the orbits of rows z, in which they follow the node values."""
    found = np.empty(len(z))
    for chosen, rows in of_one_size(z):
        found[chosen] = rows[:, profile(rows[0]).u.size]
    return found


def norms(z: Array, profile: Callable[[Array], Profile]) -> Array:
    """Root mean square of all states over the orbits of rows z."""
    found = np.empty(len(z))
    for chosen, rows in of_one_size(z):
        first = profile(rows[0])
        place = first.u.size
        u = rows[:, :place].reshape(len(rows), -1, first.n)
        squares = np.einsum("rkn,rkn->rk", u, u)
        h = rows[:, place + 1 : place + 1 + len(first.h)]
        local = squares[:, :-1].reshape(len(rows), len(first.h), first.m)
        weights = basis(first.m).node_weights
        ends = squares[:, first.m :: first.m]
        means = np.einsum("rij,j,ri->r", local, weights[:-1], h) + np.einsum("ri,ri->r", ends, h) * weights[-1]
        found[chosen] = np.sqrt(means)
    return found


def integrals(
    z: Array, profile: Callable[[Array], Profile], function: Callable[[Array, Array], Array]
) -> Array:  # fmt: skip
    """Integrals over a period, of the orbits of rows z, of a function with values (R, K) at nodes u (R, K, n)."""
    found = np.empty(len(z))
    for chosen, rows in of_one_size(z):
        first = profile(rows[0])
        place, m = first.u.size, first.m
        values = function(rows[:, :place].reshape(len(rows), -1, first.n), rows)
        nodes = values[:, np.arange(first.intervals)[:, None] * m + np.arange(m + 1)]
        h = rows[:, place + 1 : place + 1 + first.intervals]
        found[chosen] = rows[:, place] * np.einsum("rij,j,ri->r", nodes, basis(m).node_weights, h)
    return found


def with_observables(system: CompiledSystem, u: Array, p: Array) -> Array:
    """What `names_of` names (R, K, k) at nodes u (R, K, n) of orbits with parameters p (R, p_size)."""
    if not system.observable_names:
        return u if system.state_names else np.sqrt(np.einsum("rkn,rkn->rk", u, u) / u.shape[2])[:, :, None]
    count, nodes, n = u.shape
    observed = system.observables(np.ascontiguousarray(u.reshape(-1, n)), np.repeat(p, nodes, axis=0))
    values = np.asarray(observed).reshape(count, nodes, -1)
    return np.concatenate([u, values], axis=2) if system.state_names else values


def names_of(system: CompiledSystem) -> list[str]:
    """States, where they have names, and observables; where nothing has one, the norm of the states."""
    return [*system.state_names, *system.observable_names] or ["norm"]
