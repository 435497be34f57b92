"""Folds (LP) and cusps (CP) of equilibria and of fixed points of maps."""

from __future__ import annotations

import numpy as np

from contin.normalforms.homological import CentreManifold
from contin.normalforms.jet import Jet
from contin.normalforms.later import Later
from contin.normalforms.result import DEGENERATE, NO_ERRORS, TRUST, Errors, NormalForm
from contin.normalforms.static import StateError, quadratic_error, state, static_pair


def fold(jet: Jet, *, state_error: StateError = None, further: Errors = NO_ERRORS) -> NormalForm:
    """LP: a = <p, B(q, q)>/2 of w' = a w^2 (map: w -> w + a w^2).

    a != 0 where the branch turns like a parabola. Kuznetsov, Elements, 3rd ed., sec. 5.4.1, with |q| = <p, q> = 1.
    Its error counts what else it is off by, `further`.
    """
    pair = static_pair(jet)
    q, p = pair.right, pair.left
    a = 0.5 * float(np.vdot(p, jet.form(state(jet, q), state(jet, q))))
    errors = Later(lambda: {"a": 0.5 * quadratic_error(jet, p, q, q, state_error) + further.get("a", 0.0)})

    def words() -> str:
        return "fold" if abs(a) > errors["a"] else "fold, quadratic coefficient zero to its estimated error (cusp)"

    return NormalForm("LP", {"a": a}, words, {"q": q, "p": p}, errors)


def cusp(jet: Jet) -> NormalForm:
    """CP: c = <p, C(q,q,q) + 3 B(q,h2)>/6 of w' = c w^3, A h2 = -(B(q,q) - <p,B(q,q)> q), <p,h2> = 0.

    Kuznetsov, Elements, 3rd ed., sec. 8.7; maps: Kuznetsov and Meijer (2005), with A - 1 for A.
    """
    pair = static_pair(jet)
    manifold = CentreManifold(jet, [pair])
    c = manifold.g((3,), 0).real
    error = TRUST * manifold.magnitude((3,), 0)
    coefficients: dict[str, object] = {"c": c}
    words = "cusp"
    if abs(c) <= error:  # a swallowtail, or equilibria that are not isolated
        coefficients["case"] = DEGENERATE
        words += ", cubic coefficient zero to its estimated error (swallowtail)"
    return NormalForm("CP", coefficients, words, {"q": pair.right, "p": pair.left}, {"c": error})
