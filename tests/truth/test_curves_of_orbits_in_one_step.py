"""Generalised period doublings close together on a curve of doublings: one in a step does not hide the others.

On the circle a^2 + b^2 = 1 a pair (u, v) that turns by half a turn has the growth rates p and -1: the curve is p = 0.
The coefficient of its cubic term is 20 (q - e) q (q + e), so that it vanishes at three values of q.
"""

import numpy as np
import pytest

import contin
from contin.model.model import Model


@pytest.mark.parametrize("e", [0.01, 1e-3, *(pytest.param(e, marks=pytest.mark.long) for e in (0.1, 1e-4))])
@pytest.mark.seldom
def test_three_generalised_doublings_are_labels_at_their_places_or_a_note(e):
    cubic = f"(20*(q - {e})*q*(q + {e})*(u^2 + v^2) - (u^2 + v^2)^2)"
    model = Model(
        "three", states={"a": 1.0, "b": 0.0, "u": 0.0, "v": 0.0}, parameters={"p": -0.3, "q": -0.53},
        equations={
            "a": "a - b - a*(a^2 + b^2)", "b": "a + b - b*(a^2 + b^2)",
            "u": f"(p - 1)/2*u + (p + 1)/2*(a*u + b*v) - v/2 + {cubic}*u",
            "v": f"(p - 1)/2*v + (p + 1)/2*(b*u - a*v) + u/2 + {cubic}*v",
        },
    )  # fmt: skip
    t = np.linspace(0.0, 2.0 * np.pi, 101)
    points = np.column_stack([np.cos(t), np.sin(t), np.zeros((101, 2))])
    orbit = contin.periodic_orbit(model, points, period=2.0 * np.pi)
    family = contin.continuation(orbit, "p", (-0.3, 0.3), settings={"stop_at": ("PD",)})
    curve = contin.continuation(family["PD1"].locus(), ("p", "q"), {"p": (-1, 1), "q": (-1, 1)})
    assert {point.type for point in curve.points} == {"GPD"}
    for point in curve.points:
        assert min(abs(point.values["q"] - place) for place in (-e, 0.0, e)) <= point.error
    assert len(curve.points) == 3 or (e < 1e-3 and curve.notes)


def test_a_pair_that_meets_at_minus_one_and_stays_complex_is_a_note():
    """u + iv turns by 2 pi w in a period: on the curve of tori p = 0, cos(theta) touches -1 at w = 1/2."""
    model = Model(
        "turns", states={"x": 1.0, "y": 0.0, "u": 0.0, "v": 0.0}, parameters={"p": -0.3, "w": 0.42},
        equations={
            "x": "x*(1 - x^2 - y^2) - y", "y": "y*(1 - x^2 - y^2) + x",
            "u": "p*u - w*v - u*(u^2 + v^2)", "v": "w*u + p*v - v*(u^2 + v^2)",
        },
    )  # fmt: skip
    t = np.linspace(0.0, 2.0 * np.pi, 101)
    points = np.column_stack([np.cos(t), np.sin(t), np.zeros((101, 2))])
    family = contin.continuation(contin.periodic_orbit(model, points, period=2.0 * np.pi), "p", (-0.3, 0.3))
    curve = contin.continuation(family["NS1"].locus(), ("p", "w"), {"p": (-1, 1), "w": (0.4, 0.6)})
    assert not curve.points
    assert len(curve.notes) == 1
    assert "touches zero without crossing it" in curve.notes[0]
    assert "w = 0.5" in curve.notes[0] or "w = 0.49999" in curve.notes[0]
