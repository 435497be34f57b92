"""The borders that the equations of a curve of special orbits are written in, found at a point.

Their parts are those of `contin.kernels.special_orbits.memory.Borders`; its neighbour `carry` takes them on to the next
points. Widths are the parameters' scales, units those of (u(0), T, s).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from contin.abi import Array
from contin.linalg.vectors import norm
from contin.problems.orbits.special_orbits.on_one_mesh import Work


def begin(own: Any, widths: Array) -> None:
    """Borders that are regular almost surely."""
    own.across[:], own.along[:] = (widths[0], 0.0), (0.0, widths[1])
    generator = np.random.default_rng(5)
    for border in (own.rows, own.jump, own.start):
        border[:] = generator.normal(size=border.shape)


def set_borders(type_: str, work: Work, units: Array, further: float) -> None:
    """Rows, jumps and start vectors from the reduced matrices of the last linearisation."""
    n, own, end = units.size - 2, work.borders, work.factors.end
    left, right = end[:n, :n], end[:n, n : 2 * n]
    sizes = units[:n]
    whole = np.zeros((n + 1, n + 2))
    whole[:, :n] = end[: n + 1, :n] + end[: n + 1, n : 2 * n]
    whole[:, n:] = end[: n + 1, 2 * n :]
    whole[n, n:] += work.memory.corner[0]
    whole *= units
    whole[:n] = np.linalg.solve(right * sizes, whole[:n])  # rows: what the jump u(1) - u(0) would have to be
    whole[n] /= max(float(np.linalg.norm(whole[n])), 1e-300)
    matrix = whole[:, : n + 1] if type_ == "LPC" else whole
    vectors, _, null = np.linalg.svd(matrix)
    own.rows[:] = 0.0
    for k in range(2 if type_ == "BPC" else 1):
        own.rows[k, : matrix.shape[1]] = null[-1 - k] / units[: matrix.shape[1]]
    if type_ == "BPC":
        own.jump[:, 0] = vectors[:n, -1] * sizes
    if type_ in ("PD", "NS"):
        monodromy = -np.linalg.solve(right * sizes, left * sizes)
        one = np.eye(n)
        critical = monodromy + one
        if type_ == "NS":
            flow = work.memory.section * sizes  # a unit vector of autonomous flows, else zero
            across = one - np.outer(flow, flow)
            monodromy = across @ monodromy @ across
            critical = monodromy @ monodromy - 2.0 * further * monodromy + one
        vectors, _, null = np.linalg.svd(critical)
        start = null[::-1][:2]
        if type_ == "NS":
            start = apart(start, start @ monodromy @ start.T)
        for k in range(min(2, n)):
            own.jump[:, k] = vectors[:, -1 - k] * sizes
            own.start[:, k] = start[k] / sizes


def apart(plane: Array, within: Array) -> Array:
    """The plane's two orthonormal rows turned so that the map `within` (2, 2) takes the first far away from itself.

    In the plane of a pair M^2 - 2 c M + 1 = (tr M - 2 c) M + (1 - det M): what it makes of the first row v is zero for
    no other trace and determinant only if v and M v are independent. A singular vector, whose place in the plane is
    rounding, may be an eigenvector where the pair is real: at R1, R2 and at neutral saddles. With v = (cos a, sin a)
    the area of v and M v is a quadratic form; its largest value is taken.
    """
    mixed = 0.5 * (within[1, 1] - within[0, 0])
    values, axes = np.linalg.eigh([[within[1, 0], mixed], [mixed, -within[0, 1]]])
    first = axes[:, np.argmax(np.abs(values))]
    return np.asarray([[first[0], first[1]], [-first[1], first[0]]] @ plane)


def turn(own: Any, widths: Array, across: float, along: float) -> None:
    """New directions of the parameters, (across, along) in the basis of the present ones."""
    direction = (across * own.across + along * own.along) / widths
    direction /= norm(direction)
    own.across[:] = direction * widths
    own.along[0], own.along[1] = -direction[1] * widths[0], direction[0] * widths[1]
