"""Where curves of folds and branch points of boundary-value problems are more degenerate: what vanishes there.

With null vectors v of F_x and w of its transpose, by the curve's own borders:

    CP of folds, DP of transcritical points      <w, B(v, v)>
    DP of pitchforks, SW of cusps                <w, C(v, v, v) + 3 B(v, h)>,  F_x h = -B(v, v)
    DBP of generic branch points                 a02 b20 - b11^2, and b20 = <w, B(v, v)>

b11 = <w, B(v, g)>, a02 = <w, B(g, g)> with g = dx/ds on the branches, s the first
parameter. (Golubitsky and Schaeffer 1985, ch. II and IV.)
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from contin.abi import Array
from contin.bvp.collocated import Collocated
from contin.bvp.on_mesh import OnMesh
from contin.linalg.vectors import norm
from contin.loci.augmented.singular import Borders
from contin.loci.augmented.sparse import Factors
from contin.machine import elementary

PITCHFORK: Final = "pitchfork"
OWN: Final = {"LP": ("CP",), "CP": ("SW",), "BP": ("DP",)}  # of curve -> what is looked for, in the order of its tests
GENERIC: Final = ("DBP", "DBP:b20")  # the same on branch points in three parameters
TYPE_OF: Final = {"DBP:b20": "DBP"}  # the type of points where it vanishes, if it has another name


@dataclass(frozen=True, eq=False)
class Critical:
    """A singular solution x = (u, s) on a mesh: F', its left null vector w and the right ones of M (`singular`)."""

    mesh: OnMesh
    x: Array
    linear: Collocated
    left: Array
    right: Array

    @property
    def null(self) -> Array:
        """v (n + 1,), as a direction in x that leaves the parameter alone."""
        return np.append(in_states(self.right), 0.0)

    @property
    def along(self) -> Array:
        """g (n + 1,): dx/ds of the branches that cross, up to a multiple of v; branch points only."""
        ends = self.right[-1]
        return np.asarray(self.right @ ends / float(ends @ ends))

    def response(self, r: Array) -> Array:
        """h with F_x h = -r but for a part along w, <v, h> = 0, as a direction in x."""
        v, w = self.null[:-1], self.left
        factors = Factors(self.linear.critical(False).bordered((w / norm(w))[:, None], (v / norm(v))[:, None]))
        if factors.is_singular:  # a kernel of two dimensions: no value
            return np.full(len(v) + 1, np.nan)
        return np.append(factors.solve(np.append(-r, 0.0))[:-1], 0.0)


def in_states(right: Array) -> Array:
    """v (n,) of the null vectors of F_x (n, 1), or of [F_x, F_s] (n + 1, 2)."""
    if right.shape[1] == 1:
        return right[:, 0]
    a, b = right[-1]
    return np.asarray(b * right[:-1, 0] - a * right[:-1, 1])


def turned(borders: Borders) -> Borders:
    """The same with the opposite sense of v."""
    right = borders.right.copy()
    right[:, 0] *= -1.0
    return Borders(borders.left, right)


def _quadratic(at: Critical) -> float:
    return float(at.left @ at.mesh.form(at.x, at.null, at.null))


def _cubic(at: Critical) -> float:
    v = at.null
    mixed = at.mesh.form(at.x, v, at.response(at.mesh.form(at.x, v, v)))
    return float(at.left @ (at.mesh.form(at.x, v, v, v) + 3.0 * mixed))


def _hessian(at: Critical) -> float:
    v, g = at.null, at.along
    a02, b11, b20 = (float(at.left @ at.mesh.form(at.x, *pair)) for pair in ((g, g), (v, g), (v, v)))
    return a02 * b20 - elementary.square(b11)


VALUES: Final[Mapping[str, Callable[[Critical], float]]] = {
    "CP": _quadratic, "SW": _cubic, "DP": _quadratic, "DP:b30": _cubic, "DBP": _hessian, "DBP:b20": _quadratic,
}  # fmt: skip


def name_in(name: str, kind: str) -> str:
    """Which of `VALUES` vanishes at a point of this name on a curve of branch points of this kind."""
    return "DP:b30" if name == "DP" and kind == PITCHFORK else name


def unit_of(name: str, at: Critical, sizes: Array, width: float) -> float:
    """What a value of `VALUES` is measured by: the terms of <w, F_x v> for v as large as a solution.

    sizes : (n,) of the solution.

    width : of the first parameter, for which as much is said of dx/ds.
    """
    v = np.abs(at.null[:-1])
    part = float((v / sizes).max())  # v / part is as large as a solution
    terms = float(np.abs(at.left) @ (abs(at.linear.slope) @ v))
    measure = VALUES[name]
    if measure is _hessian:
        unit = elementary.square(terms / width)
    else:
        unit = terms * (part if measure is _quadratic else elementary.square(part))
    return unit if unit > 0.0 else 1.0


def types(curve: str, generic: bool) -> tuple[str, ...]:
    """What is looked for on a curve, in the order of its tests. generic : branch points in three parameters."""
    return GENERIC if curve == "BP" and generic else OWN.get(curve, ())
