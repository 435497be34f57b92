"""Small homoclinic orbits and the first directions of the curves that leave a Bogdanov-Takens point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contin.machine import elementary
from contin.normalforms.bogdanov_takens import JordanChain, jordan_chain
from contin.normalforms.jet import Jet, Real, lift
from contin.normalforms.linear import solve
from contin.normalforms.static import state


@dataclass(frozen=True, eq=False)
class BogdanovTakensUnfolding:
    """The map from the unfolding parameters (b1, b2) of w0' = w1, w1' = b1 + b2 w1 + a w0^2 + b w0 w1 to the model.

    dp = K (b1, b2) and u = u0 + q0 w0 + q1 w1 + H (b1, b2) to first order. Fold: b1 = 0; Hopf: b1 = -(a/b^2) b2^2;
    homoclinic: b1 = -4 eps^4/a, b2 = (10/7)(b/a) eps^2. All three leave the point along K[:, 1].
    """

    chain: JordanChain
    a: float
    b: float
    K: Real  # (2, 2), columns for b1 and b2
    H: Real  # (n, 2)

    def parameters(self, eps: float) -> Real:
        """p - p0 on the homoclinic curve, up to O(eps^4)."""
        return np.asarray(self.K @ self.beta(eps))

    def saddle(self, eps: float) -> Real:
        """u - u0 of the saddle, w0 = 2 eps^2/a."""
        return np.asarray(2.0 * elementary.square(eps) / self.a * self.chain.q0 + self.H @ self.beta(eps))

    def orbit(self, eps: float, times: Real) -> Real:
        """u - u0 on the homoclinic orbit at the times (its turning point at 0), up to O(eps^4): (len(times), n)."""
        s = eps * np.asarray(times, dtype=float)
        square = 1.0 / elementary.square(elementary.cosh(np.clip(s, -300.0, 300.0)))
        w0 = elementary.square(eps) / self.a * (2.0 - 6.0 * square)
        w1 = elementary.pow(eps, 3.0) / self.a * 12.0 * square * elementary.tanh(s)
        return np.asarray(np.outer(w0, self.chain.q0) + np.outer(w1, self.chain.q1) + self.H @ self.beta(eps))

    def beta(self, eps: float) -> Real:
        """(b1, b2) on the homoclinic curve."""
        square = elementary.square(eps)
        return np.array([-4.0 * square * square / self.a, 10.0 * self.b * square / (7.0 * self.a)])


def bogdanov_takens_unfolding(jet: Jet) -> BogdanovTakensUnfolding:
    """First-order parameter map of a generic BT point; the jet has two active parameters.

    K and H solve A H + F_p K = (q1, 0) with the solvability conditions of the orders w0 beta and w1 beta, a regular
    (n + 2) system if the family unfolds the point. Kuznetsov, Meijer, Al-Hdaibat and Govaerts, Int. J. Bifurcation and
    Chaos 24 (2014) 1450057; the orbit to leading order is Beyn's.
    """
    if jet.parameters != 2:
        raise ValueError(f"the unfolding needs a jet with two active parameters; this one has {jet.parameters}")
    chain = jordan_chain(jet.A, jet.scale)
    q0, q1, p0, p1 = chain.q0, chain.q1, chain.p0, chain.p1
    d0, d1 = state(jet, q0), state(jet, q1)
    n = jet.n
    B00, B01, B11 = jet.form(d0, d0), jet.form(d0, d1), jet.form(d1, d1)
    a, b = 0.5 * float(p1 @ B00), float(p0 @ B00 + p1 @ B01)

    def inverse(rhs: Real) -> Real:
        return np.asarray(solve(jet.A, rhs, p1[:, None], p0[:, None]))

    h20 = inverse(2.0 * a * q1 - B00)
    h20 = h20 + float(p0 @ B01 + 0.5 * p1 @ B11 - p0 @ h20) * q0
    h11 = inverse(h20 + b * q1 - B01)
    h02 = inverse(2.0 * h11 - B11)

    eye = np.eye(n + 2)
    slopes = np.array([jet.form(lift(np.zeros(n), 2, i)) for i in range(2)]).T
    D0 = np.array([jet.form(d0, e) for e in eye]).T  # (n, n + 2): B(q0, .) and F_up(q0, .)
    D1 = np.array([jet.form(d1, e) for e in eye]).T
    matrix = np.vstack([np.hstack([jet.A, slopes]), p1 @ D0, p1 @ D1 + p0 @ D0])
    rhs = np.zeros((n + 2, 2))
    rhs[:n, 0] = q1
    rhs[n:, 0] = p1 @ h11, p1 @ h02 + p0 @ h11
    rhs[n + 1, 1] = 1.0
    solution = solve(matrix, rhs)
    return BogdanovTakensUnfolding(chain, a, b, solution[n:], solution[:n])
