"""Borders of the variational equation of an orbit, carried to another mesh of it: next to the null vectors there.

A border's direction need only lie within `contin.problems.orbits.linearised.bordered.LIKE` of a null vector.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from contin.abi import Array, Vector
from contin.kernels.collocation_basis import basis
from contin.problems.orbits.linearised.bordered import Borders
from contin.problems.orbits.linearised.linear import OrbitLinear
from contin.problems.orbits.mesh.layout import Profile, node_times


def carried(known: Mapping[str, Borders], source: OrbitLinear, target: OrbitLinear) -> dict[str, Borders]:
    """The same borders b (rows, k), c (unknowns, k) on the mesh of `target`; orthonormal.

    c are functions at the nodes over their units, and unknowns of the orbit as a whole. b are functions at the
    Gauss points times their weights, and values of the conditions on the orbit.
    """
    n, old, new = source.profile.n, source.profile, target.profile
    nu, rows = source.nu, len(_gauss_times(old)) * n
    carried_on: dict[str, Borders] = {}
    for name, (b, c) in known.items():
        nodes = _between(node_times(old.h, old.m), c[:nu] * source.units[:nu, None], node_times(new.h, new.m), n)
        inside = _between(_gauss_times(old), b[:rows] / _weights(old), _gauss_times(new), n) * _weights(new)
        c = np.vstack([nodes / target.units[: target.nu, None], c[nu:]])
        carried_on[name] = np.linalg.qr(np.vstack([inside, b[rows:]]))[0], np.linalg.qr(c)[0]
    return carried_on


def _between(times: Array, columns: Vector, wanted: Array, n: int) -> Vector:
    """Columns of (time, state) pairs at other times, by straight lines."""
    values = columns.reshape(len(times), -1)  # of each state and column
    found = np.column_stack([np.interp(wanted, times, each) for each in values.T])
    return np.asarray(found.reshape(len(wanted) * n, -1))


def _gauss_times(profile: Profile) -> Array:
    """Scaled times of the Gauss points, (N m,)."""
    begins = np.cumsum(profile.h) - profile.h
    return np.asarray((begins[:, None] + profile.h[:, None] * basis(profile.m).gauss).ravel())


def _weights(profile: Profile) -> Array:
    """Of each equation at a Gauss point, (N m n, 1)."""
    return np.repeat(np.tile(basis(profile.m).gauss_weights, profile.intervals), profile.n)[:, None]
