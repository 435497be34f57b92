"""Curves of branch points that something forces: the direction across them, and what unfoldings are compared with."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.loci.tolerances import FORCED

if TYPE_CHECKING:
    from contin.systems.protocol import System

FIRST: Final = np.array([1.0, 0.0])  # across in the first parameter
RANK: Final = 1e-6  # (relative) second derivatives below this in two of three directions tell no direction


def first_across(system: System, u: Array, p: Array, places: tuple[int, int], sizes: Array, shift: float) -> Array:
    """(2,) the direction of both parameters across the curve at its first point.

    In the first parameter, but where something forces the branch points, <w, F_p> = 0: the reduced equation is then, to
    second order, a product of two linear functions of the amplitude and both parameters, and its kernel is the curve's
    own direction. Were `across` along the curve, where the second parameter alone crosses it, none could be followed.

    places : of the parameters.  sizes : of the states.  shift : the critical eigenvalue.
    """
    n = len(u)
    jacobian = system.jacobian(u, p)[1]
    if not np.isfinite(jacobian).all():
        return FIRST
    matrix = jacobian[:, :n] * sizes / sizes[:, None] - shift * np.eye(n)
    columns = [n + place for place in places]
    slopes = jacobian[:, columns] / sizes[:, None]
    left, values, right = np.linalg.svd(matrix)
    w, v = left[:, -1], right[-1]
    beside = [system.jacobian(u + sign * sizes * v, p)[1][:, columns] / sizes[:, None] for sign in (-1.0, 1.0)]
    usual = np.nanmax(np.abs([slopes, *beside]), axis=(0, 1))  # how F_p changes over the states' sizes
    if np.any(np.abs(w @ slopes) > FORCED * usual):
        return FIRST
    others = values > FORCED * max(float(values[0]), 1.0 if n == 1 else 0.0)
    others[-1] = False
    moved = -(right.T[:, others] / values[others]) @ (left.T[others] @ slopes)
    directions = np.zeros((3, n + len(p)))
    directions[:, :n] = np.vstack([v, moved.T]) * sizes
    directions[1, n + places[0]] = directions[2, n + places[1]] = 1.0
    form = np.array([w / sizes @ (system.gradient(u, p, d) @ directions.T) for d in directions])
    if not np.isfinite(form).all():
        return FIRST
    _, sizes_of_form, kernel = np.linalg.svd(form)
    along = kernel[-1][1:]
    width = float(np.linalg.norm(along))
    if not (sizes_of_form[1] > RANK * sizes_of_form[0] and width > RANK):
        return FIRST
    across = np.array([-along[1], along[0]]) / width
    return np.asarray(across if across[np.argmax(np.abs(across))] > 0.0 else -across)


def usual_rate(system: System, u: Array, p: Array, sizes: Array) -> float:
    """The largest entry of f_u in scaled states; of one state, where it vanishes, that a size of the state beside."""
    places = [u] if len(u) > 1 else [u, u + sizes, u - sizes]
    rates = [np.abs(system.jacobian(x, p)[1][:, : len(u)] * sizes / sizes[:, None]).max() for x in places]
    return float(max((rate for rate in rates if np.isfinite(rate)), default=0.0))
