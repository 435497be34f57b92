"""What tests of GH, CH and GPD ask of coefficients along a curve: their values, and none of their errors."""

import numpy as np
import pytest

import contin
from contin.normalforms.cubic_of_maps import at_flip
from contin.normalforms.hopf import first_lyapunov, hopf
from contin.normalforms.maps import cubic_on_circle, neimark_sacker, period_doubling
from tests.normalforms.formulas import taylor_jet


@pytest.mark.seldom
def test_the_sign_of_the_first_lyapunov_coefficient_takes_no_derivatives_for_its_error():
    """The Bautin form beside a third state: GH at p = q = 0, where l1 = 2 q and l2 = -1 in sign."""
    asked = [0]

    def residual(u, p):
        asked[0] += 1
        x, y, z = u
        square = x * x + y * y
        rate = p["p"] + p["q"] * square - square * square
        return np.array([rate * x - y + z * x, rate * y + x + z * y, -z - 0.5 * z * z + p["q"] * square])

    line = contin.continuation(contin.FunctionProblem(residual, np.zeros(3), {"p": -0.2, "q": -0.3}), "p", (-0.3, 0.3))
    asked[0] = 0
    curve = contin.continuation(line["HB1"].locus(), ("p", "q"), {"p": (-1, 1), "q": (-0.4, 0.5)})
    assert [p.type for p in curve.points] == ["GH"]
    assert curve["GH1"].values["q"] == pytest.approx(0, abs=1e-12)
    assert asked[0] < 65_000  # measured 54,927; 121,167 with an error for every value of l1


def test_coefficients_without_errors_are_those_with_them():
    """Bit by bit: a zero is located by the one, and described by the other."""
    flow = taylor_jet(["x", "y"], [], ["-y + x*y + 0.3*x^2 - x^3", "x - 0.4*x*y + 0.7*y^2"], {"x": 0, "y": 0})
    assert first_lyapunov(flow, 1.0) == hopf(flow, 1.0).coefficients["l1"] != 0.0
    circle = taylor_jet(["x", "y"], [], ["0.6*x - 0.8*y + x*y - x^3", "0.8*x + 0.6*y + 0.7*y^2"], {"x": 0, "y": 0},
                        kind="map")  # fmt: skip
    theta = float(np.arctan2(0.8, 0.6))
    d = cubic_on_circle(circle, theta)
    assert [d.real, d.imag] == list(neimark_sacker(circle, theta).coefficients["d"])
    flip = taylor_jet(["x", "y"], [], ["-x + x*y + 0.7*x^3", "0.5*y + x^2"], {"x": 0, "y": 0}, kind="map")
    found = at_flip(flip)
    form = period_doubling(flip)
    assert found.value == form.coefficients["c"] != 0.0
    assert found.right.tolist() == form.vectors["q"].tolist()
