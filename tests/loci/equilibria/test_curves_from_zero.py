"""Curves from points at which states are zero but for rounding: that rounding is no size."""

from __future__ import annotations

import pytest

import contin
from contin.model.model import Model


@pytest.mark.parametrize("kind", ["flow", "algebraic"])
@pytest.mark.parametrize("coupling", [1.0, 0.2, 0.0])
@pytest.mark.parametrize(("rate", "degenerate"), [("q + 3", -2.0), ("2*(q + 3)", -2.5), ("-(q + 3)", None)])
def test_branch_points_of_the_state_of_rest_lie_on_a_line(kind, coupling, rate, degenerate):
    """p x + c y / c0 = x^2 and r(q) y = x^2, c0 = c or 1: on p = x = y = 0, b20 ~ 1/r - 1 vanishes where r = 1."""
    scaled = f"{coupling!r}*y" if coupling else "0*y"
    strength = 1.0 / coupling if coupling else 1.0
    model = Model(
        "rest", kind=kind, states={"x": 0.0, "y": 0.0}, parameters={"p": -0.9, "q": 0.3},
        equations={"x": f"p*x + {scaled} - x^2", "y": f"({rate})*y - {strength!r}*x^2"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "p", (-1.0, 1.0))
    box = {"p": (-2.0, 2.0), "q": (-2.9, 2.0)}
    curve = contin.continuation(line["BP1"].locus(("p", "q")), ("p", "q"), box)
    assert abs(curve.columns["p"]).max() < 1e-12
    assert [end.reason for end in curve.ends] == ["bound", "bound"]
    assert curve.notes == ()
    wanted = [degenerate] if degenerate is not None and coupling else []
    assert [point.values["q"] for point in curve.points] == pytest.approx(wanted, abs=1e-9)
    assert {point.type for point in curve.points} <= {"DP"}
