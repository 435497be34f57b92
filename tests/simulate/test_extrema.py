"""Extremes of maps are iterates; of flows they lie between the samples; what jumps is not rounded off."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

import contin
from contin.model.model import Model
from contin.simulate.extrema import extremes_between, top
from contin.simulate.steady import Criterion

LOGISTIC = Model("logistic", kind="map", states={"x": 0.3}, parameters={"r": 4}, equations={"x": "r*x*(1 - x)"})


@pytest.mark.parametrize("r", [3.2, 3.5, 3.7, 3.9, 4.0])
def test_extremes_of_the_logistic_map_are_those_of_its_iterates(r):
    found = contin.sweep(LOGISTIC, "r", (r, r + 1e-9), steps=1, down=False, criterion=Criterion(200.0, longest=4000.0))
    low, high = float(found.columns["x.min"][0]), float(found.columns["x.max"][0])
    assert 0.0 <= low < high <= r / 4.0 * (1.0 + 1e-12)  # the interval [f(r/4), r/4] absorbs every orbit
    assert low >= r * r / 4.0 * (1.0 - r / 4.0) - 1e-12


def test_scans_of_maps_too():
    found = contin.scan(LOGISTIC, {"r": [4.0]}, settle={"window": 100.0, "longest": 1000.0})
    table = found.columns
    assert table["x_min"][0] >= 0.0
    assert table["x_max"][0] <= 1.0


def test_extremes_of_a_cycle_of_a_flow_lie_between_the_samples():
    model = Model(
        "stuart-landau", states={"x": 1, "y": 0.1}, parameters={"mu": 1, "w": 3},
        equations={"x": "mu*x - w*y - x*(x^2 + y^2)", "y": "w*x + mu*y - y*(x^2 + y^2)"},
        observables={
            "side": "sign(x)", "peak": "exp(20*(x - 1))", "roof": "-abs(y)",
            "needle": "exp(-1e6*((x - 0.6*mu^0.5)^2 + (y - 0.8*mu^0.5)^2))",  # a thousandth of a turn wide
        },
    )  # fmt: skip
    found = contin.sweep(
        model, "mu", (1.0, 1.44), steps=1, down=False, measures={k: k for k in ("x", "side", "peak", "roof", "needle")}
    ).columns
    assert found["x.max"] == pytest.approx([1.0, 1.2], rel=1e-8)
    assert found["x.min"] == pytest.approx([-1.0, -1.2], rel=1e-8)
    assert found["peak.max"] == pytest.approx([1.0, np.exp(4.0)], rel=1e-6)
    assert found["side.max"].tolist() == [1.0, 1.0]
    assert found["side.min"].tolist() == [-1.0, -1.0]
    assert np.all(found["roof.max"] <= 0.0)
    assert found["roof.max"] == pytest.approx([0.0, 0.0], abs=1e-6)
    assert found["needle.max"] == pytest.approx([1.0, 1.0], abs=1e-5)


def test_extremes_of_beats_lie_in_the_turn_that_goes_highest_and_not_beside_the_largest_sample():
    """Three cosines, 13 samples a turn, beside 200 times as many: the largest sample alone leads up to 4 % astray."""
    generator, t = np.random.default_rng(1), np.arange(400) * 2.0 * np.pi / 13.3
    looks = 0
    for _ in range(40):
        rates, sizes = [1.0, *generator.uniform(0.05, 1.9, 2)], [1.0, *generator.uniform(0.0, 0.5, 2)]
        phases = generator.uniform(0.0, 2.0 * np.pi, 3)

        def beats(times, rates=rates, sizes=sizes, phases=phases):
            nonlocal looks
            looks += 1
            return (np.cos(np.outer(times, rates) + phases) @ sizes)[:, None]

        low, high = extremes_between(t, beats(t), beats)
        dense = beats(np.linspace(t[0], t[-1], 80_001))
        assert [low[0], high[0]] == pytest.approx([dense.min(), dense.max()], abs=1e-5)
        assert high[0] >= dense.max() - 1e-12
        assert low[0] <= dense.min() + 1e-12
    assert looks <= 40 * 8  # measured 5 each, 2 by this test


def test_extremes_of_a_cosine_along_a_rotation_are_one_whatever_the_rate():
    model = Model(
        "snic", states={"x": {"value": 1, "period": "2*pi"}}, parameters={"w": 1.1}, equations={"x": "w - sin(x)"}
    )
    found = contin.sweep(model, "w", (1.05, 1.1), steps=2).columns
    for column, value in (("cos_x.min", -1.0), ("cos_x.max", 1.0), ("sin_x.min", -1.0), ("sin_x.max", 1.0)):
        assert found[column] == pytest.approx(np.full(6, value), abs=1e-8)


@given(st.floats(-0.4, 0.4), st.floats(0.01, 0.3))
def test_the_top_of_a_sine_to_fourth_order(offset, h):
    phase = h * (np.arange(-20, 21) + offset)
    values = np.cos(phase[np.abs(phase) < 1.5])
    assert top(values) == pytest.approx(1.0, abs=0.1 * h**4 + 1e-15)


@given(st.integers(3, 30), st.floats(-3, 3))
def test_the_top_of_a_step_and_of_a_corner_is_a_sample(where, slope):
    k = np.arange(40.0)
    step = np.where(k < where, 0.0, 1.0)
    assert top(step) == 1.0
    roof = -np.abs(k - where - 0.3) * abs(slope)
    assert top(roof) == roof.max()


def test_extremes_of_a_relaxation_oscillation_are_those_of_its_spikes_and_not_of_the_samples():
    """Van der Pol's equation at mu = 30: y spikes for 1 % of the period, within a sample; by a tight integration."""
    model = Model(
        "van-der-pol", states={"x": 2, "y": 0}, parameters={"mu": 1}, equations={"x": "y", "y": "mu*(1 - x^2)*y - x"}
    )
    found = contin.sweep(
        model, "mu", (1.0, 30.0), steps=1, down=False, criterion=Criterion(190.0, longest=800.0)
    ).columns

    def rates(t, u):
        return [u[1], 30.0 * (1.0 - u[0] ** 2) * u[1] - u[0]]

    flight = solve_ivp(rates, (0.0, 90.0), [2.0, 0.0], method="DOP853", rtol=1e-10, atol=1e-12, dense_output=True)
    times = (flight.t[:-1, None] + np.diff(flight.t)[:, None] * np.arange(10) / 10).ravel()
    top_of_y = flight.sol(times)[1].max()
    assert found["y.max"][1] == pytest.approx(top_of_y, rel=3e-5)
    assert found["y.min"][1] == pytest.approx(-top_of_y, rel=3e-5)
