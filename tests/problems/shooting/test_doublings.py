"""Period doublings of orbits by shooting, switched to from sections at any angle to the critical direction."""

from __future__ import annotations

import pytest

import contin
from contin.model.model import Model

RANGE = (-0.7035, -0.6)
CIRCUIT = Model(  # Freire, Rodriguez-Luis, Gamero and Ponce (1993): one multiplier -1, the other 1e-7
    "cir", states={"x": 0, "y": 0, "z": 0}, parameters={"nu": -1, "beta": 0.6}, definitions={"k": "0.933578*(y - x)^3"},
    equations={"x": "(-(beta + nu)*x + beta*y - 0.328578*x^3 + k)/0.6", "y": "beta*x - beta*y - z - k", "z": "y"},
)  # fmt: skip


@pytest.mark.seldom
def test_doubled_orbits_by_shooting_end_where_they_come_back_to_those_of_half_the_period():
    """Between two period doublings of one family; past the second, the same orbits come again, half a turn later."""
    line = contin.continuation(contin.equilibrium(CIRCUIT), "nu", (-1, 0))
    fork = contin.continuation(line["BP1"].switch(), "nu", (-0.7, 0))
    settings = {"method": "shooting"}
    family = contin.continuation(fork["HB1"].switch(), "nu", RANGE, settings=settings)
    doubled = contin.continuation(family["PD1"].switch(), "nu", (-0.75, -0.6), settings=settings)
    assert (doubled.ends[1].reason, doubled.points, doubled.notes) == ("joined", (), ())
    solved = contin.continuation(fork["HB1"].switch(), "nu", (-0.7175, -0.6))
    (_, second) = (p for p in solved.points if p.type == "PD")
    assert doubled.ends[1].data["at"] == pytest.approx(second.values["nu"], abs=second.error + 1e-12)
    assert doubled.columns["period"][-1] == pytest.approx(2.0 * second.values["period"], rel=1e-8)
