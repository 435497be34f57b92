"""Flows that use the time without forcing, step functions of it, models without states, values that are none."""

import numpy as np
import pytest

import contin
from contin import Model
from contin.errors import InputError


def run(equations, states=None, time=5.0, samples=11, **more):
    states = dict.fromkeys(equations, 0) if states is None else states
    model = Model("m", states=states, equations=equations, **more)
    return contin.simulate(model, time=time, samples=samples, rtol=1e-10)


def test_the_time_may_drive_a_flow():
    found = run({"x": "cos(t) - 2*x"})
    exact = (2 * np.cos(found.t) + np.sin(found.t) - 2 * np.exp(-2 * found.t)) / 5
    np.testing.assert_allclose(found.states[:, 0], exact, atol=1e-9)


def test_a_jump_in_time_is_landed_on():
    found = run({"x": "3 if t > 1.234567 and t <= 3 else -1"})
    exact = -found.t + 4 * np.clip(found.t - 1.234567, 0.0, 3 - 1.234567)
    np.testing.assert_allclose(found.states[:, 0], exact, atol=1e-12)


def test_a_short_pulse_between_two_samples_is_seen():
    found = run({"x": "100 if t > 2.51 and t < 2.54 else 0"})
    assert found.states[-1, 0] == pytest.approx(3.0, rel=1e-12)


def test_step_functions_of_the_time_are_integrated_from_jump_to_jump():
    found = run({"x": "floor(t)", "y": "ceil(t/2)", "z": "1 if mod(t, 2) < 0.5 else 0", "w": "mod(-t, 3)"}, time=10.0)
    t, whole = found.t, np.floor(found.t)
    np.testing.assert_allclose(found.states[:, 0], whole * (whole - 1) / 2 + whole * (t - whole), atol=1e-12)
    half = np.floor(t / 2)
    np.testing.assert_allclose(found.states[:, 1], half * (half + 1) + (half + 1) * (t - 2 * half), atol=1e-12)
    np.testing.assert_allclose(found.states[:, 2], 0.5 * half + np.minimum(t - 2 * half, 0.5), atol=1e-12)
    turn = np.floor(t / 3)
    rest = t - 3 * turn
    np.testing.assert_allclose(found.states[:, 3], 4.5 * turn + 3 * rest - rest**2 / 2, atol=1e-11)


def test_too_many_jumps_are_refused():
    with pytest.raises(InputError, match="jumps more than 100000 times"):
        run({"x": "floor(1e6*t)"})


def test_a_model_may_have_no_states():
    found = run({}, {}, parameters={"a": 2}, observables={"y": "a*t^2", "z": "1/(t - 1)"}, time=2.0, samples=3)
    np.testing.assert_array_equal(found.observables, [[0, -1], [2, np.inf], [8, 1]])


def test_no_time_and_one_sample():
    found = run({"x": "1"}, {"x": 3}, time=0.0, samples=2)
    np.testing.assert_array_equal(found.states[:, 0], [3, 3])
    assert run({"x": "1"}, {"x": 3}, samples=1).states.tolist() == [[3]]


def test_states_that_are_no_numbers_stay_so_and_spoil_only_what_they_drive():
    states = {"x": "1/0", "y": "log(-1)", "z": 1, "w": 0}
    found = run({"x": "-3", "y": "1", "z": "-z", "w": "y + z"}, states)
    np.testing.assert_array_equal(found.states[:, 0], np.inf)
    np.testing.assert_array_equal(np.isnan(found.states[:, 1]), True)
    np.testing.assert_allclose(found.states[:, 2], np.exp(-found.t), rtol=1e-8)
    assert found.states[0, 3] == 0
    assert np.isnan(found.states[1:, 3]).all()


def test_a_rate_that_is_infinite_at_the_start_only_is_no_constant():
    found = run({"x": "1/sqrt(t)"})
    assert found.outcome == "stopped"


def test_branches_say_what_to_do_about_the_time():
    model = Model("driven", states={"x": 0}, parameters={"a": 1}, equations={"x": "cos(t) - a*x"})
    with pytest.raises(InputError, match=r"can only be simulated .* two ways out: declare `forcing: .* or replace t"):
        contin.equilibrium(model)
    with pytest.raises(InputError, match="no states"):
        contin.equilibrium(Model("empty", states={}, parameters={"a": 1}, equations={}))


def test_labels_name_the_columns_of_tables():
    names = {"pi_": "pi", "t_": "t"}
    found = run({"t_": "1"}, {"t_": 1}, observables={"pi_": "2*t_"}, labels=names)
    assert list(found.table) == ["time", "t", "pi"]
    np.testing.assert_allclose(found.table["t"], 1 + found.t)
    with pytest.raises(InputError, match="not a state or observable"):
        run({"x": "1"}, labels={"z": "q"})


def test_a_parameter_may_be_observed_as_itself_only():
    assert run({"x": "-k"}, parameters={"k": 2}, observables={"k": "k"}).columns["k"].tolist() == [2.0] * 11
    with pytest.raises(InputError, match="already declared under parameters"):
        run({"x": "-k"}, parameters={"k": 2}, observables={"k": "2*k"})


def test_step_functions_of_states_are_integrated_from_jump_to_jump():
    """x = t: y' = floor(x), z' = 1 where floor(3 x) is 4; and down again, where whole numbers are passed from above."""
    found = run({"x": "1", "y": "floor(x)", "z": "1 if floor(3*x) == 4 else 0", "w": "mod(x, 0.7)"}, time=10.0)
    t, whole = found.t, np.floor(found.t)
    np.testing.assert_allclose(found.states[:, 1], whole * (whole - 1) / 2 + whole * (t - whole), atol=1e-10)
    np.testing.assert_allclose(found.states[:, 2], np.clip(t - 4 / 3, 0, 1 / 3), atol=1e-10)
    turns = np.floor(t / 0.7)
    rest = t - 0.7 * turns
    np.testing.assert_allclose(found.states[:, 3], 0.245 * turns + rest**2 / 2, atol=1e-10)
    falling = run({"x": "-1", "y": "1 if mod(x, 1) < 0.25 else 0"}, {"x": 0.2, "y": 0}, time=10.0)
    assert falling.states[-1, 1] == pytest.approx(2.5, abs=1e-10)


def test_a_step_in_a_nonlinear_function_of_the_time():
    found = run({"y": "floor(t^2)"}, time=2.0, samples=3)  # jumps at sqrt(1), sqrt(2), sqrt(3)
    exact = (np.sqrt(2) - 1) + 2 * (np.sqrt(3) - np.sqrt(2)) + 3 * (2 - np.sqrt(3))
    assert found.states[-1, 0] == pytest.approx(exact, abs=1e-10)


def test_sliding_along_a_jump_is_said():
    found = run({"x": "0.5 - 2*floor(x)"}, {"x": 0.2})
    assert found.outcome == "sliding"
    assert found.end_time == pytest.approx(1.6)
    assert "both sides lead back" in found.why


def test_branches_of_flows_with_jumps_are_refused_in_words():
    model = Model("jumping", states={"x": 0.2}, parameters={"a": 1}, equations={"x": "a - floor(x)"})
    with pytest.raises(InputError, match="these jump, so it can only be simulated"):
        contin.equilibrium(model)


@pytest.mark.parametrize("condition", ["k == 4", "k >= 4", "not k > 4", "k != 3"])
def test_conditions_on_parameters_alone_are_no_surfaces(condition):
    found = run({"x": f"1 if {condition} else 0"}, parameters={"k": 4})
    np.testing.assert_allclose(found.states[:, 0], found.t, atol=1e-12)


def test_an_event_at_the_end_of_a_part_of_the_time_is_where_it_is():
    model = Model("line", states={"x": 0}, equations={"x": "1"})
    for place in (1, 1.1, 3):  # the time is looked at in 64 parts of 1/16
        assert contin.simulate(model, time=4.0, until=f"x > {place}").end_time == pytest.approx(place, abs=1e-12)
