"""A forced oscillator that touches a surface beyond which a further force pushes it on: the family ends there."""

import math

import pytest

import contin

W, D, S = 1.6, 0.1, 0.5
TOUCH = S * math.hypot(1.0 - W**2, D * W)  # F of the linear orbit whose largest x is S


def pushed(force: float) -> contin.Model:
    return contin.Model(
        "pushed", states={"x": 0.0, "y": 0.0}, parameters={"F": 0.4, "w": W}, forcing={"period": "2*pi/w"},
        equations={"x": "y", "y": f"-{D}*y - x + ({force} if x > {S} else 0) + F*cos(w*t)"},
    )  # fmt: skip


def test_the_family_below_the_surface_ends_where_it_touches_it():
    """x'' = -S w^2 there below, and 3 - S w^2 > 0 beyond: what crosses goes far. It ended `corrector`."""
    branch = contin.continuation(contin.periodic_orbit(pushed(3.0)), "F", (0.1, TOUCH + 0.1))
    end = branch.ends[-1]
    assert end.reason == "grazing"
    assert end.data["surface"] == f"x - {S} = 0"
    assert end.data["at"]["F"] == pytest.approx(TOUCH, rel=1e-5)
    assert not branch.notes


def test_a_family_that_goes_on_beyond_has_no_such_end():
    """0.5 - S w^2 < 0 beyond the surface, too."""
    branch = contin.continuation(contin.periodic_orbit(pushed(0.5)), "F", (0.1, TOUCH + 0.1))
    assert [end.reason for end in branch.ends] == ["bound", "bound"]
