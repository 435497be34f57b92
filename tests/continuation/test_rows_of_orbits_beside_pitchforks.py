"""Rows of families of orbits beside singular points are solutions to the tolerance, as those of equilibria."""

import numpy as np
from scipy.optimize import brentq

import contin


def test_rows_of_a_needle_of_cycles_are_solutions():
    """A circle beside z' = tanh(k z) - a z, k = 26645: rows next to a = k were 6.9e-7 off, called rounding."""
    k, beyond = 26645.114782104378, 1.034669705937736
    model = contin.Model(
        "needle", states={"x": 1, "y": 0, "z": 1}, parameters={"a": 1},
        equations={"x": "x - y - x*(x^2 + y^2)", "y": "x + y - y*(x^2 + y^2)", "z": f"tanh({k}*z) - a*z"},
    )  # fmt: skip
    branch = contin.continuation(contin.periodic_orbit(model), "a", (0.2, beyond * k))
    for a, low, high in zip(*(branch.columns[name] for name in ("a", "z.min", "z.max")), strict=True):
        solutions = [0.0]
        if a < k:
            root = brentq(lambda y, a=a: np.tanh(k * y) - a * y, 1e-12, 100.0, xtol=1e-15)
            solutions += [root, -root]
        z = max(low, high, key=abs)
        along = 1e-9 * k * abs(z) / (2.0 * k) if a < k else 0.0  # of rows the parameter may be off, too
        assert min(abs(z - one) for one in solutions) < 5e-8 + along
