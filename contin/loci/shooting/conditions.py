"""What makes an orbit special, as scalars that vanish with the smallest singular values of a matrix.

[A B; C 0] [v; g] = [0; e] and [A^T C^T; B^T 0] [w; .] = [0; e']: g = -w^T A v, and dg = -w^T dA v (Griewank and
Reddien 1984; Govaerts, Numerical Methods for Bifurcations of Dynamical Equilibria, 2000, ch. 3). A is

    LPC   the derivative of the shooting equations by (u, T)                                       one scalar
    BPC   their derivative by (u, T, p), which has two null vectors                                two scalars
    PD    the variations over a period with v(T) = -v(0)                                           one scalar
    NS    those over two periods with v(2 T) - 2 cos(theta) v(T) + v(0) = 0, for one vector v      two scalars

Variations are those of the return map, the flow's direction projected out, so that R1 is a regular point of NS. All
segments' variations are unknowns: no product of fundamental matrices is formed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from contin.abi import Array
from contin.loci.shooting.expansion import Expansion
from contin.machine import elementary

ANGLES: Final = np.pi * np.arange(6) / 6.0


@dataclass(frozen=True, eq=False)
class Borders:
    """B (rows of A, k) and C (k, columns of A)."""

    b: Array
    c: Array


@dataclass(frozen=True, eq=False)
class Condition:
    """Scalars (k,), their derivatives by x (k, rows + 2) and by the further unknown (k,); `bend`: see `fold`.

    form : (2, 2) of BPC, the branching equation's second derivatives.
    """

    values: Array
    slopes: Array
    further: Array
    bend: float = 0.0
    form: Array | None = None


def matrix(type_: str, at: Expansion, further: float) -> Array:
    """A."""
    if type_ == "LPC":
        return at.jacobian[:, : at.rows]
    if type_ == "BPC":
        return np.column_stack([at.jacobian[:, : at.rows], at.jacobian[:, -1]])
    n, count = at.orbits.n, len(at.transitions)
    blocks = np.concatenate([at.transitions[:-1], (at.projector @ at.transitions[-1])[None]])
    turns = 2 if type_ == "NS" else 1
    size = turns * count
    out = np.zeros((size, n, size, n))
    for k in range(size):
        out[k, :, k] += blocks[k % count]
        if k < size - 1:
            out[k, :, k + 1] -= np.eye(n)
    out[-1, :, 0] += np.eye(n)
    if turns == 2:
        out[-1, :, count] -= 2.0 * further * np.eye(n)
    return out.reshape(size * n, size * n)


def borders(type_: str, a: Array, n: int, old: Borders | None) -> Borders:
    """Borders from singular vectors, with the sense of the old ones."""
    left, _, right = np.linalg.svd(a)
    if type_ == "BPC":
        b, c = left[:, -1:], right[[-1, -2]]
    elif type_ == "NS":
        b, c = left[:, -2:], _turned(right[-2:], n)
    else:
        b, c = left[:, -1:], right[-1:]
    if old is not None and old.b.shape == b.shape and b.shape[1] == 1:
        b = b * (np.sign(float(old.b[:, 0] @ b[:, 0])) or 1.0)
    return Borders(b, c)


def _turned(plane: Array, n: int) -> Array:
    """A basis whose first vector is as far as possible from an eigenvector of the return map."""
    count = plane.shape[1] // (2 * n)

    def area(v: Array) -> float:
        start, turned = v[:n], v[count * n : count * n + n]
        sizes = float(np.linalg.norm(start) * np.linalg.norm(turned))
        return 1.0 - abs(float(start @ turned)) / sizes if sizes > 0.0 else 0.0

    best = max(ANGLES, key=lambda t: area(elementary.cos(t) * plane[0] + elementary.sin(t) * plane[1]))
    turn = np.array([[elementary.cos(best), elementary.sin(best)], [-elementary.sin(best), elementary.cos(best)]])
    return np.asarray(turn @ plane)


def condition(type_: str, at: Expansion, further: float, known: Borders) -> Condition | None:
    """The scalars of a type; None where a trajectory beside the orbit fails, or the bordered matrix is singular."""
    a = matrix(type_, at, further)
    (rows, columns), few, many = a.shape, known.b.shape[1], len(known.c)
    bordered = np.block([[a, known.b], [known.c, np.zeros((many, few))]])
    if not np.all(np.isfinite(bordered)):
        return None
    wanted = 2 if type_ == "BPC" else 1  # vectors v
    try:
        right = np.linalg.solve(bordered, np.eye(rows + many)[:, rows : rows + wanted])
        left = np.linalg.solve(bordered.T, np.eye(columns + few)[:, columns:])
    except np.linalg.LinAlgError:  # no step: the curve ends, in words
        return None
    v, g, w = right[:columns], right[columns:].ravel(), left[:rows]
    if type_ in ("LPC", "BPC"):
        return _of_equations(at, v, g, w[:, 0])
    return _of_variations(at, v[:, 0], g, w, 1 if type_ == "PD" else 2)


def _of_equations(at: Expansion, v: Array, g: Array, w: Array) -> Condition | None:
    """`bend` is w^T D^2 F[v, v], whose sign at a fold says on which side of it there are two orbits: zero at a CPC."""
    slopes, directions, bend = [], [], 0.0
    for column in v.T:
        direction = np.zeros(at.rows + 2)
        direction[: at.rows] = column[: at.rows]
        direction[-1] = column[at.rows] if column.size > at.rows else 0.0
        change = at.along(direction)
        if change is None:
            return None
        slopes.append(-w @ change)
        directions.append(direction)
        bend = float(w @ change @ direction)
    form = np.array(slopes) @ np.array(directions).T if len(slopes) > 1 else None
    return Condition(g, np.array(slopes), np.zeros(g.size), bend, form)


def _of_variations(at: Expansion, v: Array, g: Array, w: Array, turns: int) -> Condition | None:
    n, size = at.orbits.n, v.size // turns
    slopes = np.zeros((w.shape[1], at.rows + 2))
    for turn in range(turns):
        part = slice(turn * size, (turn + 1) * size)
        direction = np.zeros(at.rows + 2)
        direction[:size] = v[part] / np.sqrt(size)  # variations are in the states' sizes, x in those of the metric
        change = at.along(direction)
        if change is None:
            return None
        end = at.transitions[-1] @ v[part][-n:]
        for k, row in enumerate(w[part].T):
            last = row[-n:]
            slopes[k] -= np.append(row[:-n], at.projector.T @ last) @ change[:size] + at.projector_along(last, end)
    further = 2.0 * w[-n:].T @ v[size : size + n] if turns == 2 else np.zeros(1)
    return Condition(g, slopes, further)
