"""Points of codimension two of maps at which borders or coefficients have poles, and what is said of them."""

from types import SimpleNamespace

import numpy as np
import pytest

import contin
from contin.loci.codim2.uncomputed_tests import remarks, untold


def test_a_point_far_from_where_borders_were_chosen_is_solved_with_its_own():
    """Holmes' map: branch points d = 1 + b meet multiplier -1 at (0, -1), where the first row's borders are singular.

    There was a note that another curve crosses.
    """
    model = contin.Model("cubic", kind="map", states={"x": 0, "y": 0}, parameters={"b": 0.2, "d": 2.5},
                         equations={"x": "y", "y": "-b*x + d*y - y^3"})  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "d", (-1, 5))
    found = contin.continuation(line["BP1"].locus(), ("d", "b"), {"d": (-1, 5), "b": (-1.5, 1.5)})
    point = found["LPPD1"]
    assert [point.values["d"], point.values["b"]] == pytest.approx([0.0, -1.0], abs=1e-12)
    assert point.error < 1e-12
    assert found.notes == ()


def test_a_step_that_lands_on_a_labelled_pole_leaves_no_note():
    """A stage-structured population: c of period doublings has a pole at R2, whose label says so."""
    equations = {"x": "(f*y + g*z)*exp(-0.3*(x + y + z))", "y": "s*x", "z": "s*y"}
    model = contin.Model("stages", kind="map", states={"x": 0.5, "y": 0.5, "z": 0.2},
                         parameters={"f": 8, "s": 0.6, "g": 5}, equations=equations)  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "f", (1, 60))
    doublings = contin.continuation(line["PD1"].locus(), ("f", "s"), {"f": (1, 60), "s": (0.1, 0.95)})
    circles = contin.continuation(line["NS1"].locus(), ("f", "s"), {"f": (1, 60), "s": (0.1, 0.95)})
    assert sorted(point.type for point in doublings.points) == ["GPD", "R2"]
    for name in ("f", "s"):
        assert doublings["R21"].values[name] == pytest.approx(circles["R21"].values[name], rel=1e-9)
    assert doublings.notes == ()
    multipliers = np.abs(doublings["R21"].eigenvalues + 1.0)
    assert sorted(multipliers)[1] < 1e-6


def test_a_row_without_its_test_is_told():
    """Its sign is missing on both sides: zeros there are not found."""
    problem = SimpleNamespace(memory={})
    rows = np.array([[0.0, 1.0], [0.5, 1.5], [1.0, 2.0]])
    assert untold(problem, "GPD", rows[1], ValueError("a pole")) == 0.0
    assert [note[:42] for note in remarks(problem, rows)] == ["the test of GPD could not be computed at 1"]
    assert remarks(problem, rows[[0, 2]]) == []
