"""Period doublings of orbits by shooting, switched to from sections at any angle to the critical direction."""

from __future__ import annotations

import numpy as np
import pytest

import contin
from contin.model.model import Model

RANGE = (-0.7035, -0.6)
CIRCUIT = Model(  # Freire, Rodriguez-Luis, Gamero and Ponce (1993): one multiplier -1, the other 1e-7
    "cir", states={"x": 0, "y": 0, "z": 0}, parameters={"nu": -1, "beta": 0.6}, definitions={"k": "0.933578*(y - x)^3"},
    equations={"x": "(-(beta + nu)*x + beta*y - 0.328578*x^3 + k)/0.6", "y": "beta*x - beta*y - z - k", "z": "y"},
)  # fmt: skip


def test_doubled_orbits_by_shooting_are_those_by_collocation():
    line = contin.continuation(contin.equilibrium(CIRCUIT), "nu", (-1, 0))
    fork = contin.continuation(line["BP1"].switch(), "nu", (-0.7, 0))
    ends = []
    for method in ("shooting", "collocation"):
        family = contin.continuation(fork["HB1"].switch(), "nu", RANGE, settings={"method": method})
        assert family["PD1"].values["nu"] == pytest.approx(-0.70249065170, abs=1e-10)
        doubled = contin.continuation(family["PD1"].switch(), "nu", RANGE, settings={"method": method})
        assert (doubled.ends[1].reason, doubled.notes) == ("bound", ())
        ends.append([doubled.columns[name][-1] for name in ("period", "x.min", "x.max", "z.max")])
    assert ends[0][0] == pytest.approx(ends[1][0], rel=1e-8)
    np.testing.assert_allclose(ends[0], ends[1], rtol=1e-4)
