"""Curves of doublings and tori whose orbits change one way with one parameter and the opposite way with the other.

The borders' directions of the parameters turn from those of a family to the curve's own where it sets out; in the new
ones the determinant of the curve's equations may have the other sign: that is no other curve that crosses.
"""

import numpy as np
import pytest

import contin
from contin.model.model import Model
from tests.loci.orbits.test_codim_two import SQUARE, curve, twisted


@pytest.mark.parametrize("label", ["PD", "NS"])
def test_orbits_that_change_back_along_the_curve(label):
    """A state e = 6 (p - q) beside a doubling (torus) at p = q/2: it grows with p and falls along the curve."""
    growth = f"p - q/2 - {SQUARE}"
    twist = twisted(growth, "-1") if label == "PD" else {
        "c": "(p - q/2 - c^2 - d^2)*c - 0.3*d", "d": "(p - q/2 - c^2 - d^2)*d + 0.3*c",
    }  # fmt: skip
    equations = {**twist, "e": "6*(p - q) - e"}
    found = curve(equations, ("p", "q"), {"p": (-0.3, 0.4), "q": (-0.5, 0.7)}, label, "collocation")
    np.testing.assert_allclose(found.columns["p"], found.columns["q"] / 2, atol=1e-8)
    assert found.points == ()
    assert found.notes == ()


def test_doublings_of_rossler_s_equations():
    """A crossing was told at c = 5.779, at other places with other steps."""
    model = Model(
        "rossler", states={"x": 0, "y": 0, "z": 0}, parameters={"a": 0.0, "b": 0.2, "c": 5.7},
        equations={"x": "-y - z", "y": "x + a*y", "z": "b + z*(x - c)"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "a", (-0.2, 0.55))
    cycles = contin.continuation(line["HB1"].switch(), "a", (-0.2, 0.55), settings={"stop_at": ("PD",)})
    doublings = contin.continuation(cycles["PD1"].locus(), ("a", "c"), {"a": (-0.2, 0.55), "c": (1.5, 12)})
    assert doublings.notes == ()
    assert [end.reason for end in doublings.ends] == ["bound", "bound"]
