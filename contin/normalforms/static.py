"""The critical matrix and directions that folds and branch points of flows and of maps share."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from contin.abi import Vector
from contin.machine import elementary
from contin.normalforms.jet import DerivativeJet, Jet, Real, along_units, lift, uncertain
from contin.normalforms.linear import EigenPair, null_pair
from contin.normalforms.result import STATE_ERROR, TRUST

ROUNDING = 1e-13  # some hundred roundings
MOST = 12  # states up to which forms are asked at all pairs of unit vectors
DIRECTIONS = 4  # of random signs
EPSILON = 8.0 * float(np.finfo(float).eps)  # of the largest component of a null vector
StateError: TypeAlias = float | Real | None  # a length, one for each state, or None: from the jet's typical sizes


def static_matrix(jet: Jet) -> Real:
    """F_u for a flow, F_u - 1 for a map: singular where solution branches fold or cross."""
    return jet.A - np.eye(jet.n) if jet.kind == "map" else jet.A


def static_pair(jet: Jet) -> EigenPair:
    """Null vectors of the static matrix; their eigenvalue is 0 (flow) or 1 (map)."""
    return null_pair(static_matrix(jet), 1.0 if jet.kind == "map" else 0.0, jet.scale)


def state(jet: Jet, vector: Vector) -> Vector:
    """A direction in which only the states move."""
    return lift(vector, jet.parameters)


def state_lengths(jet: Jet, state_error: StateError) -> Real:
    """The estimated error of each state: as given, else STATE_ERROR of the jet's typical sizes (of 1 if unknown)."""
    if state_error is None:
        state_error = STATE_ERROR * (np.ones(jet.n) if jet.scale is None else jet.scale)
    return np.broadcast_to(np.asarray(state_error, dtype=float), (jet.n,))


def quadratic_error(jet: Jet, p: Vector, v: Vector, w: Vector, state_error: StateError = None) -> float:
    """Estimated error of <p, B(v, w)>: cancellation over the components, rounding within them, and the error of u0.

    An error e of the states (a length, or one for each state) enters through the third derivative, as
    sum_i e_i |<p, C(v, w, e_i)>|; where each form is dear, bounded by `by_signs`.
    """
    dv, dw = state(jet, v), state(jet, w)
    whole = np.abs(p) @ np.abs(jet.form(dv, dw))
    lengths = state_lengths(jet, state_error)
    moved = lengths != 0.0
    if not moved.any():
        drift = 0.0
    elif are_dear(jet):
        drift = by_signs(jet, lengths, lambda d: float(abs(jet.form(dv, dw, d) @ p.conj())))
    else:
        drift = lengths[moved] @ np.abs(along_units(jet, dv, dw)[: jet.n][moved] @ p.conj())
    off = np.abs(p) @ uncertain(jet, dv, dw)
    return float(TRUST * whole + ROUNDING * form_size(jet, p, v, w) + drift + off)


def second_order_error(
    jet: Jet, p: Vector, directions: tuple[tuple[float, tuple[Vector, ...]], ...], whole: tuple[Vector, ...],
    drift: Real
) -> float:  # fmt: skip
    """Estimated error of <p, D^2F[v, w]> (or <p, DF[v]>): cancellation, that of differences, and that of the point.

    directions : the form is the sum of weight D^kF[directions].
    drift (n + parameters,) : estimated errors of the states and active parameters; they enter through D^3F[v, w, .].
    Components of p that vanish are rounding of the others, in units of the states' typical sizes.
    """
    parts = [weight * jet.form(*given) for weight, given in directions]
    size = sum(float(np.abs(p) @ np.abs(part)) for part in parts)
    noise = sum(weight * float(np.abs(p) @ uncertain(jet, *given)) for weight, given in directions)
    if jet.scale is not None:
        rounded = EPSILON * float(np.max(np.abs(p) * jet.scale)) / jet.scale
        size += sum(float(rounded @ np.abs(part)) for part in parts) / TRUST
    off = drift != 0.0
    moved = drift[off] @ np.abs(along_units(jet, *whole)[off] @ p) if off.any() else 0.0
    return float(TRUST * size + noise + moved)


def form_size(jet: Jet, p: Vector, v: Vector, w: Vector) -> float:
    """sum |p_i| |v_j| |w_k| |B_i(e_j, e_k)|: the scale of the rounding error of <p, B(v, w)>.

    Components of v and w that vanish are themselves known to rounding only: they count with the vector's length.
    Up to n = 12 every entry of B enters; beyond, sums over one index (n evaluations) stand for them, or their bound.
    """
    n = jet.n
    weights = np.abs(p)
    v, w = _filled(jet, v), _filled(jet, w)
    if are_dear(jet):
        return by_signs(jet, v, lambda d: float(weights @ np.abs(jet.form(d, state(jet, w)))))
    if n > MOST:
        eye = np.eye(n)
        rows = [np.abs(jet.form(state(jet, eye[j]), state(jet, w))) * abs(v[j]) for j in range(n) if v[j] != 0]
        return float(sum(weights @ row for row in rows))
    products, terms = np.outer(v, w), np.zeros((n, n, n))
    np.multiply(jet.second_sizes, products, out=terms, where=products > 0.0)  # what does not enter may be infinite
    return float(weights @ terms.sum(axis=(1, 2)))


def are_dear(jet: Jet) -> bool:
    """Whether a form at every unit vector costs too much: of return maps of many states each is a way round."""
    return jet.n > MOST and not (isinstance(jet, DerivativeJet) and jet.several is not None)


def by_signs(jet: Jet, lengths: Real, modulus: Callable[[Vector], float]) -> float:
    """A bound of sum_i lengths_i modulus(e_i), `modulus` that of a linear function, from a few directions.

    Its root mean square over random signs of the lengths is the root of the sum of the squares.
    """
    generator = np.random.default_rng(41)
    signs = generator.choice([-1.0, 1.0], (DIRECTIONS, jet.n))
    squares = [elementary.square(modulus(state(jet, lengths * row))) for row in signs]
    return float(np.sqrt(jet.n * np.mean(squares)))


def _filled(jet: Jet, v: Vector) -> Real:
    """|v|, no component below the vector's length in units of the states' typical sizes, where these are known."""
    if jet.scale is None:
        return np.abs(v)
    return np.asarray(np.maximum(np.abs(v), jet.scale * np.max(np.abs(v) / jet.scale)))
