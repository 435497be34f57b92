"""Trajectories of piecewise-smooth flows against closed forms; saltation against difference quotients."""

import numpy as np
import pytest

import contin
from contin.lowering import compile_system
from contin.model.model import Model
from contin.simulate.flight import fly
from contin.simulate.section import Section
from contin.simulate.trajectory import integrate


def flow(parameters=None, **equations):
    return compile_system(
        Model("flow", states=dict.fromkeys(equations, 0), parameters=parameters or {"c": 0.0}, equations=equations)
    )


@pytest.fixture(scope="module")
def bouncing():
    """x'' = -sign(x): parabolas; from (0, v) the period is 4 v, exactly."""
    return flow(x="y", y="-sign(x) + c")


def test_parabolas_close_after_exactly_four_times_the_velocity(bouncing):
    v = 1.7
    flight = fly(bouncing, [0.0, v], [0.0], 4.0 * v)
    np.testing.assert_allclose(flight.end, [0.0, v], atol=2e-13)
    assert flight.crossings[0] == pytest.approx([2.0 * v, 0], abs=1e-13)


def test_the_period_of_the_parabolas_depends_on_the_velocity_as_the_saltation_says(bouncing):
    # x(T; v) after one period moves by dx/dv = -4 v (the period grows by 4 dv, at speed v): M = [[1, -4 v], [0, 1]]
    v = 0.9
    x = 1e-3  # off the surface: on it the monodromy matrix is one-sided
    speed = np.sqrt(v * v - 2.0 * x)
    flight = fly(bouncing, [x, speed], [0.0], 4.0 * v, variations=np.eye(2), rtol=1e-12)
    turned = np.array([[1.0, 0.0], [0.0, 1.0]])
    field = np.array([speed, -1.0])
    slope = np.array([-1.0, -speed]) / v  # dT = 4 dv, v^2 = speed^2 + 2 x; a longer period puts the end back
    np.testing.assert_allclose(flight.variations, turned + 4.0 * np.outer(field, slope), atol=1e-10)


def test_sensitivity_to_a_parameter_is_the_difference_quotient(bouncing):
    u, column = [0.3, 1.1], np.array([2])
    flight = fly(bouncing, u, [0.1], 9.0, variations=np.zeros((2, 1)), columns=column, rtol=1e-12)
    h = 1e-6
    ends = [fly(bouncing, u, [0.1 + s], 9.0, rtol=1e-13).end for s in (h, -h)]
    np.testing.assert_allclose(flight.variations[:, 0], (ends[0] - ends[1]) / (2.0 * h), rtol=1e-7)


def test_error_falls_with_the_tolerance_as_between_smooth_pieces():
    system = flow(x="y", y="-x + (0.2*x*(1 - x^2) if x*y > 0 else -0.1*y)")
    exact = fly(system, [0.8, 0.3], [0.0], 40.0, rtol=1e-14, atol=1e-15).end
    ends = [fly(system, [0.8, 0.3], [0.0], 40.0, rtol=tol, atol=tol).end for tol in (1e-6, 1e-9)]
    errors = [np.abs(end - exact).max() for end in ends]
    assert errors[0] < 1e-4
    assert errors[1] < 2e-3 * errors[0]


def test_equal_oscillators_cross_together_and_stay_equal():
    model = contin.load("metronomes/pair")
    system = compile_system(model)
    u, p = model.start_point("in-phase", {})
    flight = fly(system, u, p, 200.0)
    np.testing.assert_allclose(flight.end[:2], flight.end[2:], rtol=0, atol=1e-13)
    assert flight.touched == 0


def test_saltation_of_the_pair_is_the_derivative_of_the_flow():
    model = contin.load("metronomes/pair")
    system = compile_system(model)
    _, p = model.start_point("in-phase", {})
    u, h = np.array([2.0, 0.1, 1.3, 0.7]), 1e-5
    flight = fly(system, u, p, 50.0, variations=np.eye(4), rtol=1e-12, atol=1e-13)
    for k in range(4):
        shift = h * np.eye(4)[k]
        ends = [fly(system, u + s, p, 50.0, rtol=1e-13, atol=1e-14).end for s in (shift, -shift)]
        np.testing.assert_allclose(flight.variations[:, k], (ends[0] - ends[1]) / (2.0 * h), atol=3e-8)


def test_a_start_on_a_surface_takes_the_side_the_flow_goes_to():
    system = flow(x="1", y="3 if x > 0 else 5")
    assert fly(system, [0.0, 0.0], [0.0], 2.0).end == pytest.approx([2.0, 6.0], abs=1e-13)


def test_two_crossings_within_one_step_are_both_found():
    # x = cos t dips below -0.999 for 2 acos(0.999) each turn, much less than a step
    system = flow(x="y", y="-x", z="1 if x < -0.999 else 0")
    flight = fly(system, [1.0, 0.0, 0.0], [0.0], 20.0 * np.pi, rtol=1e-12)
    assert flight.crossed == 20
    assert flight.end[2] == pytest.approx(10 * 2.0 * np.arccos(0.999), abs=1e-7)


def test_a_low_minimum_that_does_not_cross_changes_nothing():
    system = flow(x="y", y="-x", z="1 if x < -1.0001 else 0")
    flight = fly(system, [1.0, 0.0, 0.0], [0.0], 20.0 * np.pi)
    assert flight.crossed == 0
    assert flight.end[2] == 0.0


def test_surfaces_in_time_are_landed_on():
    pulses = {"x": "1 if sin(t) > 0.5 else 0"}
    model = Model("pulses", states={"x": 0}, parameters={"w": 1}, forcing={"period": "2*pi"}, equations=pulses)
    flight = fly(compile_system(model), [0.0], [1.0], 20.0 * np.pi)
    assert flight.end[0] == pytest.approx(10.0 * 2.0 * np.pi / 3.0, abs=1e-11)


def test_a_section_records_its_crossings_in_one_direction():
    system = flow(x="y", y="-x + c")
    section = Section(np.array([0.0, 1.0]), 0.5, 1)
    flight = fly(system, [1.0, 0.0], [0.0], 100.0, section=section, events=3)
    up = np.pi + np.arcsin(0.5)  # y = -sin t rises through 1/2
    assert flight.events[:, 0] == pytest.approx(up + 2.0 * np.pi * np.arange(3), abs=1e-9)


def test_dense_output_between_surfaces_is_exact_for_parabolas(bouncing):
    t = np.linspace(0.0, 3.9, 57)
    u = fly(bouncing, [0.0, 1.0], [0.0], 4.0, times=t).u
    expected = np.where(t < 2.0, t - t * t / 2.0, -(t - 2.0) + (t - 2.0) ** 2 / 2.0)
    np.testing.assert_allclose(u[:, 0], expected, atol=1e-13)


def test_sliding_is_named_and_not_integrated():
    flight = fly(flow(x="-sign(x) + c"), [0.5], [0.2], 10.0)
    assert flight.outcome == "sliding"
    assert flight.end_time == pytest.approx(0.5 / 0.8)
    assert "x = 0" in flight.why


def test_a_start_that_slides_is_named():
    assert fly(flow(x="-sign(x)"), [0.0], [0.0], 1.0).outcome == "sliding"


def test_a_solution_that_leaves_the_box_says_when():
    flight = fly(flow(x="x"), [1.0], [0.0], 100.0, box=10.0)
    assert flight.outcome == "escaped"
    assert np.log(10.0) <= flight.end_time < 5.0


def test_a_blow_up_ends_within_the_budget():
    flight = fly(flow(x="x^2"), [1.0], [0.0], 2.0)
    assert flight.outcome == "stopped"
    assert flight.end_time == pytest.approx(1.0, abs=1e-3)


def test_the_budget_of_steps_ends_a_flight():
    assert fly(flow(x="y", y="-x"), [1.0, 0.0], [0.0], 1e6, budget=100).outcome == "stopped"


def test_effort_of_the_pair_of_metronomes():
    model = contin.load("metronomes/pair")
    system = compile_system(model)
    _, p = model.start_point("in-phase", {})
    flight = fly(system, [2.0, 0.0, 1.3, 0.7], p, 2000.0, rtol=1e-9)
    assert flight.crossed == 2726
    assert flight.steps < 11_000  # measured 9656, of which 1806 are repeated


@pytest.mark.parametrize("depth", [1e-3, 1e-5, 1e-7, 1e-9])
@pytest.mark.parametrize("rtol", [1e-6, 1e-9])
def test_dips_through_a_surface_much_shorter_than_a_step_are_all_found(depth, rtol):
    # x = cos t is below -(1 - depth) for 2 acos(1 - depth) in each turn
    system = flow(x="y", y="-x", z="1 if x < -c else 0")
    flight = fly(system, [1.0, 0.0, 0.0], [1.0 - depth], 20.0 * np.pi, rtol=rtol, atol=1e-3 * rtol)
    if depth > 100.0 * rtol:  # below, the amplitude's own error decides
        assert flight.crossed == 20
    if depth > 1e4 * rtol:
        assert flight.end[2] == pytest.approx(20.0 * np.arccos(1.0 - depth), rel=1e2 * rtol / depth)


def test_a_parabola_of_surface_contacts_is_exact():
    # x' = 1, surface (x - 1)^2 - d: through it at 1 +- sqrt(d), integrated exactly by the method
    for d in (1e-2, 1e-6, 1e-10, 1e-14):
        flight = fly(flow(x="1", z="1 if (x - 1)^2 < c else 0"), [0.0, 0.0], [d], 3.0)
        assert flight.crossed == 2
        assert flight.end[1] == pytest.approx(2.0 * np.sqrt(d), rel=1e-6, abs=1e-9)


def test_leaving_the_box_is_timed():
    flight = fly(flow(x="x"), [1.0], [0.0], 100.0, box=10.0)
    assert flight.end_time == pytest.approx(np.log(10.0), rel=1e-9)
    assert flight.end[0] == pytest.approx(10.0, rel=1e-9)
    assert f"left the box at t = {np.log(10.0):.6g}" in flight.why


def test_memory_does_not_grow_with_the_time():
    import tracemalloc

    model = contin.load("metronomes/pair")
    system = compile_system(model)
    _, p = model.start_point("in-phase", {})
    fly(system, [2.0, 0.0, 1.3, 0.7], p, 10.0)
    peaks = []
    for time in (2e3, 1e5):  # 1e4 and 5e5 steps
        tracemalloc.start()
        fly(system, [2.0, 0.0, 1.3, 0.7], p, time)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] < 2.0 * peaks[0] < 1e6


def test_a_stiff_flow_is_named_before_its_budget_is_used():
    flight = fly(flow(x="-c*(x - cos(y))", y="1"), [1.0, 0.0], [1e7], 1e3)
    assert flight.outcome == "stopped"
    assert "stiff" in flight.why
    assert flight.steps <= 200_000


def test_what_cannot_be_done_within_the_budget_is_not_begun():
    flight = fly(flow(x="y", y="-x"), [1.0, 0.0], [0.0], 1e100)
    assert flight.outcome == "stopped"
    assert "budget" in flight.why


def test_a_start_of_the_wrong_length_is_named():
    with pytest.raises(contin.InputError, match=r"must have 2 values \(x, y\); got 3"):
        fly(flow(x="y", y="-x"), [1.0, 0.0, 2.0], [0.0], 1.0)
    with pytest.raises(contin.InputError, match="4 values"):
        contin.simulate(contin.load("metronomes/pair"), [1.0, 0.0, 2.0])


def test_oscillations_below_the_absolute_tolerance_are_still_resolved():
    # metronomes at rest to 1e-12: no error is left to control, yet every crossing is a crossing
    model = contin.load("metronomes/pair")
    system = compile_system(model)
    _, p = model.start_point("rest", {"beta": 0.98})
    flight = fly(system, [1e-12, 0.0, -1.1e-12, 1e-13], p, 3000.0, rtol=1e-8, atol=1e-11)
    assert flight.outcome == "done"
    assert 3700 < flight.crossed < 4000  # four a turn


@pytest.mark.parametrize("unit", [1.0, 1e-12])
@pytest.mark.parametrize("integrated", [fly, integrate])
def test_steps_are_not_shortened_for_rounding_of_what_cancels(integrated, unit):
    """x'' = x - 3/2 x^2 from near its saddle: y^2 = x^2 (1 - x), whose residual drives z, zero but for rounding."""
    system = flow({"k": unit}, x="y/k", y="k*(x - 1.5*x^2)", z="-2*z + x^2*(1 - x) - y^2/k^2")
    small = 1e-5
    path = integrated(system, [small, unit * small * np.sqrt(1 - small), 0.0], [unit], 20.0)
    x, y, z = path.end[0], path.end[1] / unit, path.end[2]
    assert path.steps < 45_000  # millions where z is asked to so many digits of its own
    assert y * y == pytest.approx(x * x * (1 - x), abs=1e-11)
    assert abs(z) < 1e-11
