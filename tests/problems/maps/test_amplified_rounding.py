"""Coefficients of cycles with a large further multiplier, which amplifies rounding along the cycle.

Host and parasitoid (Beddington, Free and Lawton, Nature 255 (1975) 58): x -> x e^(r (1 - x) - 2 y) beside
y -> x (1 - e^(-2 y)). Without parasitoids cycles double as those of Ricker's map x e^(r (1 - x)), and c is its own;
where they invade, the other multiplier is 1.7e7 of a cycle of 64, and what is y in its last digit decides.
"""

import mpmath as mp
import numpy as np
import pytest

import contin
from contin.continuation.outcome import Verified
from contin.problems.equilibria.normal_forms import with_normal_form


def ricker_doubling(k: int, r: float, x: float) -> tuple[mp.mpf, ...]:
    """(c, r, x), c = (f''/2)^2 + f'''/6 of the k-th iterate where its derivative is -1, by Newton in 60 digits."""
    with mp.workdps(60):

        def iterate(r, x):
            """f^k(x + t) - x as a polynomial in t up to t^3."""
            c = [x, mp.mpf(1), mp.mpf(0), mp.mpf(0)]
            for _ in range(k):
                a, b, d = (-r * c[i] for i in (1, 2, 3))
                grown = [1, a, b + a * a / 2, d + a * b + a * a * a / 6]
                factor = mp.exp(r * (1 - c[0]))
                c = [factor * sum(c[j] * grown[i - j] for j in range(i + 1)) for i in range(4)]
            return [c[0] - x, *c[1:]]

        r, x = mp.findroot(lambda r, x: [iterate(r, x)[0], iterate(r, x)[1] + 1], (r, x), tol=1e-70)
        _, _, second, third = iterate(r, x)
        return second * second + third, r, x


@pytest.mark.parametrize("off", [0.0, 3.5e-17])
def test_the_error_of_a_coefficient_covers_what_a_large_multiplier_makes_of_rounding(off):
    exact, r, x = ricker_doubling(64, 2.69229269425, 2.0175696883)
    model = contin.load({
        "contin": 1, "name": "beddington", "kind": "map", "states": {"x": float(x), "y": 0.0},
        "parameters": {"r": {"value": float(r), "range": [2.6, 2.8]}},
        "equations": {"x": "x*exp(r*(1 - x) - 2*y)", "y": "x*(1 - exp(-2*y))"},
    })  # fmt: skip
    problem = contin.equilibrium(model, period=64).problem("r")
    point = Verified("PD", np.array([x, off, r], dtype=float), 1e-16, 1e-14, np.array([-1.0, 1.7e7 + 0j]), 1)
    form = with_normal_form(problem, point, np.array([2.0, 0.5, 0.2])).normal_form
    assert abs(form["c"] - exact) <= form["errors"]["c"] <= 1e-5 * exact
    assert form["criticality"] == "supercritical"
