"""Extrema along branches against closed forms."""

import numpy as np
import pytest

import contin
from contin.model.model import Model


def test_a_slaved_state():
    """x = sin p: maxima and minima with curvature -+1."""
    model = Model("s", states={"x": 0}, parameters={"p": 0}, equations={"x": "sin(p) - x"})
    line = contin.continuation(contin.equilibrium(model), "p", (-8.0, 8.0), extrema=["x"])
    points = [p for p in line.points if p.type == "EX"]
    exact = np.pi * np.array([-2.5, -1.5, -0.5, 0.5, 1.5, 2.5])
    assert len(points) == len(line.points) == 6
    for point, place in zip(points, exact, strict=True):
        assert abs(point.values["p"] - place) <= max(point.error, 1e-10)
        high = np.sin(place) > 0
        assert point.normal_form["kind"] == ("maximum" if high else "minimum")
        assert point.normal_form["curvature"] == pytest.approx(-1.0 if high else 1.0, rel=1e-5)
        assert point.normal_form["of"] == "x"


def test_an_amplitude_of_orbits_and_an_observable():
    """r^2 = p (2 - p): the largest orbit at p = 1; the observable p*r^2 on equilibria of the amplitude equation."""
    orbits = Model(
        "o", states={"x": 1, "y": 0}, parameters={"p": 1.2},
        equations={"x": "x*(p*(2 - p) - x^2 - y^2) - y", "y": "y*(p*(2 - p) - x^2 - y^2) + x"},
    )  # fmt: skip
    family = contin.continuation(contin.periodic_orbit(orbits), "p", (0.3, 1.7), extrema=["x.max"])
    (point,) = [p for p in family.points if p.type == "EX"]
    assert abs(point.values["p"] - 1.0) < 1e-6
    assert point.values["x.max"] == pytest.approx(1.0, abs=1e-7)


def test_the_parameter_itself_turns_at_folds():
    model = Model("f", states={"x": 1}, parameters={"p": 1}, equations={"x": "p - x^2"})
    line = contin.continuation(contin.equilibrium(model), "p", (-1.0, 2.0), extrema=["p"])
    assert sorted(p.type for p in line.points) == ["EX", "LP"]
    assert abs(line["EX1"].values["p"]) <= line["EX1"].error + 1e-12


def _line(equation, observables, bounds, x, p, extrema=(), values=None):
    model = Model(
        "m", states={"x": x}, parameters={"p": p}, equations={"x": equation}, observables=observables, kind="algebraic",
    )  # fmt: skip
    return contin.continuation(contin.equilibrium(model), "p", bounds, extrema=list(extrema), values=values)


@pytest.mark.parametrize("e", [0.2, 1e-2, 1e-3])
def test_a_maximum_and_a_minimum_within_one_step(e: float):
    """x = p^3/3 - e^2 p turns at p = -e and e: both, or neither where rows do not let them be seen; never one."""
    line = _line(f"x - p^3/3 + {e!r}^2*p", {}, (-1.0, 1.0), -0.3, -1.0, ["x"])
    places = [p.values["p"] for p in line.points]
    assert places == pytest.approx([-e, e], abs=1e-9)
    assert [p.normal_form["kind"] for p in line.points] == ["maximum", "minimum"]


@pytest.mark.parametrize("e", [0.2, 1e-2])
def test_three_extrema_within_one_step(e: float):
    """x = p^4/4 - e^2 p^2/2: minima at -e and e, a maximum between."""
    line = _line(f"x - p^4/4 + {e!r}^2*p^2/2", {}, (-1.03, 1.0), 0.3, -1.03, ["x"])
    assert [p.values["p"] for p in line.points] == pytest.approx([-e, 0.0, e], abs=1e-9)
    assert [p.normal_form["kind"] for p in line.points] == ["minimum", "maximum", "minimum"]


def test_extrema_at_the_start():
    """On x^2 + p^2 = 1 from (1, 0): x, a flat one, and none of a column that is constant but for rounding."""
    observables = {"flat": "p^4", "constant": "x^2 + p^2", "odd": "p^3"}
    line = _line("x^2 + p^2 - 1", observables, (-0.9, 0.9), 1.0, 0.0, ["x", *observables])
    found = {p.normal_form["of"]: p.normal_form["kind"] for p in line.points}
    assert len(line.points) == 2
    assert found == {"x": "maximum", "flat": "minimum"}
    assert all(abs(p.values["p"]) <= 1e-8 for p in line.points)


def test_wanted_beside_a_start_that_is_special():
    """At the fold of p = x^2 both arms set out beside it: the parameter turns there, and x has its value there."""
    model = Model("f", states={"x": 0}, parameters={"p": 0}, equations={"x": "p - x^2"}, observables={"h": "x + 1"})
    start = contin.equilibrium(model)
    line = contin.continuation(start, "p", (-1.0, 1.0), extrema=["p"], values={"x": [0.0, 1e-6], "h": [1.0]})
    assert sorted(p.type for p in line.points) == ["EX", "LP", "UZ", "UZ", "UZ"]
    assert sorted(p.values["x"] for p in line.points if p.type == "UZ") == pytest.approx([0.0, 0.0, 1e-6], abs=1e-12)


def test_a_parameter_that_is_constant_along_a_curve_turns_nowhere():
    """Cusps of a stirred reactor: x = 1/2, B = 4 (1 + be), D = exp(-2) all along, but for rounding."""
    model = Model(
        "cstr", states={"x": 0.1, "y": 0.3}, parameters={"D": 0.05, "B": 9, "be": 1},
        equations={"x": "-x + D*(1-x)*exp(y)", "y": "-y + B*D*(1-x)*exp(y) - be*y"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "D", (0.01, 0.4))
    ranges, names = {"D": (0.01, 0.4), "B": (2, 16), "be": (0.1, 3)}, ["D", "B", "be"]
    two = {name: ranges[name] for name in names[:2]}
    folds = contin.continuation(line["LP1"].locus(names[:2]), names[:2], two)
    cusps = contin.continuation(folds["CP1"].locus(names), names, ranges, extrema=["D", "B"])
    assert [p.type for p in cusps.points] == ["BT"]
    form = cusps["BT1"].normal_form
    assert abs(form["a"]) <= form["errors"]["a"]


def test_a_parameter_that_is_zero_along_a_curve_turns_nowhere():
    """Hopf points of x' = y, y' = a + b x + x^2 - x y: the line a = 0, on which a is 1e-49 in place of 0."""
    model = Model(
        "bt", states={"x": -0.5, "y": 0}, parameters={"a": -0.2, "b": -0.3},
        equations={"x": "y", "y": "a + b*x + x^2 - x*y"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "a", (-1.0, 0.5))
    hopf = contin.continuation(
        line["HB1"].locus(["a", "b"]), ["a", "b"], {"a": (-1.0, 0.5), "b": (-1.5, 1.0)}, extrema=["a", "x"]
    )
    assert [p.type for p in hopf.points] == ["BT"]


@pytest.mark.parametrize("depth", [1e-2, 1e-4, 1e-8])
def test_a_value_that_is_taken_twice_within_one_step(depth: float):
    """h = (p - c)^2 is d at p = c -+ sqrt(d), and 0 at p = c, which it touches."""
    for c in (0.1, 0.123, 0.2777):
        line = _line("x - p", {"h": f"(x - {c})^2"}, (-1.0, 1.0), -1.0, -1.0, values={"h": [depth]})
        places = [p.values["p"] for p in line.points]
        assert places == pytest.approx([c - depth**0.5, c + depth**0.5], abs=1e-10)
        (touched,) = _line("x - p", {"h": f"(x - {c})^2"}, (-1.0, 1.0), -1.0, -1.0, values={"h": [0.0]}).points
        assert abs(touched.values["p"] - c) <= min(touched.error, 1e-6)


@pytest.mark.parametrize("jump", [-0.5, -2.0])
@pytest.mark.parametrize("c", [0.3, 0.03, 0.01, 2e-3, 1e-3, 5e-4, 1e-5])
def test_an_extremum_beside_a_corner(c: float, jump: float):
    """x = -p^2 + jump max(0, p - c): highest at p = 0 with x'' = -2, however near the corner is; or a note."""
    line = _line(f"x + p^2 - ({jump})*max(0, p - {c!r})", {}, (-1.0, 1.0), -1.0, -1.0, ["x"])
    if c < 1e-4:
        assert line.points == ()
        assert [note for note in line.notes if note.startswith("EX not verified")]
        return
    (point,) = line.points
    assert abs(point.values["p"]) <= max(point.error, 1e-11)
    assert point.normal_form["curvature"] == pytest.approx(-2.0, rel=1e-6)
    assert line.notes == ()


@pytest.mark.parametrize("end", [0.9, 0.9999999, 1.0, 1.0000001])
def test_nothing_is_labelled_beyond_the_end_of_a_branch(end: float):
    """g = (p - 1)^2 has its minimum 0 at p = 1, in the last step of the march wherever the range ends next to it."""
    line = _line("x - p", {"g": "(x - 1)^2"}, (0.0, end), 0.0, 0.0, ["g"], {"g": [0.0]})
    p = line.columns["p"]
    assert p[-1] == end == p.max()
    assert np.all(np.diff(p) >= 0.0)
    assert [point.type for point in line.points] == (["EX", "UZ"] if end >= 1.0 else [])
