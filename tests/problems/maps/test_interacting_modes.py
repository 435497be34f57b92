"""LPPD, LPNS, PDNS and NSNS on curves of maps: their coefficients, of iterates as well, and what is told elsewhere."""

import numpy as np
import pytest

import contin
from contin.model.model import Model

HENON = {"x": "y", "y": "alpha - beta*x - y^2 + R*x*y"}
BOX = {"alpha": (-0.5, 0.5), "beta": (-1.5, -0.5)}


def curve_of(model: Model, label: str, box, period: int = 1):
    """The curve of `label` that the branch in the first parameter meets first."""
    names = tuple(box)
    branch = contin.continuation(contin.equilibrium(model, period=period), names[0], box[names[0]])
    return contin.continuation(next(p for p in branch.points if p.type == label).locus(names), names, box)


def henon(equations, states):
    return Model(
        "henon", kind="map", states=states, parameters={"alpha": 0.2, "beta": -0.8, "R": -0.1}, equations=equations
    )


@pytest.fixture(scope="module")
def fold_flip():
    curve = curve_of(henon(HENON, {"x": 0.5, "y": 0.5}), "LP", BOX)
    return next(p for p in curve.points if p.type == "LPPD").normal_form


def test_fold_flip_of_the_generalised_henon_map(fold_flip):
    """At alpha = 0, beta = -1: a/e = (1 - R)/2, b e = (1 + R)/4 (both of the fold-flip normal form)."""
    assert abs(fold_flip["a"] - 0.55) <= fold_flip["errors"]["a"] < 1e-7
    assert abs(fold_flip["b"] - 0.225) <= fold_flip["errors"]["b"] < 1e-7
    assert fold_flip["case"].startswith("a > 0, b > 0, invariant curve of the doubled orbit ")


def test_a_cycle_whose_second_iterate_is_that_map_has_its_coefficients(fold_flip):
    """s = 0, 1, 0, ...: the map acts where s = 0 and rests where s = 1."""
    equations = {name: f"{name} + (1 - s)*({text} - {name})" for name, text in HENON.items()} | {"s": "1 - s^2"}
    curve = curve_of(henon(equations, {"x": 0.5, "y": 0.5, "s": 0.0}), "LP", BOX, period=2)
    form = next(p for p in curve.points if p.type == "LPPD").normal_form
    for key in ("a", "b", "c", "d", "L_NS"):
        assert abs(form[key] - fold_flip[key]) <= form["errors"][key] + fold_flip["errors"][key] < 1e-6
    assert form["case"] == fold_flip["case"]


def turning(names, radius: str, angle: float) -> dict[str, str]:
    x, y = names
    cos, sin = float(np.cos(angle)), float(np.sin(angle))
    return {x: f"({radius})*({cos!r}*{x} - {sin!r}*{y})", y: f"({radius})*({sin!r}*{x} + {cos!r}*{y})"}


@pytest.mark.parametrize("angle", [0.7, float(2 * np.pi / 3) + 1e-5])
def test_two_rotations_that_interact(angle):
    """NSNS of z -> e^(i t) z (1 + p - 0.3 |z|^2 - 0.2 |w|^2), w likewise: numbers, or a note near 3 theta = 2 pi."""
    z, w = "(x^2 + y^2)", "(u^2 + v^2)"
    equations = turning("xy", f"1 + p - 0.3*{z} - 0.2*{w}", angle)
    equations |= turning("uv", f"1 + p/2 + q - 0.5*{z} - 0.7*{w}", 1.1)
    model = Model(
        "two", kind="map", states=dict.fromkeys("xyuv", 0.0), parameters={"p": -0.2, "q": -0.2}, equations=equations
    )
    curve = curve_of(model, "NS", {"p": (-0.3, 0.3), "q": (-0.3, 0.3)})
    (point,) = (p for p in curve.points if p.type == "NSNS")
    if angle > 1.0:
        assert point.normal_form == {}
        assert any("near-resonant: 3 theta1 = 2 pi to " in note for note in curve.notes)
        return
    form = point.normal_form  # z = sqrt(2) times the coordinate along its eigenvector
    assert [form[f"p{jk}"] for jk in ("11", "12", "21", "22")] == pytest.approx([-1.4, -1.0, -0.4, -0.6], abs=1e-8)
    assert form["case"] == "simple case II"


def test_where_no_parameter_unfolds_the_multiplier_one_it_is_said():
    """x = 0 is a fixed point for all parameters: folds are none, and the case of a fold is no whole one."""
    model = Model(
        "forced", kind="map", states={"x": 0.0, "y": 0.0}, parameters={"p": -0.1, "q": -0.1},
        equations={"x": "x*(1 + p) - x^2 + 0.3*y^2", "y": "-y*(1 + q + x) + 0.2*y^3"},
    )  # fmt: skip
    curve = curve_of(model, "BP", {"p": (-0.3, 0.3), "q": (-0.3, 0.3)})
    (point,) = (p for p in curve.points if p.type == "LPPD")
    assert point.normal_form["case"].endswith("no parameter unfolds the multiplier 1")
    assert point.normal_form["a"] == pytest.approx(1.0, abs=1e-8)
