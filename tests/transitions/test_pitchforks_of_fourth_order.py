"""Pitchforks whose cubic coefficient cancels to rounding: the branch that leaves with p ~ x^4 is followed."""

import numpy as np
import pytest

import contin


@pytest.mark.parametrize("c", [1.0, -1.0, 30.0])
def test_the_slaved_state_cancels_the_cubic_term(c):
    """x' = p x + x y - x^3 - c x^5, y' = x^2 - y: beside x = 0 the equilibria are y = x^2, p = c x^4."""
    model = contin.Model(
        "fourth", states={"x": 0, "y": 0}, parameters={"p": -1.0, "c": c},
        equations={"x": "p*x + x*y - x^3 - c*x^5", "y": "x^2 - y"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model, {"x": 0, "y": 0}), "p", (-1.0, 1.0))
    assert line["BP1"].normal_form["criticality"] == "degenerate"
    fork = contin.continuation(line["BP1"].switch(), "p", (-1.0, 1.0))
    assert [end.reason for end in fork.ends] == ["bound", "bound"]
    x = fork.columns["x"]
    assert x.min() < 0.0 < x.max()
    np.testing.assert_allclose(fork.columns["p"], c * x**4, atol=1e-9)


def test_two_brusselators_whose_diffusion_cancels_the_cubic_term():
    """A = 2, d = .1 and 1: x = A +- s with .6 s^4 + (B - 3.6) (s^2 - 4) = 0, from B = 3.6 on to smaller B at last."""
    model = contin.Model(
        "cells", states={"x": 2, "y": 1.5, "u": 2, "v": 1.5}, parameters={"B": 3.0},
        equations={
            "x": "2 - (B + 1)*x + x^2*y + 0.1*(u - x)", "y": "B*x - x^2*y + v - y",
            "u": "2 - (B + 1)*u + u^2*v + 0.1*(x - u)", "v": "B*u - u^2*v + y - v",
        },
        symmetries={"swap": {"x": "u", "u": "x", "y": "v", "v": "y"}},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "B", (2.0, 4.0))
    fork = contin.continuation(line["BP1"].switch(), "B", (2.0, 4.0))
    s = 0.5 * (fork.columns["x"] - fork.columns["u"])
    assert np.abs(s).max() > 1.0
    np.testing.assert_allclose(0.6 * s**4, (fork.columns["B"] - 3.6) * (4.0 - s**2), atol=1e-8)
