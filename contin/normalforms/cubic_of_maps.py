"""The cubic coefficients of period doublings and Neimark-Sacker points by their formulas, for tests along curves.

    c = <p, C(q,q,q)/6 + B(q, h_2)>,                                (A - 1) h_2 = -B(q,q)/2
    d = e^{-i theta} <p, C(q,q,q*)/2 + B(q, h_11) + B(q*, h_20)>,   (A - 1) h_11 = -B(q,q*),
                                                                    (A - e^{2 i theta}) h_20 = -B(q,q)/2

These are what `contin.normalforms.homological` has where nothing else is resonant, with the same errors, at a third of
its time. Source: Kuznetsov, Elements of Applied Bifurcation Theory, 3rd ed., secs. 5.4.2 and 5.4.3.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contin.abi import Vector
from contin.machine import elementary
from contin.normalforms.homological import RESONANCE, ROUNDED
from contin.normalforms.jet import Jet, lift, otherwise, size_of_terms
from contin.normalforms.linear import null_pair, solve_with_growth
from contin.normalforms.poles import NEAR
from contin.normalforms.result import TRUST


@dataclass(frozen=True, eq=False)
class Cubic:
    """value : c or d.  right : q.  error : of the value; None where only the centre manifold tells it."""

    value: complex
    right: Vector
    error: float | None


def at_flip(jet: Jet, with_error: bool = False) -> Cubic:
    """c for the null vectors of A + 1."""
    pair = null_pair(jet.A + np.eye(jet.n), -1.0, jet.scale)
    q, p = pair.right.real, pair.left.real
    own, moved = lift(q, jet.parameters), jet.A - np.eye(jet.n)
    square = 0.5 * jet.form(own, own)
    h, growth = solve_with_growth(moved, -square)
    terms = [(1.0, [own, lift(h, jet.parameters)]), (1.0 / 6.0, [own, own, own])]
    value, error = _sum(jet, p, terms, with_error)
    return Cubic(value.real, q, None if growth > NEAR else error)


def on_circle(jet: Jet, theta: float, with_error: bool = False) -> Cubic | None:
    """d for multipliers e^{+-i theta}; None next to a resonance of third order or less."""
    value = complex(elementary.exp(1j * theta))
    square = value * value
    if min(abs(1.0 - value), abs(square - value), abs(square - value.conjugate())) <= RESONANCE:
        return None
    pair = null_pair(jet.A - value * np.eye(jet.n), value, jet.scale)
    own = lift(pair.right, jet.parameters)
    other = own.conj()
    h20, ahead = solve_with_growth(jet.A - square * np.eye(jet.n), -(0.5 * jet.form(own, own)))
    h11, still = solve_with_growth(jet.A - np.eye(jet.n), -jet.form(own, other))
    terms = [
        (1.0, [lift(h20, jet.parameters), other]), (1.0, [lift(h11, jet.parameters), own]), (0.5, [own, own, other]),
    ]  # fmt: skip
    found, error = _sum(jet, pair.left, terms, with_error)
    return Cubic(found / value, pair.right, None if max(ahead, still) > NEAR else error)


def _sum(
    jet: Jet, left: Vector, terms: list[tuple[float, list[Vector]]], with_error: bool
) -> tuple[complex, float | None]:  # fmt: skip
    """<left, sum of weight form>, and its error as that of the centre manifold is estimated."""
    total, sizes = np.zeros(jet.n, dtype=left.dtype), np.zeros(jet.n)
    for weight, directions in terms:
        form = weight * jet.form(*directions)
        total = total + form
        if with_error:
            sizes = sizes + np.abs(form) + ROUNDED * weight * size_of_terms(jet, *directions)
    value = complex(np.vdot(left, total))
    if not with_error or otherwise(jet):
        return value, None
    return value, TRUST * float(np.abs(left) @ sizes)
