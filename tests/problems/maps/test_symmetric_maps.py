"""Maps with a symmetry, or an invariant area: cycles that a symmetry shifts, double multipliers."""

import math

import numpy as np
import pytest

import contin


def test_a_symmetric_two_cycle_splits_into_two_that_are_images_of_each_other():
    """x -> -a x + x^3: x = +-sqrt(a - 1) swap places from a = 1, split at a = 2, and the halves double at sqrt(5)."""
    model = contin.Model(
        "cubic", kind="map", states={"x": 0.0}, parameters={"a": 0.5}, equations={"x": "-a*x + x^3"},
        symmetries={"flip": {"x": "-x"}},
    )  # fmt: skip
    diagram = contin.diagram(model, "a", (0, 2.25))
    names = {branch.name: branch for branch in diagram.branches}
    swapped = names["start/PD1"]
    [split] = swapped.points
    assert (split.type, split.normal_form["kind"], split.normal_form["criticality"]) == (
        "BP", "pitchfork", "supercritical",
    )  # fmt: skip
    assert split.values["a"] == pytest.approx(2, abs=1e-10)
    half, image = names["start/PD1/BP1"], names["start/PD1/BP1~flip"]
    assert image.image_of is not None
    assert image.image_of.symmetry == "flip"
    assert half.points[0].values["a"] == pytest.approx(np.sqrt(5), abs=1e-10)
    np.testing.assert_allclose(image.columns["x"], -half.columns["x"])
    assert len([b for b in diagram.branches if b.parent and b.parent.branch == "start/PD1"]) == 2


@pytest.mark.seldom
def test_an_area_preserving_map_doubles_where_its_multiplier_is_minus_1_twice():
    """The standard map at q = pi has trace 2 - K and determinant 1: at K = 4 both multipliers are -1."""
    model = contin.Model(
        "standard", kind="map", states={"p": 0.0, "q": {"value": 3.14159, "period": "2*pi"}}, parameters={"K": 3.5},
        equations={"p": "p + K*sin(q)", "q": "q + p + K*sin(q)"},
    )  # fmt: skip
    line = contin.continuation(model, "K", (3.0, 4.5))
    [flip] = [p for p in line.points if p.type == "PD"]
    assert flip.values["K"] == pytest.approx(4, abs=1e-7)
    doubled = contin.continuation(flip.switch(), "K", (3.0, 4.5))
    assert doubled.columns["K"][-1] == pytest.approx(4.5)
    p, q, k = (doubled.columns[name] for name in ("p", "q", "K"))
    p1 = p + k * np.sin(q)
    q1 = q + p1
    np.testing.assert_allclose(p1 + k * np.sin(q1), p, atol=1e-8)
    assert abs(q1[-1] - q[-1]) > 0.1


@pytest.mark.seldom
def test_coupled_logistic_maps_cascade_in_step_and_out_of_step():
    """x' = (1 - e) f(x) + e f(y) and the same for y, f = r x (1 - x). On x = y the multipliers of a cycle are the
    logistic map's mu and (1 - 2 e)^period mu: doublings where either is -1, the second one out of step."""
    f, g, e = "r*x*(1 - x)", "r*y*(1 - y)", 0.1
    model = contin.Model(
        "coupled", kind="map", states={"x": 0.7, "y": 0.7}, parameters={"r": 2.8, "e": e},
        equations={"x": f"(1 - e)*{f} + e*{g}", "y": f"(1 - e)*{g} + e*{f}"}, symmetries={"swap": {"x": "y", "y": "x"}},
    )  # fmt: skip
    steady = contin.continuation(contin.equilibrium(model), "r", (2.5, 3.66))
    at = [point.values["r"] for point in steady.points]
    assert [point.type for point in steady.points] == ["PD", "PD"]
    assert at == pytest.approx([3, 2 + 1 / (1 - 2 * e)], abs=1e-11)  # mu = 2 - r
    two = contin.continuation(steady["PD1"].switch(), "r", (2.5, 3.66))
    transverse = 1 + math.sqrt(5 + 1 / (1 - 2 * e) ** 2)  # mu = 4 + 2 r - r^2
    assert [point.values["r"] for point in two.points] == pytest.approx([1 + math.sqrt(6), transverse], abs=1e-10)
    diagram = contin.diagram(model, "r", (2.5, 3.66), budget={"branches": 14})
    broken = [branch for branch in diagram if branch.name.endswith("/BP1")]
    assert len(broken) >= 3  # cycles of periods 2, 4 and 8 that the exchange shifts by half their period lose it
    for branch in broken:
        [image] = [other for other in diagram if other.name == f"{branch.name}~swap"]
        assert branch.ends[0].reason == "start"
        np.testing.assert_array_equal(image.columns["x"], branch.columns["y"])
