"""Equations that vanish: folds and branch points do not depend on how the equations are written."""

import numpy as np
import pytest

import contin
from contin.model.model import Model


def line(equations, states, bounds=(-1.0, 2.0), **options):
    model = Model("a", kind="algebraic", states=states, parameters={"p": 1}, equations=equations)
    return contin.continuation(contin.equilibrium(model), "p", bounds, **options)


@pytest.mark.parametrize("mixed", [False, True])
def test_a_fold(mixed):
    """p = x y, y = x: a fold at p = 0; also as two combinations of the equations, whose eigenvalues are others."""
    plain = {"x": "p - x*y", "y": "y - x"}
    turned = {"x": "3*(y - x) - 2*(p - x*y)", "y": "5*(p - x*y) + (y - x)"}
    branch = line(turned if mixed else plain, {"x": 1, "y": 1})
    assert [p.type for p in branch.points] == ["LP"]
    assert abs(branch["LP1"].values["p"]) <= branch["LP1"].error
    assert branch.kind == "algebraic"
    assert "stable" not in branch.columns


def test_no_hopf_points_and_the_branches_that_cross():
    """x (p - x^2) with a rotation beside it, whose pair +-i p would be a Hopf point of a flow at p = 0."""
    equations = {"x": "x*(p - x^2)", "y": "p*y - z", "z": "y + p*z"}
    branch = line(equations, {"x": 0, "y": 0, "z": 0})
    assert [p.type for p in branch.points] == ["BP"]
    fork = contin.continuation(branch["BP1"].switch(), "p", (-1.0, 2.0))
    assert fork.columns["p"] == pytest.approx(np.square(fork.columns["x"]), abs=1e-9)


def test_a_closed_curve_is_gone_round_once_each_way_whatever_the_eigenvalues_do():
    """A four-bar linkage without a link that turns: coupler and rocker are in line at cos(th) = 1/16, th = +-1.508...

    Where eigenvalues of its Jacobian are nearly double, steps were shortened, and the start was passed unseen.
    """
    equations = {"b": "2*cos(p) + 2*cos(b) - 3 - 1.5*cos(c)", "c": "2*sin(p) + 2*sin(b) - 1.5*sin(c)"}
    model = Model("four-bar", kind="algebraic", states={"b": 0.8, "c": 1.6}, parameters={"p": 0.5}, equations=equations)
    branch = contin.continuation(contin.equilibrium(model), "p", (-7, 7))
    assert [end.reason for end in branch.ends] == ["closed", "closed"]
    assert branch.unexplained == 0
    assert branch.steps < 150  # measured: 94; with eigenvalues 20,422
    assert sorted(abs(p.values["p"]) for p in branch.points) == pytest.approx([np.arccos(1 / 16)] * 2, abs=1e-12)
