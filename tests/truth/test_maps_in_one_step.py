"""Several bifurcations of fixed points of maps within one step: a multiplier passes the unit circle where
`10 p (p - e)(p + e)` vanishes, three times. All are labelled, within the errors that they state."""

from __future__ import annotations

import numpy as np
import pytest

import contin
from contin.model.model import Model

RATE = "10*p*(p - e)*(p + e)"
COS, SIN = float(np.cos(1.0)), float(np.sin(1.0))
EQUATIONS = {
    "BP": {"x": f"x*(1 + {RATE}) - x^3"},
    "PD": {"x": f"-x*(1 + {RATE}) + x^3"},
    "NS": {
        "x": f"(1 + {RATE} - x^2 - y^2)*({COS!r}*x - {SIN!r}*y)",
        "y": f"(1 + {RATE} - x^2 - y^2)*({SIN!r}*x + {COS!r}*y)",
    },
}  # fmt: skip


@pytest.mark.parametrize("e", [0.1, 1e-2, 1e-3, 1e-4])
@pytest.mark.parametrize("type_", list(EQUATIONS))
def test_three_crossings_in_a_step_are_three_labels_within_their_errors(type_, e):
    states = dict.fromkeys(EQUATIONS[type_], 0.0)
    model = Model("three", states=states, parameters={"p": -0.53, "e": e}, equations=EQUATIONS[type_], kind="map")
    branch = contin.continuation(contin.equilibrium(model), "p", (-0.57, 1.0))
    assert [point.type for point in branch.points] == [type_] * 3
    for point, place in zip(branch.points, (-e, 0.0, e), strict=True):
        assert abs(point.z[-1] - place) <= point.error
    assert branch.unexplained == 0


@pytest.mark.parametrize("e", [1e-5, 5e-6, 1e-7, 1e-10])
@pytest.mark.parametrize("type_", list(EQUATIONS))
def test_crossings_closer_than_rounding_tells_are_at_most_three_labels_and_a_note(type_, e):
    """The multiplier between them is 1 to 4e-16 e^3 / (1e-5)^3: its crossings are no more than rounding."""
    states = dict.fromkeys(EQUATIONS[type_], 0.0)
    model = Model("three", states=states, parameters={"p": -0.53, "e": e}, equations=EQUATIONS[type_], kind="map")
    branch = contin.continuation(contin.equilibrium(model), "p", (-0.57, 1.0))
    assert {point.type for point in branch.points} <= {type_}
    assert len(branch.points) <= 3
    assert branch.notes
