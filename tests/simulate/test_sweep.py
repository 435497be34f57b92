"""Hysteresis sweeps: x' = p + 3 x - x^3 jumps at its folds p = +-2, in closed form."""

import numpy as np
import pytest

import contin
from contin.errors import InputError
from contin.model.model import Model
from contin.simulate.flight import fly
from contin.simulate.steady import Criterion

CUSP = Model("cusp", states={"x": -2}, parameters={"p": 0}, equations={"x": "p + 3*x - x^3"})
CALM = Criterion(20.0, longest=4000.0)


@pytest.fixture(scope="module")
def hysteresis():
    return contin.sweep(CUSP, "p", (-3.05, 3.05), steps=61, criterion=CALM)


def test_both_jumps_are_at_the_folds(hysteresis):
    jumps = hysteresis.jumps("x")
    assert [direction for direction, _, _ in jumps] == [1, -1]
    assert jumps[0][1] < 2.0 < jumps[0][2]
    assert jumps[1][2] < -2.0 < jumps[1][1]


def test_settled_states_are_equilibria(hysteresis):
    settled = np.array([outcome == "settled" for outcome in hysteresis.outcomes])
    x, p = hysteresis.columns["x.max"], hysteresis.values
    calm = settled & (np.abs(np.abs(p) - 2.0) > 0.15)
    assert np.abs(p + 3.0 * x - x**3)[calm].max() < 1e-2


def test_an_unstable_state_is_left_by_the_disturbance():
    model = Model("pitchfork", states={"x": 0}, parameters={"p": -1}, equations={"x": "p*x - x^3"})
    found = contin.sweep(model, "p", (-1.0, 1.0), steps=10, down=False, criterion=Criterion(20.0, longest=4000.0))
    assert abs(found.columns["x.max"][-1]) == pytest.approx(1.0, abs=1e-3)


def test_a_run_that_escapes_is_recorded():
    model = Model("fold", states={"x": 1}, parameters={"p": 1}, equations={"x": "p + x^2 - 2"})
    found = contin.sweep(model, "p", (0.0, 3.0), steps=3, start={"x": -1}, down=False, criterion=Criterion(20.0))
    assert found.outcomes[0] == "settled"
    assert found.outcomes[-1] in ("escaped", "stopped")


@pytest.mark.parametrize(("states", "name"), [(None, "u0"), (("x", "y"), "x")])
def test_a_run_of_a_function_that_escapes_names_the_state(states, name):
    """x' = a + x^2 has the stable state -sqrt(-a) up to its fold at a = 0, and none beyond: with a = 1 it is tan t."""
    given = contin.FunctionProblem(
        lambda u, p: np.array([p["a"] + u[0] ** 2, -u[1]]), [-1.0, 0.0], {"a": -1.0}, states=states
    )
    found = contin.sweep(given, "a", (-1.0, 1.0), steps=1, down=False, criterion=Criterion(5.0))
    assert found.outcomes[0] == "settled"
    assert found.outcomes[-1] == "escaped"
    flight = fly(given.measured().in_kernels, np.zeros(2), np.array([1.0]), 2.0, box=1e6)
    assert flight.outcome == "escaped"
    assert f"|{name}| exceeds 1e+06" in flight.why
    assert flight.end_time == pytest.approx(np.pi / 2, abs=2e-6)


def test_bad_ranges_and_names_are_refused():
    with pytest.raises(InputError, match="range"):
        contin.sweep(CUSP, "p", (1.0, 0.0))
    with pytest.raises(InputError, match="parameter"):
        contin.sweep(CUSP, "q", (0.0, 1.0))


def test_a_list_of_values_in_place_of_a_range_is_told_what_is_asked():
    with pytest.raises(InputError, match="a lower and an upper end; got 3 values"):
        contin.sweep(CUSP, "p", (0.0, 0.5, 1.0))


def test_a_measure_that_is_no_formula_is_named():
    model = contin.load("selkov")
    with pytest.raises(contin.InputError, match=r"measure r: '\(' is never closed"):
        contin.sweep(model, "b", (0.4, 0.9), measures={"r": "sqrt(x"})
