"""Coefficients of orbits whose variations have kinks where they cross surfaces."""

from __future__ import annotations

import pytest

import contin


def doublings(phase: float) -> list[contin.SpecialPoint]:
    """Period doublings of x'' + x'/10 + x + 8 max(x, 0) = cos(w t + phase)."""
    model = contin.Model(
        "one-sided", states={"x": 0, "v": 0}, parameters={"w": 1.6}, forcing={"period": "2*pi/w"},
        equations={"x": "v", "v": f"-0.1*v - x - 8*max(x, 0) + cos(w*t + {phase})"},
    )  # fmt: skip
    return list(contin.continuation(contin.periodic_orbit(model), "w", (1.5, 5.0)).points)


@pytest.mark.seldom
def test_coefficients_do_not_depend_on_where_the_period_begins():
    """The last one is by closed forms of the pieces in 40 digits: c' = 1217.29384063 of the map, mean square
    0.871477082336 of the eigenfunction, where the orbit is a sixth as large as where its family began."""
    here, there = doublings(0.0), doublings(1.0)
    assert [point.type for point in here] == [point.type for point in there] == ["PD", "PD"]
    for one, other in zip(here, there, strict=True):
        c, d = one.normal_form, other.normal_form
        assert abs(c["c"] - d["c"]) <= c["errors"]["c"] + d["errors"]["c"]
        assert c["errors"]["c"] < 1e-5 * abs(c["c"])
    assert here[1].values["w"] == pytest.approx(4.714186743866023, abs=1e-11)
    assert abs(here[1].normal_form["c"] + 1048.01227098) <= here[1].normal_form["errors"]["c"]
