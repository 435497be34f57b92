"""Curves of points of codimension two in three parameters whose points meet a condition, against closed forms."""

import numpy as np
import pytest

import contin
from contin.errors import InputError
from contin.model.model import Model

BOX = (-6.0, 6.0)


def system(equations, parameters):
    return Model("m", states=dict.fromkeys(equations, 0), parameters=parameters, equations=equations)


def followed(model, start, label, names, kind, condition, ranges=None):
    """The curve of points of this kind in three parameters: from a line, a curve in two, all of them with condition."""
    more = {"conditions": [condition], "free": ["d"]}
    box = dict.fromkeys(names, BOX) | (ranges or {})
    line = contin.continuation(contin.equilibrium(model, start), names[0], box[names[0]], **more)
    two = {name: box[name] for name in names[:2]}
    curve = contin.continuation(line[label].locus(names[:2]), names[:2], two, **more)
    return contin.continuation(curve[kind].locus(names), names, box, **more)


@pytest.mark.seldom
def test_bogdanov_takens_points():
    """y' = a + b y + (x - c)^2 - d + (x - c) y (1 + d): x = c, b = 0, a = d with d = .3 x + .2 + .1 c; 1 + d = 0."""
    equations = {"x": "y", "y": "a + b*y + (x - c)^2 - d + (x - c)*y*(1 + d)"}
    model = system(equations, {"a": -0.5, "b": 1, "c": 0, "d": 0.2})
    start = {"x": -0.8, "y": 0}
    found = followed(
        model, start, "LP1", ("a", "b", "c"), "BT1", "d = 0.3*x + 0.2 + 0.1*c", {"a": (-3, 1), "c": (-4, 2)}
    )
    c = found.columns
    assert found.locus == "BT"
    assert found.free == ("d",)
    assert np.allclose(c["d"], 0.2 + 0.4 * c["c"], atol=1e-10)
    assert np.allclose([c["a"] - c["d"], c["b"], c["x"] - c["c"]], 0.0, atol=1e-10)
    assert [end.reason for end in found.ends] == ["bound", "bound"]
    assert [p.type for p in found.points] == ["DBT"]
    assert abs(found["DBT1"].values["c"] + 3.0) < 1e-9
    assert found["DBT1"].normal_form["a"] == pytest.approx(1.0)


def test_cusps_and_their_swallowtail():
    """x^4 + c x^2 + b x + a + d, where d = c x/10 is held: b = 8 x^3 as without it."""
    model = system({"x": "a + b*x + c*x^2 + x^4 + d"}, {"a": -3, "b": -3, "c": -0.5, "d": 0})
    found = followed(model, {"x": 1.6}, "LP2", ("a", "b", "c"), "CP1", "d = 0.1*x*c", {"c": (-0.6, 0.2)})
    x, c = found.columns["x"], found.columns["c"]
    assert np.allclose(c, -6 * x**2, atol=1e-9)
    assert np.allclose(found.columns["b"], 8 * x**3, atol=1e-9)
    assert np.allclose(found.columns["a"] + 0.1 * c * x, -3 * x**4, atol=1e-9)
    assert [p.type for p in found.points] == ["SW"]


def test_bautin_points_from_the_edge_of_the_third_range():
    """l1 ~ l and l2 ~ k: the start is k = 1 to rounding, on its bound."""
    rate = "(m + l*(x^2 + y^2) + k*(x^2 + y^2)^2)"
    model = system(
        {"x": f"x*{rate} - d*y", "y": f"y*{rate} + d*x"}, {"m": -0.5, "l": -0.3, "k": 1, "d": 1}
    )  # fmt: skip
    ranges = {"m": (-1, 1), "l": (-0.9, 1), "k": (-1, 1)}
    found = followed(model, {"x": 0, "y": 0}, "HB1", ("m", "l", "k"), "GH1", "d = 1 + m + l", ranges)
    assert np.allclose([found.columns["m"], found.columns["l"], found.columns["d"] - 1], 0.0, atol=1e-10)
    assert [p.type for p in found.points] == ["DGH"]
    assert sorted(end.text for end in found.ends) == ["k reached -1", "k starts on its bound 1"]


def test_a_start_outside_a_range_names_its_parameter():
    model = system({"x": "a + b*x + c*x^2 + x^4"}, {"a": -3, "b": -3, "c": -0.5})
    line = contin.continuation(contin.equilibrium(model, {"x": 1.6}), "a", BOX)
    folds = contin.continuation(line["LP1"].locus(("a", "b")), ("a", "b"), {"a": BOX, "b": BOX})
    names = ("a", "b", "c")
    with pytest.raises(InputError, match=r"the start has c = -0.5, outside the range \[0, 1\]"):
        contin.continuation(folds["CP1"].locus(names), names, {"a": BOX, "b": BOX, "c": (0, 1)})
