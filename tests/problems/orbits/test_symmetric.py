"""Families of orbits in systems with a symmetry that are started off it, or keep it with a shift by half a period."""

import numpy as np
import pytest

from contin import api
from contin.errors import NoSolutionError
from contin.model.model import Model


def test_family_started_at_an_unsymmetric_orbit_ends_where_it_meets_its_mirror_image():
    """Cycles of radius 1 across which w' = p w - w^3, w -> -w: a pitchfork at p = 0, along whose side one arrives."""
    model = Model(
        "pitchfork", states={"x": 1, "y": 0, "w": 0.7}, parameters={"p": 0.5}, definitions={"s": "x^2 + y^2"},
        equations={"x": "(1 - s)*x - y", "y": "x + (1 - s)*y", "w": "p*w - w^3"}, symmetries={"flip": {"w": "-w"}},
    )  # fmt: skip
    family = api.continuation(api.periodic_orbit(model), "p", (-1.0, 1.0))
    assert family.ends[0].reason == "joined"
    assert [p.type for p in family.points] == ["BPC"]
    assert family["BPC1"].values["p"] == pytest.approx(0.0, abs=1e-7)
    assert family["BPC1"].index == 0
    np.testing.assert_allclose(family.columns["w.min"][1:], np.sqrt(family.columns["p"][1:]), rtol=1e-6)
    assert not family.notes
    across = api.continuation(family["BPC1"].switch(), "p", (-1.0, 1.0))
    np.testing.assert_allclose(across.columns["w.max"], 0.0, atol=1e-9)


def freire() -> Model:
    """E. Freire, A. J. Rodriguez-Luis, E. Gamero, E. Ponce, Physica D 62 (1993) 230: AUTO-07p's demo `tor`."""
    return Model(
        "circuit", states={"x": 0, "y": 0, "z": 0},
        parameters={"nu": -0.9, "be": 0.5, "ga": -0.6, "r": 0.6, "a3": 0.328578, "b3": 0.933578},
        equations={
            "x": "(-(be + nu)*x + be*y - a3*x^3 + b3*(y - x)^3)/r", "y": "be*x - (be + ga)*y - z - b3*(y - x)^3",
            "z": "y",
        },
        symmetries={"flip": {"x": "-x", "y": "-y", "z": "-z"}},
    )  # fmt: skip


def test_torus_and_period_doubling_bifurcations_on_the_broken_branch_of_the_electronic_circuit():
    """Values of AUTO-07p with 50 intervals of 4 points and tolerances of 1e-9, which agree to 1e-9 or better."""
    line = api.continuation(api.equilibrium(freire()), "nu", (-0.9, -0.55))
    symmetric = api.continuation(line["HB1"].switch(), "nu", (-0.59, -0.55))
    assert [p.type for p in symmetric.points] == ["LPC", "BPC"]
    assert symmetric["LPC1"].values["nu"] == pytest.approx(-0.58433477187, abs=1e-9)
    assert symmetric["BPC1"].values["nu"] == pytest.approx(-0.587028974, abs=1e-8)
    assert symmetric["BPC1"].normal_form == {"kind": "pitchfork", "breaks": "flip"}
    broken = api.continuation(symmetric["BPC1"].switch(), "nu", (-0.65, -0.55))
    assert [p.type for p in broken.points] == ["NS", "PD"]
    assert broken["NS1"].values["nu"] == pytest.approx(-0.59165019513, abs=1e-9)
    assert broken["NS1"].values["period"] == pytest.approx(8.7941517464, rel=1e-8)


def test_chaotic_simulations_say_what_to_try():
    model = Model(
        "roessler", states={"x": 1, "y": 1, "z": 1}, parameters={"c": 5.7},
        equations={"x": "-y - z", "y": "x + 0.2*y", "z": "0.2 + z*(x - c)"},
    )  # fmt: skip
    with pytest.raises(NoSolutionError, match=r"chaotic.*Try: parameters at which an orbit is stable.*Hopf point"):
        api.periodic_orbit(model)
