"""Symmetries that no model declares: the two halves of a pitchfork of orbits carry the same labels, each its own."""

from __future__ import annotations

import numpy as np
import pytest

from contin import api
from contin.model.model import Model

LORENZ = Model(
    "lorenz", states={"x": 20.0, "y": 20.0, "z": 300.0}, parameters={"p": 350.0, "s": 10.0, "b": "8/3"},
    equations={"x": "s*(y - x)", "y": "p*x - y - x*z", "z": "x*y - b*z"},
)  # fmt: skip
PUMPED = Model(  # driven through its stiffness: x -> -x
    "pumped", states={"x": 0.0, "v": 0.0}, parameters={"p": 0.0, "c": 0.1}, forcing={"period": "pi"},
    equations={"x": "v", "v": "-2*c*v - (1 + p*cos(2*t))*x - x^3"},
)  # fmt: skip


@pytest.mark.parametrize(
    ("model", "range_", "path", "born"),
    [(LORENZ, (210.0, 350.0), ("BPC1",), False), (PUMPED, (0.0, 4.0), ("PD1", "BPC1"), True)],
)
def test_both_halves_of_a_pitchfork_have_their_period_doublings(model, range_, path, born):
    branch = api.continuation(api.periodic_orbit(model), "p", range_)
    for label in path:
        branch = api.continuation(branch[label].switch(), "p", range_)
    left, right = (p for p in branch.points if p.type == "PD")
    assert abs(left.values["p"] - right.values["p"]) <= left.error + right.error
    assert np.isclose(left.values["x.max"], -right.values["x.min"], rtol=1e-4)
    np.testing.assert_allclose(left.normal_form["c"], right.normal_form["c"], rtol=1e-6)
    assert branch.notes == ()
    if born:  # and so have the orbits that are born there
        doubled = [api.continuation(p.switch(), "p", range_) for p in (left, right)]
        one, other = (b["PD1"].values["p"] for b in doubled)
        assert abs(one - other) <= doubled[0]["PD1"].error + doubled[1]["PD1"].error
        assert doubled[0].notes == doubled[1].notes == ()
