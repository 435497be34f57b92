"""Curves with known extrema, low and high, have exactly these with rows close together and far apart."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

import contin
from contin.model.model import Model

HEIGHTS = st.floats(-10.0, 0.0).map(lambda power: 10.0**power)  # of the whole range of the column, or of its size
STEPS = st.sampled_from([0.005, 0.05, 0.5])  # the longest


def _extrema(equation, column, x, p, step):
    """(p, kind, error of p) of every extremum of a column along an algebraic curve through (x, p)."""
    model = Model(
        "planted", states={"x": x}, parameters={"p": p}, equations={"x": equation}, observables={"c": column},
        kind="algebraic",
    )  # fmt: skip
    line = contin.continuation(
        contin.equilibrium(model), "p", (-1.2, 1.2), extrema=["c"], settings={"max_step": step, "step": min(step, 0.01)}
    )
    assert not line.notes
    return sorted((q.values["p"], q.normal_form["kind"], q.error) for q in line.points if q.type == "EX")


def _check(found, exact, height):
    """The extrema at these places, of these kinds, to their errors: rounding of c moves the zero of its difference."""
    assert [kind for _, kind, _ in found] == [kind for _, kind in exact]
    for (p, _, error), (place, _) in zip(found, exact, strict=True):
        assert abs(p - place) <= error + 1e-11
        assert error <= 1e-8 + 1e-12 / height


@given(HEIGHTS, st.floats(-1.0, 1.0), STEPS)
@settings(max_examples=15)
def test_a_parabola_has_one(height, centre, step):
    """c = 1 + h (p - m)^2."""
    found = _extrema("x - p", f"1 + {height!r}*(x - {centre!r})^2", -1.2, -1.2, step)
    _check(found, [(centre, "minimum")], height)


@given(HEIGHTS, st.floats(-0.25, 0.25), STEPS)
@settings(max_examples=15)
def test_a_cubic_has_two(height, centre, step):
    """c = t^3/3 - e^2 t, t = p - m: a minimum lower than the maximum by 4 e^3/3, h of the range of about 1."""
    e = (0.75 * height) ** (1 / 3)
    found = _extrema("x - p", f"(x - {centre!r})^3/3 - {e!r}^2*(x - {centre!r})", -1.2, -1.2, step)
    _check(found, [(centre - e, "maximum"), (centre + e, "minimum")], 1.0)


@given(HEIGHTS, st.floats(0.1, 3.0), STEPS)
@settings(max_examples=15)
def test_a_circle_has_a_highest_and_a_lowest_point(height, angle, step):
    """c = 1 + h (x cos a + p sin a) on x^2 + p^2 = 1, all round."""
    a, b = float(np.cos(angle)), float(np.sin(angle))
    found = _extrema("x^2 + p^2 - 1", f"1 + {height!r}*({a!r}*x + {b!r}*p)", 0.8, 0.6, step)
    _check(found, [(-b, "minimum"), (b, "maximum")], height)


@given(st.floats(-1.0, 1.0), STEPS)
@settings(max_examples=5)
def test_what_is_constant_but_for_rounding_has_none(turned, step):
    assert _extrema("x^2 + p^2 - 1", f"(x + {turned!r}*p)^2 + (p - {turned!r}*x)^2", 0.8, 0.6, step) == []


@given(STEPS)
@settings(max_examples=3)
def test_a_closed_curve_that_starts_at_an_extremum_has_it_once(step):
    found = _extrema("x^2 + p^2 - 1", "1 + 0.8*x + 0.6*p", 0.8, 0.6, step)
    _check(found, [(-0.6, "minimum"), (0.6, "maximum")], 1.0)


def test_two_columns_that_turn_at_one_place_both_do():
    """c = x^2 and d = cos p on x = p, away from the start."""
    model = Model(
        "two", states={"x": -0.8}, parameters={"p": -0.8}, equations={"x": "x - p"}, kind="algebraic",
        observables={"c": "x^2", "d": "cos(p)"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "p", (-0.8, 1.2), extrema=["c", "d"])
    forms = [point.normal_form for point in line.points]
    assert {form["of"]: form["kind"] for form in forms} == {"c": "minimum", "d": "maximum"}
    assert all(abs(point.values["p"]) <= point.error + 1e-12 for point in line.points)
