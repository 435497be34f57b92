"""Declared symmetries: every branch once, the rest as images, complete up to the group that they generate."""

import numpy as np

from contin.api import diagram
from contin.model.model import Model

REFLECTIONS = {"sx": {"x": "-x"}, "sy": {"y": "-y"}}


def ends_at(found, p):
    """The sorted (x, y) at the last row of every branch that ends at this parameter value."""
    rows = [(b.columns["x"][-1], b.columns["y"][-1]) for b in found if abs(b.columns["p"][-1] - p) < 1e-12]
    return sorted((round(float(x), 9) + 0.0, round(float(y), 9) + 0.0) for x, y in rows)


def test_square_symmetry_gives_all_eight_half_branches_from_two_computed_ones():
    # x' = p x - x^3, y' = p y - y^3: beyond p = 0 the nine states {-1, 0, 1}^2 sqrt(p)
    model = Model(
        "square",
        states={"x": 0, "y": 0},
        parameters={"p": -1},
        equations={"x": "p*x - x^3", "y": "p*y - y^3"},
        symmetries={**REFLECTIONS, "swap": {"x": "y", "y": "x"}},
    )
    found = diagram(model, "p", (-1, 1))
    computed = [b for b in found if b.image_of is None]
    assert len(computed) == 3
    assert ends_at(found, 1.0) == sorted((float(x), float(y)) for x in (-1, 0, 1) for y in (-1, 0, 1))
    assert computed[0]["BP1"].normal_form["kernel"] == 2


def test_what_is_born_on_a_branch_is_born_on_its_image():
    # pure modes x^2 = p and y^2 = p - 1/5
    # mixed x^2 = (p - 2(p - 1/5))/(1 - 4), y^2 = (p - 1/5 - 2 p)/(1 - 4) beyond 2/5
    model = Model(
        "modes",
        states={"x": 0, "y": 0},
        parameters={"p": -1},
        equations={"x": "p*x - x^3 - 2*x*y^2", "y": "(p - 0.2)*y - y^3 - 2*y*x^2"},
        symmetries=REFLECTIONS,
    )
    found = diagram(model, "p", (-1, 2))
    x, y = np.sqrt((2 - 0.4) / 3), np.sqrt((2 + 0.2) / 3)
    expected = [(0.0, 0.0), (np.sqrt(2), 0.0), (-np.sqrt(2), 0.0), (0.0, np.sqrt(1.8)), (0.0, -np.sqrt(1.8))]
    expected += [(a * x, b * y) for a in (-1, 1) for b in (-1, 1)]
    np.testing.assert_allclose(ends_at(found, 2.0), sorted(expected), atol=1e-8)
    assert sum(b.image_of is None for b in found) == 4


def test_a_loop_between_two_pitchforks_is_computed_on_one_side_only():
    # x (1 - p^2 - x^2) = 0: the circle joins the trivial branch at p = -1 and p = 1
    model = Model(
        "loop",
        states={"x": 0},
        parameters={"p": -2},
        equations={"x": "x*(1 - p^2 - x^2)"},
        symmetries={"flip": {"x": "-x"}},
    )
    found = diagram(model, "p", (-2, 2))
    assert [b.name for b in found] == ["start", "start/BP1", "start/BP1~flip"]
    assert found["start/BP1"].ends[1].reason == "joined"
    assert found["start/BP1"].columns["p"][-1] == found["start"]["BP2"].values["p"]
