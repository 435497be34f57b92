"""Branch points of equations without time that lie together: no eigenvalue counts them."""

from __future__ import annotations

import pytest

import contin
from contin.model.model import Model

APART = [0.0, 1e-5, 1e-3, 0.05]


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("apart", APART)
def test_they_are_labelled_whatever_the_signs_of_the_equations(apart, sign):
    """x (lam - 1 - ..) and +-y (lam - 1 - s - ..): branch points at 1 and 1 + s, one with two modes at s = 0."""
    model = Model(
        "pair", kind="algebraic", states={"x": 0, "y": 0}, parameters={"lam": 0.0, "s": apart, "k": sign},
        equations={"x": "x*(lam - 1 - x^2 - 2*y^2)", "y": "k*y*(lam - 1 - s - y^2 - 2*x^2)"},
    )  # fmt: skip
    branch = contin.continuation(contin.equilibrium(model), "lam", (-1, 3))
    places = [p.values["lam"] for p in branch.points if p.type == "BP"]
    assert places == pytest.approx([1.0, 1.0 + apart] if apart else [1.0], abs=1e-12)
    if not apart:
        assert branch["BP1"].normal_form["kernel"] == 2
