"""Several bifurcations of orbits within one step: `10 p (p - e)(p + e)` crosses three times, a quartic folds thrice.

The unit circle of (a, b) carries states whose growth rate that polynomial is, or has a radius on the quartic. Every
crossing is a label at its place to its error, or a note says that they could not be told apart.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import contin
from contin.continuation.settings import Settings
from contin.model.model import Model

RATE = "10*p*(p - e)*(p + e)"
CIRCLE = {"a": "a - b - a*(a^2 + b^2)", "b": "a + b - b*(a^2 + b^2)"}
FOLDING = "-(p - ((a^2 + b^2 - 1)^4/4 - e^2*(a^2 + b^2 - 1)^2/2))"
EQUATIONS = {
    "BPC": CIRCLE | {"x": f"({RATE})*x - x^3"},
    "NS": CIRCLE | {"u": f"({RATE})*u - 0.37*v - u*(u^2 + v^2)", "v": f"({RATE})*v + 0.37*u - v*(u^2 + v^2)"},
    "PD": CIRCLE | {  # growth rates RATE and -1 along axes that turn by half a turn a period
        "u": f"(({RATE}) - 1)/2*u + (({RATE}) + 1)/2*(a*u + b*v) - v/2 - u*(u^2 + v^2)",
        "v": f"(({RATE}) - 1)/2*v + (({RATE}) + 1)/2*(b*u - a*v) + u/2 - v*(u^2 + v^2)",
    },
    "LPC": {"a": f"-b + a*({FOLDING})", "b": f"a + b*({FOLDING})"},
}  # fmt: skip


def family(type_: str, e: float, method: str) -> Any:
    """Along p, through all three, from where steps are long."""
    square, p = (0.4, 0.6**4 / 4 - e * e * 0.6**2 / 2) if type_ == "LPC" else (1.0, -0.53)
    angle = np.linspace(0.0, 2.0 * np.pi, 101)
    points = np.zeros((101, len(EQUATIONS[type_])))
    points[:, 0], points[:, 1] = np.sqrt(square) * np.cos(angle), np.sqrt(square) * np.sin(angle)
    states = dict(zip(EQUATIONS[type_], points[0], strict=True))
    model = Model("three", states=states, parameters={"p": p, "e": e}, equations=EQUATIONS[type_])
    orbit = contin.periodic_orbit(model, points, period=2.0 * np.pi)
    bounds = (-0.1, 0.05) if type_ == "LPC" else (-1.0, 1.0)
    return contin.continuation(orbit, "p", bounds, settings=Settings(method=method))


def places(type_: str, e: float) -> list[float]:
    return sorted([-(e**4) / 4, 0.0, -(e**4) / 4] if type_ == "LPC" else [-e, 0.0, e])


SHORT = [
    ("BPC", 1e-3, "collocation"), ("BPC", 1e-4, "collocation"),
    ("NS", 1e-3, "collocation"),
    ("PD", 1e-4, "collocation"), ("LPC", 1e-2, "collocation"),
    ("NS", 1e-4, "shooting"),
]  # fmt: skip
LONG = [
    pytest.param(t, e, m, marks=pytest.mark.long)
    for t in EQUATIONS for e in (0.1, 1e-2, 1e-3, 1e-4) for m in ("collocation", "shooting") if (t, e, m) not in SHORT
]  # fmt: skip


@pytest.mark.parametrize(("type_", "e", "method"), [*SHORT, *LONG])
@pytest.mark.seldom
def test_all_crossings_of_one_step_are_labelled_or_a_note_says_that_they_were_not_told_apart(type_, e, method):
    branch = family(type_, e, method)
    found = [point for point in branch.points if point.type == type_]
    for point in branch.points:
        nearest = min(places(type_, e), key=lambda place: abs(place - point.z[-1]))
        assert abs(point.z[-1] - nearest) <= point.error + 1e-15, (point, nearest)
    if len(found) == 3:
        assert sorted(point.z[-1] for point in found) == pytest.approx(places(type_, e), abs=1e-6)
    else:
        assert e <= 1e-3, "crossings this far apart are told apart"
        assert any("degenerate" in note or "told apart" in note for note in branch.notes)
        if type_ != "LPC":  # three folds differ by e^4/4 in the parameter
            assert any("as at 3 crossings together" in note for note in branch.notes), "notes count them"
        assert branch.unexplained > 0, "the exit code says that crossings may be missing"
    assert len(branch.points) == len(found), "nothing is invented"
    assert branch.unexplained == 0 or branch.notes
