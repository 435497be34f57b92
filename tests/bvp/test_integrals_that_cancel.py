"""Integrals in conditions that vanish by cancellation are known to what their terms are known to."""

import numpy as np
import pytest

import contin

FRONT, SLOPE = "1/(1 + exp(x/sqrt(2)))", "exp(x/sqrt(2))/(1 + exp(x/sqrt(2)))^2/sqrt(2)"


@pytest.mark.parametrize("length", [12, 20])
def test_a_front_is_held_by_its_own_profile(length):
    """u'' + c u' + u (1 - u)(u - a) = 0 from 1 to 0: u = 1/(1 + e^(x/sqrt 2)), c = (1 - 2a)/sqrt 2 for every a."""
    model = contin.load({
        "name": "nagumo", "kind": "bvp", "time": {"name": "x", "from": -length, "to": length},
        "states": {"u": 1, "v": 0}, "parameters": {"a": 0.3, "c": 0.28},
        "starts": {"front": {"u": FRONT, "v": f"-{SLOPE}"}},
        "equations": {"u": "v", "v": "-c*v - u*(1 - u)*(u - a)"},
        "conditions": [
            "u(start) = 1 + 2*v(start)/(sqrt(c^2 + 4*(1 - a)) - c)", "v(end) = -u(end)*(c + sqrt(c^2 + 4*a))/2",
            f"integral((u - {FRONT})*{SLOPE}) = 0",
        ],
    })  # fmt: skip
    start = contin.boundary_problem(model, "front", free=["c"])
    branch = contin.continuation(start, "a", (0.25, 0.75), values={"a": [0.5]})
    assert branch.notes == ()
    exact = (1.0 - 2.0 * branch.columns["a"]) / np.sqrt(2.0)
    tails = 20.0 * np.exp(-np.sqrt(2.0) * length)  # second order at the ends
    np.testing.assert_allclose(branch.columns["c"], exact, atol=1e-9 + tails)
