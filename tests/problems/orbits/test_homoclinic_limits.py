"""Homoclinic orbits at the end of families, where they are known in closed form, on meshes fine and coarse.

Sandstede's system (J. Dynam. Differential Equations 9 (1997) 269) in its plane: for p = 0 the loop x^2 (1 - x) = y^2 is
a homoclinic orbit of the origin, whose eigenvalues are a - b and a + b; the parameter breaks it at first order.
"""

import pytest

import contin
from contin.model.model import Model


def family(a, b, settings):
    """Orbits from the Hopf point inside the loop to the loop."""
    model = Model(
        "loop", states={"x": 0.66, "y": 0.0}, parameters={"p": 0.0, "a": a, "b": b},
        equations={
            "x": "a*x + b*y - a*x^2 + p*x*(2 - 3*x)",
            "y": "b*x + a*y - 3*b*x^2/2 - 3*a*x*y/2 - 2*p*y",
        },
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "p", (-1.0, 1.0))
    return contin.continuation(line["HB1"].switch(), "p", (-1.0, 1.0), settings=settings)


@pytest.mark.parametrize(("a", "b"), [(-1.0, 2.0), (-1.5, 2.0), (-0.2, 1.0), (0.7, 2.0)])
def test_the_error_of_a_homoclinic_orbit_covers_what_the_mesh_does_to_it(a, b):
    """It was up to 24 times too small on a mesh of 30 intervals, whose own error it left out."""
    errors = {}
    for intervals in (20, 30, 60, 100, 200, None):
        orbits = family(a, b, {} if intervals is None else {"intervals": intervals})
        assert orbits.ends[1].reason == "homoclinic"
        end = orbits.ends[1].data
        assert abs(end["at"]["p"]) <= end["error"]
        assert orbits["HOM1"].error == end["error"]
        errors[intervals] = end["error"]
    assert errors[20] < 1e-6
    assert errors[200] < 0.1 * errors[20]


@pytest.mark.parametrize("max_step", [0.03, 0.04, 0.06, 0.09, 0.13, 0.2, 0.3])
def test_the_limit_does_not_depend_on_the_steps_that_lead_to_it(max_step):
    orbits = family(-1.0, 2.0, {"intervals": 60, "max_step": max_step})
    assert orbits.ends[1].reason == "homoclinic"
    assert abs(orbits["HOM1"].values["p"]) <= orbits["HOM1"].error


LONG = pytest.mark.long


@pytest.mark.parametrize("intervals", [20, 60, pytest.param(30, marks=LONG), pytest.param(200, marks=LONG)])
@pytest.mark.seldom
def test_the_curve_of_homoclinic_orbits_starts_where_their_parameter_is_zero(intervals):
    """p = 0 for every a, and the saddle is neutral at a = 0. What is left of p at the start is no size of it."""
    start = family(-1.0, 2.0, {"intervals": intervals})["HOM1"]
    curve = contin.continuation(start.locus(("p", "a")), ("p", "a"), {"p": (-1.0, 1.0), "a": (-1.5, 0.9)})
    assert [end.reason for end in curve.ends] == ["bound", "bound"]
    assert abs(curve.columns["p"]).max() <= start.error + 1e-8
    (neutral,) = curve.points
    assert neutral.type == "NSS"
    assert max(abs(neutral.values["p"]), abs(neutral.values["a"])) <= neutral.error
