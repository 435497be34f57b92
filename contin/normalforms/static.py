"""The critical matrix and directions that folds and branch points of flows and of maps share."""

from __future__ import annotations

import numpy as np

from contin.normalforms.jet import Jet, Real, Vector, lift
from contin.normalforms.linear import EigenPair, null_pair
from contin.normalforms.result import TRUST

ROUNDING = 1e-13  # some hundred roundings


def static_matrix(jet: Jet) -> Real:
    """F_u for a flow, F_u - 1 for a map: singular where solution branches fold or cross."""
    return jet.A - np.eye(jet.n) if jet.kind == "map" else jet.A


def static_pair(jet: Jet) -> EigenPair:
    """Null vectors of the static matrix; their eigenvalue is 0 (flow) or 1 (map)."""
    return null_pair(static_matrix(jet), 1.0 if jet.kind == "map" else 0.0, jet.scale)


def state(jet: Jet, vector: Vector) -> Vector:
    """A direction in which only the states move."""
    return lift(vector, jet.parameters)


def quadratic_error(jet: Jet, p: Vector, q: Vector) -> float:
    """Estimated error of <p, B(q, q)>: cancellation over the components, and rounding within them."""
    whole = np.abs(p) @ np.abs(jet.form(state(jet, q), state(jet, q)))
    return TRUST * float(whole) + ROUNDING * form_size(jet, p, q)


def form_size(jet: Jet, p: Vector, q: Vector) -> float:
    """sum |p_i| |q_j| |q_k| |B_i(e_j, e_k)|: the scale of the rounding error of <p, B(q, q)>.

    Up to n = 12 every entry of B enters; beyond, sums over one index (n evaluations) stand for them.
    """
    n = jet.n
    eye = np.eye(n)
    weights = np.abs(p)
    used = np.flatnonzero(np.abs(q) > 1e-14 * np.abs(q).max())
    if n > 12:
        rows = [np.abs(jet.form(state(jet, eye[j]), state(jet, q))) * abs(q[j]) for j in used]
        return float(sum(weights @ row for row in rows))
    total = 0.0
    for a, j in enumerate(used):
        for k in used[: a + 1]:
            entry = np.abs(jet.form(state(jet, eye[j]), state(jet, eye[k])))
            total += (1.0 if j == k else 2.0) * abs(q[j] * q[k]) * float(weights @ entry)
    return total
