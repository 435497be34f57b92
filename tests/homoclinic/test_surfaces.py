"""Homoclinic orbits of a piecewise-smooth flow."""

from __future__ import annotations

import numpy as np
import pytest

import contin
from contin.model.model import Model


@pytest.mark.seldom
def test_homoclinic_orbits_are_followed_up_to_a_switching_surface_and_no_further():
    """x' = y, y' = p + q x + x^2 - x y: orbits from BT on p = -6/25 q^2 + O(q^3); a wall at x = -0.1 pushes back."""
    box = {"p": (-0.3, 0.1), "q": (-0.5, 0.2)}

    def loops(wall):
        model = Model(
            "walled", states={"x": 1.0, "y": 0.0}, parameters={"p": -0.25, "q": -0.5},
            equations={"x": "y", "y": f"p + q*x + x^2 - x*y + {wall}"},
        )  # fmt: skip
        line = contin.continuation(contin.equilibrium(model), "p", (-0.3, 0.1))
        folds = contin.continuation(line["LP1"].locus(("p", "q")), ("p", "q"), box)
        (seed,) = [s for s in folds["BT1"].locus(("p", "q")) if s.problem.locus == "HOM"]
        return contin.continuation(seed, ("p", "q"), box, settings={"steps": 60})

    walled, free = loops("(5*(-0.1 - x) if x < -0.1 else 0)"), loops("0")
    assert walled.columns["x.min"].min() > -0.1 - 1e-4  # nodes do not cross; a parabola through them may
    assert walled.columns["x.min"].min() < -0.09
    q = walled.columns["q"]
    rows = np.argsort(free.columns["q"])
    expected = np.interp(q, free.columns["q"][rows], free.columns["p"][rows])
    np.testing.assert_allclose(walled.columns["p"], expected, atol=1e-4)
    (end,) = [end for end in walled.ends if end.reason == "corrector"]
    assert "cross the switching surface" in end.text
    assert free.columns["x.min"].min() < -0.2
