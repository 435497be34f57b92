"""Doubled cycles that come back to those of half their period: x -> q x (1 - x), as a map and as jumps of a clock.

Cycles of period 2 solve q^2 x^2 - q (q + 1) x + q + 1 = 0: they are there for q > 3, end in the fixed point at q = 3
and double at q = 1 + sqrt(6), each once.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

import contin
from contin.transitions.halved import halved


def family(kind: str, q: str, a: float, bounds: tuple[float, float]) -> contin.Branch:
    parameters = {"a": {"value": a, "range": list(bounds)}}
    if kind == "map":
        model = contin.Model(
            "logistic", kind="map", states={"x": 0.4}, parameters=parameters, equations={"x": f"({q})*x*(1 - x)"}
        )
        r = 3.3 if q == "a" else 3.2
        points = np.roots([r * r, -r * (r + 1.0), r + 1.0])
        start = contin.equilibrium(model, {"x": float(points.min())}, period=2)
    else:
        model = contin.Model(
            "clock",
            states={"s": 0.0, "x": 0.4},
            parameters=parameters,
            equations={"s": "1", "x": "0"},
            events=[{"when": "s - 1", "direction": "up", "set": {"s": 0, "x": f"({q})*x*(1 - x)"}}],
        )
        start = contin.periodic_orbit(model)
    return contin.continuation(start, "a", bounds)


@pytest.mark.parametrize("kind", ["map", "jumps"])
@pytest.mark.seldom
def test_doubled_cycles_end_at_the_period_doubling_and_are_not_run_through_again(kind):
    branch = family(kind, "a", 3.3, (2.5, 3.6))
    assert [end.reason for end in branch.ends] == ["joined", "bound"]
    assert branch.ends[0].data["at"] == pytest.approx(3.0, abs=1e-9)
    assert [(p.type, p.z[-1]) for p in branch.points] == [("PD", pytest.approx(1.0 + math.sqrt(6.0), abs=1e-9))]
    assert (np.diff(branch.columns["a"]) > 0.0).all()


@pytest.mark.parametrize("kind", ["map", "jumps"])
@pytest.mark.seldom
def test_a_bubble_of_doubled_cycles_has_two_ends_and_each_starts_the_family_of_half_the_period(kind):
    """q = 3.2 - a^2 is 3 at a = -+sqrt(0.2); there the cycle is the fixed point 1 - 1/q = 2/3."""
    branch = family(kind, "3.2 - a^2", 0.0, (-1.0, 1.0))
    assert [end.reason for end in branch.ends] == ["joined", "joined"]
    assert branch.points == ()
    for row, at in ((0, -math.sqrt(0.2)), (-1, math.sqrt(0.2))):
        assert branch.z[row, -1] == pytest.approx(at, abs=1e-8)
        half = contin.continuation(halved(branch.problem, branch.z[row]), "a", (-1.0, 1.0))
        x = half.columns["x" if kind == "map" else "x.max"]
        assert x == pytest.approx(1.0 - 1.0 / (3.2 - half.columns["a"] ** 2), abs=1e-9)
        assert [p.type for p in half.points] == ["PD", "PD"]


def test_the_diagram_of_a_map_with_a_bubble_lists_every_family_once():
    model = contin.Model(
        "bubbles", kind="map", states={"x": 0.6}, parameters={"a": -1.0}, equations={"x": "(3.47 - a^2)*x*(1 - x)"}
    )
    diagram = contin.diagram(model, "a", (-1.0, 1.0))
    assert [len(branch.points) for branch in diagram.branches] == [2, 2, 0]
    assert diagram.notes == []
