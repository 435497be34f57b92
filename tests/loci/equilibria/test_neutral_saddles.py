"""Curves of Hopf points go on as neutral saddles past Bogdanov-Takens points, however far."""

import numpy as np
import pytest

import contin


def in_mixed_states(a: float, mix: float, rate: float) -> dict[str, object]:
    """x' = y, y' = b1 + b2 x + x^2 - x y in u = x + a y, v = y + mix x, with a state that follows at a rate.

    The trace vanishes at x = 0: the curve is b1 = 0, kappa = -b2, with a Bogdanov-Takens point at b2 = 0.
    """
    d = 1.0 - a * mix
    return {
        "name": "bt", "states": {"u": 0.1, "v": 0.1 * mix, "z": 0.1 / rate}, "parameters": {"b1": 0.1, "b2": -1.0},
        "definitions": {"x": f"(u - {a}*v)/{d}", "y": f"(v - {mix}*u)/{d}", "g": "b1 + b2*x + x^2 - x*y"},
        "equations": {"u": f"y + {a}*g", "v": f"g + {mix}*y", "z": f"-{rate}*z + x"},
    }  # fmt: skip


@pytest.mark.parametrize(("a", "mix", "rate"), [(0.0, 0.0, 1.0), (0.1, 5.0, 30.0), (3.0, -2.0, 100.0)])
def test_a_hopf_curve_goes_on_where_its_vector_would_meet_an_eigenvector(a, mix, rate):
    model = contin.load(in_mixed_states(a, mix, rate))
    line = contin.continuation(contin.equilibrium(model), "b1", (-0.3, 0.24))
    curve = contin.continuation(line["HB1"].locus(), ("b1", "b2"), {"b1": (-1.0, 1.0), "b2": (-2.0, 50.0)})
    assert [end.reason for end in curve.ends] == ["bound", "bound"]
    assert [point.label for point in curve.points] == ["BT1"]
    assert curve.notes == ()
    np.testing.assert_allclose(curve.columns["kappa"], -curve.columns["b2"], atol=1e-8)
    np.testing.assert_allclose(curve.columns["b1"], 0.0, atol=1e-9)


def test_a_further_eigenvalue_that_passes_zero_among_neutral_saddles_is_no_missing_label():
    """At x = 0, b = 0: +-sqrt(c), Hopf points for c < 0 and neutral saddles for c > 0; beside them c - 1/2."""
    equations = {"x": "y", "y": "b + c*x + x^2 - x*y", "z": "(c - 0.5)*z - z^3"}
    states = {"x": -1.0, "y": 0.0, "z": 0.0}
    model = contin.Model("saddles", states=states, parameters={"b": -0.75, "c": -1.0}, equations=equations)
    line = contin.continuation(contin.equilibrium(model), "b", (-2, 0.2))
    curve = contin.continuation(line["HB1"].locus(), ("c", "b"), {"c": (-2, 2), "b": (-2, 2)})
    assert [point.label for point in curve.points] == ["BT1"]
    neutral, c = np.array(curve.columns["neutral"]), np.array(curve.columns["c"])
    assert np.array_equal(np.array(curve.columns["unstable"])[neutral], c[neutral] > 0.5)
    assert not curve.notes
