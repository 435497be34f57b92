"""Simulations: compiled, stiff, of maps; against closed forms and each other."""

import numpy as np
import pytest

import contin
from contin.errors import InputError
from contin.model.model import Model

DECAY = Model("decay", states={"x": 1, "y": 0}, parameters={"k": 2}, equations={"x": "-k*x", "y": "k*x"})
STIFF = Model("stiff", states={"x": 2, "y": 0}, parameters={"m": 1000}, equations={"x": "y", "y": "m*(1 - x^2)*y - x"})


@pytest.mark.parametrize("method", ["DOP853", "Radau", "LSODA", "BDF"])
def test_every_method_follows_an_exponential(method):
    found = contin.simulate(DECAY, parameters={"k": 0.5}, time=4.0, samples=41, method=method, rtol=1e-9)
    np.testing.assert_allclose(found.states[:, 0], np.exp(-0.5 * found.t), atol=1e-7)
    assert found.complete


def test_a_transient_is_left_out_but_time_goes_on():
    found = contin.simulate(DECAY, time=1.0, transient=1.0, samples=3)
    assert found.t == pytest.approx([1.0, 1.5, 2.0])
    assert found.states[0, 0] == pytest.approx(np.exp(-2.0), abs=1e-9)


@pytest.mark.seldom
def test_stiff_relaxation_has_the_period_of_its_singular_limit():
    # van der Pol, mu -> infinity: T = (3 - 2 log 2) mu + 7.014 mu^(-1/3) + ... (Dorodnicyn 1947)
    found = contin.simulate(STIFF, time=4000.0, samples=200_001, method="Radau", rtol=1e-8)
    x = found.states[:, 0]
    up = found.t[1:][(x[:-1] < 0) & (x[1:] >= 0)]
    assert np.diff(up)[0] == pytest.approx((3.0 - 2.0 * np.log(2.0)) * 1000.0 + 7.014 * 0.1, abs=1.0)


def test_a_stiff_model_is_recognised_and_named():
    found = contin.simulate(STIFF, parameters={"m": 1e7}, time=1e7, budget=20_000)
    assert found.outcome == "stopped"
    assert "Radau" in found.why


def test_a_map_is_iterated():
    model = Model("doubling", kind="map", states={"x": 1}, parameters={"a": 2}, equations={"x": "a*x"})
    assert contin.simulate(model, time=10.0).states[:, 0].tolist() == [2.0**k for k in range(11)]
    assert contin.simulate(model, time=100.0, box=1000.0).outcome == "escaped"


def test_forced_models_see_the_time():
    model = Model("ramp", states={"x": 0}, parameters={"w": 1}, forcing={"period": "2*pi"}, equations={"x": "cos(t)"})
    for method in ("DOP853", "LSODA"):
        found = contin.simulate(model, time=3.0, samples=31, method=method)
        np.testing.assert_allclose(found.states[:, 0], np.sin(found.t), atol=1e-7)


def test_a_blow_up_keeps_what_was_before_it():
    model = Model("blow", states={"x": 1}, parameters={"a": 1}, equations={"x": "a*x^2"})
    found = contin.simulate(model, time=2.0, samples=201)
    assert found.outcome == "stopped"
    assert 0.99 < found.t[-1] < 1.0 + 1e-9
    np.testing.assert_allclose(found.states[:50, 0], 1.0 / (1.0 - found.t[:50]), rtol=1e-7)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"method": "Euler"}, "method"),
        ({"time": -1.0}, "time"),
        ({"samples": 0}, "samples"),
        ({"transient": -1.0}, "transient"),
    ],
)
def test_bad_options_are_named(options, message):
    with pytest.raises(InputError, match=message):
        contin.simulate(DECAY, **options)
