"""Coefficients at poles that rounding hides: a matrix to be solved with is singular, and its entries are rounding."""

import numpy as np
import pytest

import contin
from contin.continuation.outcome import Verified
from contin.problems.equilibria.normal_forms import with_normal_form

BOGDANOV = {"x": "x + y + k*x*(x - 1) + mu*x*y", "y": "y + k*x*(x - 1) + mu*x*y"}


@pytest.mark.seldom
def test_a_doubling_on_a_line_of_fixed_points_has_no_sense():
    """Bogdanov's map at k = 0, e = 0: y = 0 is a line of fixed points, 1 - A is singular all along (c was 7.8e13)."""
    model = contin.load({
        "contin": 1, "name": "bogdanov", "kind": "map", "states": {"x": 1.0, "y": 0.0},
        "parameters": {"k": {"value": 1.2, "range": [-2, 5]}, "mu": 0.1}, "equations": BOGDANOV,
    })  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "k", (-1.0, 1.2))
    across = contin.continuation(line["BP1"].switch(), "k", settings={"stop_at": ["PD"]})
    assert across["PD1"].values["x"] == pytest.approx(-20.0)
    assert across["PD1"].normal_form.get("criticality", "degenerate") == "degenerate"


SHEARED = "(w - x)"  # z
TURNING = f"p*x - y + x*{SHEARED} - x^3"
FLIPPING = f"-(1 + p)*x + x*{SHEARED} + x^3"
BESIDE = {
    "HB": {"x": TURNING, "y": "x + p*y", "w": f"{TURNING} + {SHEARED}^2 + x^2"},
    "PD": {"x": FLIPPING, "w": f"{FLIPPING} + {SHEARED} + {SHEARED}^2 + x^2"},
}
CRITICAL = {"HB": [1j, -1j, 0.0], "PD": [-1.0, 1.0]}


@pytest.mark.parametrize("off", [0.0, 1e-17, -3e-16])
@pytest.mark.parametrize("type_", ["PD", "HB"])
def test_an_entry_that_vanishes_with_a_state_is_none(type_, off):
    """z' = z^2 + x^2 (map: z -> z + z^2 + x^2) beside a pair (a multiplier -1): the coefficient has a pole at z = 0."""
    equations = BESIDE[type_]
    model = contin.load({
        "contin": 1, "name": "no-entry", "kind": "map" if type_ == "PD" else "flow",
        "states": dict.fromkeys(equations, 0.0), "parameters": {"p": {"value": 0.0, "range": [-1, 1]}},
        "equations": equations,
    })  # fmt: skip
    problem = contin.equilibrium(model).problem("p")
    z = np.array([*(0.0 for _ in equations), 0.0])
    z[-2] = off  # w = z where x = 0
    point = Verified(type_, z, 1e-16, 1e-15, np.array(CRITICAL[type_], complex), 0, vectors={"omega": 1.0})
    found = with_normal_form(problem, point, np.ones(len(z)))
    assert found.normal_form.get("criticality", "degenerate") == "degenerate"
    assert found.normal_form or "could not be computed" in found.remark
