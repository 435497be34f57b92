"""Connecting orbits that come ever closer to one more saddle on their way: their curve ends there, in words."""

import numpy as np
import pytest

import contin


@pytest.fixture(scope="module")
def pulses():
    """x'' = x - x^3 + q x^5 has a pulse about its largest value X, q = 3 (X^2 - 2) / (2 X^4), which rises up to X = 2:
    there q = 3/16, x = 2 is a saddle, and the pulse is a front to it and one back from it."""
    model = contin.Model(
        "plateau", states={"x": 0.1, "y": 0}, parameters={"q": 0.17}, equations={"x": "y", "y": "x - x^3 + q*x^5"}
    )
    return contin.continuation(contin.connection(model, {"x": 0}, reversor={"y": "-y"}), "q", (0.16, 0.3))


def test_a_pulse_that_grows_to_a_plateau_ends_where_its_fronts_exist(pulses):
    end = next(end for end in pulses.ends if end.reason == "heteroclinic")
    assert end.data["saddle"] == pytest.approx({"x": 2.0, "y": 0.0}, abs=1e-6)
    assert abs(end.data["at"]["q"] - 3 / 16) < end.data["error"] < 1e-7


def test_every_row_lies_on_the_curve_of_pulses_and_none_is_a_fold(pulses):
    largest = pulses.columns["x.max"]
    assert np.abs(pulses.columns["q"] - 1.5 * (largest**2 - 2.0) / largest**4).max() < 1e-11
    assert len(pulses.columns["q"]) < 100
    assert not pulses.points
