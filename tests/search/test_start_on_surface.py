"""Starts on a surface at which the equations jump: pseudo-equilibria, equilibria that meet the surface, and crossings.

x' = a - x - d (0 below x = 0, 1 above): equilibria x = a < 0 and x = a - d > 0; motion slides on x = 0 for 0 < a < d
(d > 0), and leaves it for d < a < 0 (d < 0), where both sides have an equilibrium.
"""

from __future__ import annotations

import pytest

import contin
from contin.errors import NoSolutionError

CHOICE = {"if": "(1 if x > 0 else 0)", "if, closed": "(1 if x >= 0 else 0)", "heaviside": "heaviside(x)"}
FORMS = [*CHOICE.values(), "(1 + sign(x))/2"]


def follow(d: float, a: float, form: str, unit: float = 1.0) -> contin.Branch:
    """States in `unit`, time as it is."""
    model = contin.Model(
        "relay",
        states={"x": {"value": 0.0, "scale": unit}, "y": {"value": 0.0, "scale": unit}},
        parameters={"a": a},
        equations={"x": f"{unit}*a - x - {unit * d}*{form} + y/2", "y": "-y + x/2"},
    )
    return contin.continuation(contin.equilibrium(model), "a", (a - 5.0, a + 5.0))


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("part", [0.01, 1 / 15, 0.3, 0.5, 0.9])
def test_a_start_on_the_surface_is_the_pseudo_equilibrium_where_motion_slides(form, part):
    """Filippov's weight is a/d all along, and both ends are the equilibria that meet the surface."""
    branch = follow(3.0, 3.0 * part, form)
    assert branch.columns["weight"] == pytest.approx(branch.columns["a"] / 3.0, abs=1e-14)
    assert [p.z[-1] for p in branch.points] == pytest.approx([0.0, 3.0], abs=1e-13)
    assert [end.reason for end in branch.ends] == ["surface", "surface"]


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("unit", [1e-9, 1.0, 1e6])
@pytest.mark.parametrize(("d", "kind"), [(3.0, "persistence"), (-3.0, "nonsmooth fold")])
@pytest.mark.parametrize("upper", [False, True])
def test_a_start_where_an_equilibrium_meets_the_surface_is_a_boundary_equilibrium(form, unit, d, kind, upper):
    """The equilibria of its side are followed, away from the surface, whichever side has the value at x = 0."""
    at = d if upper else 0.0
    branch = follow(d, at, form, unit)
    assert sorted(end.reason for end in branch.ends) == ["bound", "surface"]
    (point,) = branch.points
    assert abs(point.z[-1] - at) <= max(point.error, 1e-15)
    assert point.normal_form["kind"] == kind
    sign = 1.0 if upper else -1.0
    a, x = branch.columns["a"], branch.columns["x"] / unit
    assert 0.75 * x == pytest.approx(a - at, abs=1e-9)
    assert (sign * x >= -1e-12).all()
    assert sign * x.sum() > 1.0


def test_a_start_on_a_surface_that_motion_crosses_names_the_surface():
    model = contin.Model(
        "crossed", states={"x": 0.0}, parameters={"a": 0.0}, equations={"x": "3 + a + (1 if x > 0 else -1)"}
    )
    with pytest.raises(NoSolutionError, match="lies on the surface x = 0"):
        contin.equilibrium(model)
