"""Diagrams with periodic orbits: what is followed, what is known already, what a symmetry makes of it."""

import time

import numpy as np
import pytest

from contin import api
from contin.model.model import Model


def orbits(diagram):
    return {b.name: b for b in diagram.branches if b.kind == "orbit"}


def test_homoclinic_orbits_of_the_lorenz_equations_are_glued():
    """The small cycles end at rho = 13.926557 (Sparrow 1982); a symmetric family, twice as long, starts there."""
    model = Model(
        "lorenz", states={"x": 0, "y": 0, "z": 0}, parameters={"rho": 0.5, "s": 10, "b": 8 / 3},
        equations={"x": "s*(y - x)", "y": "rho*x - y - x*z", "z": "x*y - b*z"},
        symmetries={"flip": {"x": "-x", "y": "-y"}},
    )  # fmt: skip
    found = orbits(api.diagram(model, "rho", (0.5, 26.0)))
    assert set(found) == {"start/BP1/HB1", "start/BP1/HB1~flip", "start/BP1/HB1/HOM1"}
    small, image, joined = found.values()
    assert small.ends[1].reason == "homoclinic"
    assert small.ends[1].data["at"]["rho"] == pytest.approx(13.926557, abs=1e-6)
    np.testing.assert_allclose(image.columns["x.min"], -small.columns["x.max"])
    np.testing.assert_allclose(image.columns["z.max"], small.columns["z.max"])
    np.testing.assert_allclose(joined.columns["x.min"], -joined.columns["x.max"], rtol=1e-6)
    assert joined.columns["period"][0] == pytest.approx(2.0 * small.columns["period"][-1], rel=1e-9)
    assert not joined.columns["stable"].any()
    assert not joined.points


def test_family_between_two_hopf_points_is_followed_once():
    """r' = r (p - p^2 - 3/16 - r^2): cycles between p = 1/4 and p = 3/4."""
    growth = "(p - p^2 - 3/16 - x^2 - y^2)"
    model = Model(
        "arch", states={"x": 0, "y": 0}, parameters={"p": 0.0},
        equations={"x": f"{growth}*x - y", "y": f"x + {growth}*y"},
    )  # fmt: skip
    found = orbits(api.diagram(model, "p", (0.0, 1.0)))
    assert len(found) == 1
    family = found["start/HB1"]
    assert family.ends[1].reason == "hopf"
    assert family.columns["p"][[0, -1]] == pytest.approx([0.25, 0.75], abs=1e-8)
    p = family.columns["p"][1:-1]
    np.testing.assert_allclose(family.columns["x.max"][1:-1] ** 2, p - p**2 - 3 / 16, rtol=1e-6)


def bubble() -> Model:
    """Across the circle r = 1, in axes that turn by half: X' = (p (1 - p) - 3/16 - X^2) X, Y' = -Y."""
    definitions = {
        "r": "sqrt(x^2 + y^2)", "R": "r - 1", "co": "x/r", "si": "y/r",
        "cc": "(1 + co)/2", "ss": "(1 - co)/2", "cs": "si/2",
        "Xc": "R*cc + z*cs", "Xs": "R*cs + z*ss", "Yc": "z*cc - R*cs", "Ys": "z*cs - R*ss",
        "g": "p*(1 - p) - 3/16 - (R^2*cc + 2*R*z*cs + z^2*ss)", "dR": "g*Xc + Ys - z/2", "dz": "g*Xs - Yc + R/2",
    }  # fmt: skip
    return Model(
        "bubble", states={"x": 1, "y": 0, "z": 0}, parameters={"p": 0.0}, definitions=definitions,
        equations={"x": "dR*co - y", "y": "dR*si + x", "z": "dz"},
    )  # fmt: skip


def test_doubled_orbits_come_together_at_the_other_period_doubling():
    """The doubled family lives for 1/4 < p < 3/4 and is complete at both ends."""
    family = api.continuation(api.periodic_orbit(bubble(), {"x": 1.05, "y": 0.0, "z": 0.02}), "p", (0.0, 1.0))
    assert [p.values["p"] for p in family.points] == pytest.approx([0.25, 0.75], abs=1e-9)
    assert [p.type for p in family.points] == ["PD", "PD"]
    doubled = api.continuation(family["PD1"].switch(), "p", (0.0, 1.0))
    assert doubled.ends[1].reason == "joined"
    assert doubled.columns["p"][-1] == pytest.approx(0.75, abs=1e-7)
    assert not doubled.points
    p = doubled.columns["p"][1:-1]  # R = X at theta = 0
    np.testing.assert_allclose(doubled.columns["x.max"][1:-1], 1.0 + np.sqrt(p - p**2 - 3 / 16), rtol=1e-3)


def test_branch_point_that_breaks_the_symmetry_of_an_orbit_is_named_and_its_image_not_computed():
    """Two Brusselators in anti-phase, u(t) = x(t + T/2), lose that symmetry; the new orbits come in pairs."""
    model = Model(
        "two", states={"x": 1, "y": 1.5, "u": 1, "v": 1.5}, parameters={"B": 1.5, "A": 1, "D": 0.02},
        equations={
            "x": "A - (B + 1)*x + x^2*y + D*(u - x)", "y": "B*x - x^2*y + 10*D*(v - y)",
            "u": "A - (B + 1)*u + u^2*v + D*(x - u)", "v": "B*u - u^2*v + 10*D*(y - v)",
        },
        symmetries={"swap": {"x": "u", "y": "v", "u": "x", "v": "y"}},
    )  # fmt: skip
    found = orbits(api.diagram(model, "B", (1.5, 3.0)))
    assert set(found) == {"start/HB1", "start/HB2", "start/HB2/BPC1", "start/HB2/BPC1~swap"}
    anti = found["start/HB2"]
    np.testing.assert_allclose(anti.columns["x.max"], anti.columns["u.max"], rtol=1e-6)
    assert anti["BPC1"].normal_form == {"kind": "pitchfork", "breaks": "swap"}
    broken, image = found["start/HB2/BPC1"], found["start/HB2/BPC1~swap"]
    assert image.image_of.branch == broken.name
    assert abs(broken.columns["x.max"][-1] - broken.columns["u.max"][-1]) > 0.1
    np.testing.assert_allclose(image.columns["x.max"], broken.columns["u.max"], rtol=1e-9)
    np.testing.assert_allclose(image.columns["B"], broken.columns["B"])


def test_doubled_orbits_from_a_simulation_end_where_they_meet_those_of_half_the_period():
    start = api.periodic_orbit(bubble(), {"x": 1.1, "y": 0.0, "z": 0.02}, {"p": 0.5})
    assert start.period == pytest.approx(4.0 * np.pi, rel=1e-6)
    family = api.continuation(start, "p", (0.0, 1.0))
    assert [end.reason for end in family.ends] == ["joined", "joined"]
    assert [end.data["at"] for end in family.ends] == pytest.approx([0.25, 0.75], abs=1e-7)
    assert not family.points


def test_the_time_of_a_budget_ends_a_family_that_would_go_on():
    model = Model(
        "rotating", states={"x": 0, "y": 0}, parameters={"p": -1.0}, definitions={"s": "x^2 + y^2"},
        equations={"x": "(p - s)*x - y", "y": "x + (p - s)*y"},
    )  # fmt: skip
    full = api.diagram(model, "p", (-1.0, 1e6), settings={"max_step": 1e-4, "steps": 2000})
    assert len(full["start/HB1"]) > 1000
    began = time.perf_counter()
    diagram = api.diagram(
        model, "p", (-1.0, 1e6), settings={"max_step": 5e-5, "steps": 10**8}, budget={"seconds": 1.0, "steps": 10**9}
    )
    assert time.perf_counter() - began < 60.0
    end = diagram.branches[-1].ends[1]
    assert end.reason == "steps"
    assert end.text.startswith("the time of the budget was used up at p = ")
