"""The boundary conditions of a connecting orbit at its saddles, with their derivatives.

    L_s(x0)^T (u(0) - x0) / d = 0,      L_u(x1)^T (u(1) - x1) / d = t w

d the states' sizes, L_s and L_u left invariant subspaces of D^-1 f_u D, D = diag(d); t = 0 but along the homotopy by
which an orbit is found, whose `aim` w is what the second condition misses at t = 1 (`homotopy.py`).

A basis L of an invariant subspace of M, scaled by R^T L = 1, moves with M by (Dieci and Friedman 2001)

    (1 - L R^T) M dL - dL S = -(1 - L R^T) dM L,     S = R^T M L
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.homoclinic.subspaces import left_subspace
from contin.linalg.vectors import norm
from contin.problems.orbits.ends.saddle_node import fold_scalar

if TYPE_CHECKING:
    from contin.homoclinic.connection_layout import ConnectionLayout

STEP: Final = 1e-6  # of the differences of f_u, relative


@dataclass(frozen=True, eq=False)
class Projections:
    """The k conditions and their derivatives; at a saddle-node the last one is its fold."""

    values: Array  # (k,)
    by_first: Array  # (k, n) by u(0)
    by_last: Array  # (k, n) by u(1)
    by_saddles: Array  # (k, saddles n)
    by_parameters: Array  # (k, 2): the second parameter (or t), the first one


def _conditions(curve: ConnectionLayout, z: Array, sizes: Array, stable: Array, arriving: Array) -> Array:
    """From the basis L_s and what vanishes at the orbit's end."""
    ends = curve.equilibria(z)
    start, _ = curve.offsets(z, sizes)
    if curve.aim is not None:
        arriving = arriving - z[-2] * curve.aim
    conditions = [stable.T @ start, arriving]
    if curve.node:
        assert curve.chosen.borders is not None
        conditions.append(np.array([fold_scalar(curve.scaled_matrix(ends[0], z, sizes), *curve.chosen.borders)]))
    return np.concatenate(conditions)


def arriving_parts(curve: ConnectionLayout, z: Array, sizes: Array) -> Array:
    """What vanishes at the orbit's end: its unstable parts, or the distance from the fixed space of a reversor."""
    if curve.reversor is not None:
        return curve.reversor.missed(z[: curve.nodes(z)][-curve.n :], sizes)
    return _unstable_parts(curve, z, sizes, basis_at(curve, curve.equilibria(z)[-1], z, sizes, False))


def _unstable_parts(curve: ConnectionLayout, z: Array, sizes: Array, unstable: Array) -> Array:
    _, finish = curve.offsets(z, sizes)
    return np.asarray(unstable.T @ finish)


def linearised_projections(curve: ConnectionLayout, z: Array, sizes: Array, units: Array) -> Projections:
    """The conditions and their derivatives; `units` (2,) of the second and the first parameter."""
    n, ends = curve.n, curve.equilibria(z)
    start, finish = curve.offsets(z, sizes)
    stable = basis_at(curve, ends[0], z, sizes, True)
    if curve.reversor is None:
        unstable = basis_at(curve, ends[-1], z, sizes, False)
        end_parts = _unstable_parts(curve, z, sizes, unstable)
    else:
        unstable, end_parts = np.zeros((n, 0)), arriving_parts(curve, z, sizes)
    values = _conditions(curve, z, sizes, stable, end_parts)
    leaving = slice(0, curve.stable_count)
    arriving = slice(curve.stable_count, curve.stable_count + curve.unstable_count)
    by_first, by_last = np.zeros((len(values), n)), np.zeros((len(values), n))
    by_saddles, by_parameters = np.zeros((len(values), curve.saddles * n)), np.zeros((len(values), 2))
    by_first[leaving] = stable.T / sizes
    by_saddles[leaving, :n] -= by_first[leaving]
    changes = [_changes(curve, u, z, sizes, units) for u in ends]
    turning_ends = [(leaving, stable, curve.chosen.stable, start, 0)]
    if curve.reversor is not None:
        by_last[arriving] = curve.reversor.rows / curve.reversor.lengths(sizes)[:, None]
    else:
        by_last[arriving] = unstable.T / sizes
        by_saddles[arriving, -n:] -= by_last[arriving]
        turning_ends.append((arriving, unstable, curve.chosen.unstable, finish, -1))
    for rows, basis, reference, offset, k in turning_ends:
        moved = turned(curve.scaled_matrix(ends[k], z, sizes).T, basis, reference, changes[k].transpose(0, 2, 1))
        turning = np.einsum("cij,i->jc", moved, offset)
        by_saddles[rows, slice(0, n) if k == 0 else slice(-n, None)] += turning[:, :n]
        by_parameters[rows] += turning[:, n:]
    if curve.node:
        _fold(curve, ends[0], z, sizes, units, by_saddles, by_parameters)
    if curve.aim is not None:
        by_parameters[arriving, 0] = -curve.aim
    return Projections(values, by_first, by_last, by_saddles, by_parameters)


def basis_at(curve: ConnectionLayout, u: Array, z: Array, sizes: Array, stable: bool) -> Array:
    """L_s or L_u, (n, count), at a state, scaled by the reference."""
    count = curve.stable_count if stable else curve.unstable_count
    reference = curve.chosen.stable if stable else curve.chosen.unstable
    return left_subspace(curve.scaled_matrix(u, z, sizes), count, stable, reference)


def turned(matrix: Array, basis: Array, reference: Array | None, changes: Array) -> Array:
    """dL (c, n, count) for changes dM (c, n, n) of the matrix M whose right invariant subspace the basis spans.

    R^T L = 1 makes R^T dL = 0: what is added within the subspace changes no solution, and its eigenvalues may be zero.
    """
    n, count = basis.shape
    if count == 0:
        return np.zeros((len(changes), n, 0))
    within = basis @ (basis if reference is None else reference).T
    across = np.eye(n) - within
    small = (basis if reference is None else reference).T @ matrix @ basis
    outer = across @ matrix + 2.0 * norm(matrix.ravel()) * within
    whole = np.kron(np.eye(count), outer) - np.kron(small.T, np.eye(n))
    right = -np.einsum("ij,cjk->cik", across, changes @ basis)
    solved = np.linalg.solve(whole, right.transpose(0, 2, 1).reshape(len(changes), -1).T).T
    return np.asarray(solved.reshape(len(changes), count, n).transpose(0, 2, 1))


def _changes(curve: ConnectionLayout, u: Array, z: Array, sizes: Array, units: Array) -> Array:
    """Derivatives (n + 2, n, n) of the scaled matrix by the state, the second and the first parameter."""
    n = curve.n
    steps = STEP * np.concatenate([sizes, np.abs(units)])
    states, parameters = np.tile(u, (2 * (n + 2), 1)), []
    for k in range(n):
        states[2 * k : 2 * k + 2, k] += steps[k], -steps[k]
    here = curve.full_parameters(z)
    for slot, step in zip((-2, -1), steps[n:], strict=True):
        for signed in (step, -step):
            moved = z.copy()
            moved[slot] += signed
            parameters.append(curve.full_parameters(moved))
    rows = np.vstack([np.tile(here, (2 * n, 1)), *parameters])
    _, whole = curve.orbits.system.jacobians(states, rows)
    scaled = whole[:, :, :n] * sizes / sizes[:, None]
    return np.asarray((scaled[0::2] - scaled[1::2]) / (2.0 * steps)[:, None, None])


def _fold(
    curve: ConnectionLayout, u: Array, z: Array, sizes: Array, units: Array, by_saddles: Array, by_parameters: Array
) -> None:  # fmt: skip
    """The last rows, of the fold: by differences."""
    assert curve.chosen.borders is not None
    borders = curve.chosen.borders
    for k in range(curve.n):
        step = np.zeros(curve.n)
        step[k] = STEP * float(sizes[k])
        pair = [fold_scalar(curve.scaled_matrix(u + sign * step, z, sizes), *borders) for sign in (1.0, -1.0)]
        by_saddles[-1, k] = (pair[0] - pair[1]) / (2.0 * step[k])
    for k in (-2, -1):
        step = np.zeros(z.size)
        step[k] = STEP * float(units[k])
        pair = [fold_scalar(curve.scaled_matrix(u, z + sign * step, sizes), *borders) for sign in (1.0, -1.0)]
        by_parameters[-1, k] = (pair[0] - pair[1]) / (2.0 * step[k])
