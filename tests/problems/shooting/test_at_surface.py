"""Families of piecewise-linear orbits whose period diverges at an equilibrium on a corner of the equations."""

import numpy as np
import pytest

import contin
from contin.model.model import Model

A, B = 0.25, 0.5
MCKEAN = Model(
    "mckean", states={"v": 0, "w": 0}, parameters={"I": 0.5, "a": A, "b": B, "eps": 0.1},
    equations={
        "v": "(-v if v < a/2 else (v - a if v < (1 + a)/2 else 1 - v)) - w + I",
        "w": "eps*(v - b*w)",
    },
)  # fmt: skip


@pytest.mark.seldom
def test_orbits_of_mckeans_neuron_begin_and_end_where_its_equilibrium_meets_a_corner():
    """The middle piece has an unstable node: orbits are born large where the equilibrium passes v = a/2, (1 + a)/2."""
    start = contin.periodic_orbit(MCKEAN, {"v": 0.0, "w": 0.0})
    family = contin.continuation(start, "I", (-0.5, 2.0))
    assert [end.reason for end in family.ends] == ["surface", "surface"]
    low, high = A / 2 + A / 2 / B, (1 + A) / 2 / B - (1 + A) / 2 + A
    assert family.ends[0].data["at"]["I"] == np.clip(family.ends[0].data["at"]["I"], low, low + 1e-5)
    assert family.ends[1].data["at"]["I"] == np.clip(family.ends[1].data["at"]["I"], high - 1e-5, high)
    assert "v - a/2 = 0" in family.ends[0].text
    assert not family.notes
    assert np.all(np.isfinite(family.columns["v.max"]))


def test_an_oscillator_on_a_belt_ends_where_its_orbit_comes_to_the_belts_speed():
    """Grazing-sliding: the largest speed of the slipping cycle is the belt's at vb = 1.1238847028 (DOP853, 1e-12)."""
    belt = Model(
        "belt", states={"x": 1.0, "v": 0.0}, parameters={"vb": 1.15},
        definitions={"vr": "v - vb"},
        equations={"x": "v", "v": "-x - sign(vr)*(1 - 1.42*abs(vr) + 0.33*abs(vr)^3)"},
    )  # fmt: skip
    cycle = contin.periodic_orbit(belt, {"x": -0.1, "v": 0.0})
    family = contin.continuation(cycle, "vb", (1.1, 1.16))
    [end] = [end for end in family.ends if end.reason != "bound"]
    assert end.reason == "surface"
    assert "v - vb = 0" in end.text
    assert abs(end.data["at"]["vb"] - 1.1238847028) < 1e-7


def test_cycles_of_a_centre_beside_a_surface_are_no_fold():
    """Chua's circuit: linear for x > 1, where at the Hopf point all cycles exist at once, up to the one that grazes."""
    chua = Model(
        "chua", states={"x": 1.8, "y": 0.0, "z": -1.8}, parameters={"al": 6.8, "be": 14.87, "a": -1.27, "b": -0.68},
        equations={
            "x": "al*(y - x - (b*x + (a - b)*(abs(x + 1) - abs(x - 1))/2))", "y": "x - y + z", "z": "-be*y",
        },
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(chua), "al", (6.5, 7.0))
    family = contin.continuation(line["HB1"].switch(), "al", (6.5, 7.0))
    assert family.points == ()
    al, low = family.columns["al"], family.columns["x.min"]
    assert np.ptp(al[low > 1.0]) < 1e-9
    assert al[-1] == 7.0
    assert low[-1] < 1.0
