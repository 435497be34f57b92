"""Normal forms of folds and branch points of boundary-value problems, the same on every mesh.

A solution has no time, so no pairing of null vectors is natural, and that of vectors of node values depends on the
mesh. Here q, the null function, has mean(|q|^2) = 1 over the states (the largest part positive), and the reduced
equation

    a01 dp + a02/2 dp^2 + b11 x dp + b20/2 x^2 + b30/6 x^3 = 0,   x = mean(q . (u - u0))

is divided by what makes its signs and sizes those of the solutions: at a fold a01 = -1, so dp = a x^2; at a branch
point |discriminant| = |b11^2 - a02 b20| = 1 and b11 >= 0, so dp = -b30/6 x^2 along the branch of a pitchfork.
"""

from __future__ import annotations

from functools import cached_property
from math import sqrt
from typing import Final

import numpy as np

from contin.abi import Array
from contin.bvp.on_mesh import OnMesh
from contin.linalg.linear import Solution
from contin.records import Fields

NOISE: Final = 1e-8  # of the largest part of a null vector, in the rows' own units: more is not known of the others
SAFETY: Final = 2.0  # of what a coefficient changes by on a finer mesh
ODD: Final = ("a01", "a02", "b20")  # coefficients that change their sign with q, whose sense is a matter of the mesh
TRUST: Final = 1e-7  # of the sum of a coefficient's terms, in which collocation has errors of its own


class Reduction:
    """Coefficients of the reduced equation at x along the null vector q (n,), up to a common factor.

    sizes : (n,) of the unknowns, beside which the parts of q count that Newton's method leaves near zero.
    """

    def __init__(self, mesh: OnMesh, x: Array, q: Array, sizes: Array) -> None:
        linear = mesh.linear(x)
        assert linear is not None
        self.mesh, self.x = mesh, x
        self.weights = _weights(mesh, x)
        size = sqrt(float(self.weights @ (q * q)))
        self.q = q / (size if size > 0.0 else 1.0)
        weighed = self.q * np.sqrt(self.weights)
        self.q = self.q * (1.0 if weighed[int(np.argmax(np.abs(weighed)))] >= 0.0 else -1.0)
        left = linear.factor.solve_transposed(q)
        self.left = left / np.abs(left).max()
        self._linear, self._sizes = linear, sizes

    @cached_property
    def _rounded(self) -> Array:
        """Moduli of the entries of p, none smaller than rounding leaves them."""
        moduli = np.abs(self.q)
        least = NOISE * self._sizes * np.max(moduli / self._sizes)  # where q is zero, remnants of it are no unit
        rows = self._linear.magnitude(np.maximum(moduli, least))
        part = np.abs(self.left) * rows
        rounding = np.where(rows > 0.0, NOISE * part.max() / np.where(rows > 0.0, rows, 1.0), 0)
        return np.asarray(np.abs(self.left) + rounding)

    @cached_property
    def _bordered(self) -> Solution:
        row = self.weights * self.q
        return self._linear.bordered(self.left[:, None], row[:, None], np.zeros((1, 1)))

    def along(self, r: Array) -> float:
        """<p, r>."""
        return float(self.left @ r)

    def gross(self, r: Array) -> float:
        """The sum of the moduli of the terms of <p, r>, entries of p no smaller than rounding leaves them."""
        return float(self._rounded @ np.abs(r))

    def response(self, r: Array) -> Array:
        """h with F_u h = -(r - <p, r> p / <p, p>) and mean(q . h) = 0, as a direction in x."""
        rest = r - self.along(r) / float(self.left @ self.left) * self.left
        return np.append(-self._bordered.solve(np.append(rest, 0.0))[:-1], 0.0)

    def form(self, *directions: Array) -> Array:
        return self.mesh.form(self.x, *directions)


def fold(mesh: OnMesh, x: Array, q: Array, sizes: Array) -> Fields:
    """`a`: the parameter is p0 + a x^2 along the branch."""
    here = Reduction(mesh, x, q, sizes)
    right = np.append(here.q, 0.0)
    slope = here.along(mesh.parameter_slope(x))
    if slope == 0.0:
        return {}
    return {"a": -0.5 * here.along(here.form(right, right)) / slope}


def branch_point(mesh: OnMesh, x: Array, q: Array, sizes: Array) -> Fields:
    """`kind` and the coefficients of the reduced equation; b20 is zero, and so the point a pitchfork, to its terms."""
    here = Reduction(mesh, x, q, sizes)
    right = np.append(here.q, 0.0)
    slope = mesh.parameter_slope(x)
    moved = here.response(slope) + np.append(np.zeros(mesh.n), 1.0)
    bent = here.form(right, right)
    a01, b20 = here.along(slope), here.along(bent)
    tilted = here.form(right, moved)
    a02, b11 = here.along(here.form(moved, moved)), here.along(tilted)
    b30 = here.along(here.form(right, right, right) + 3.0 * here.form(right, here.response(bent)))
    flat = abs(b20) <= TRUST * here.gross(bent)
    discriminant = b11 * b11 - a02 * (0.0 if flat else b20)
    factor = _factor(discriminant, b11, here.gross(tilted) * here.gross(tilted) + abs(a02 * b20))
    names = ("a01", "a02", "b11", "b20", "b30")
    degenerate = factor == 0.0
    factor = factor or 1.0
    form: Fields = {name: factor * value for name, value in zip(names, (a01, a02, b11, b20, b30), strict=True)}
    form["discriminant"] = factor * factor * discriminant
    if degenerate:
        return {"kind": "degenerate", **form}
    kind = "transcritical" if discriminant > 0.0 else "isolated"
    return {"kind": "pitchfork" if flat else kind, **form}


def moved_by_mesh(form: Fields, finer: Fields) -> Fields:
    """`errors` of the coefficients by what they change on a finer mesh; nothing where one of both has none."""
    names = [name for name, value in form.items() if isinstance(value, float) and name in finer]
    changes = []
    for sense in (1.0, -1.0):
        pairs = {name: (float(form[name]), float(finer[name]) * (sense if name in ODD else 1.0)) for name in names}
        changes.append({name: SAFETY * abs(there - here) for name, (here, there) in pairs.items()})
    return {"errors": min(changes, key=lambda change: sum(change.values()))} if names else {}


def _factor(discriminant: float, b11: float, terms: float) -> float:
    """What the reduced equation is multiplied by; 0 where the discriminant vanishes to its terms."""
    if abs(discriminant) <= TRUST * terms:
        return 0.0
    return (1.0 if b11 >= 0.0 else -1.0) / sqrt(abs(discriminant))


def _weights(mesh: OnMesh, x: Array) -> Array:
    """Of node values in the mean over the interval; only the states count."""
    profile, two = mesh.profile(x), mesh.problem.two
    weights = np.zeros_like(profile.u)
    weights[:, : two.n_states] = profile.weights[:, None]
    return np.asarray(weights.ravel())
