"""Families whose orbits all exist at one value of the parameter: linear and nonlinear centres."""

import numpy as np
import pytest

from contin import api
from contin.errors import NoSolutionError
from contin.model.model import Model


@pytest.mark.seldom
def test_centre_of_the_van_der_pol_equation_is_crossed_by_its_limit_cycle_of_amplitude_two():
    """x'' - mu (1 - x^2) x' + x = 0 at mu = 0: circles of every radius; those with r = 2 persist (averaging)."""
    model = Model(
        "van-der-pol", states={"x": 0, "y": 0}, parameters={"mu": -0.5}, equations={"x": "y", "y": "mu*(1 - x^2)*y - x"}
    )
    line = api.continuation(api.equilibrium(model), "mu", (-0.5, 5.0))
    assert line["HB1"].normal_form["criticality"] == "degenerate"
    circles = api.continuation(line["HB1"].switch(), "mu", (-0.5, 5.0))
    np.testing.assert_allclose(circles.columns["mu"], 0.0, atol=1e-9)
    np.testing.assert_allclose(circles.columns["period"], 2.0 * np.pi, rtol=1e-6)
    assert [p.type for p in circles.points] == ["BPC"]
    crossing = circles["BPC1"]
    assert crossing.values["x.max"] == pytest.approx(2.0, rel=1e-6)
    assert circles.ends[1].reason == "bound"
    assert "all exist at mu = 0" in circles.ends[1].text
    cycles = api.continuation(crossing.switch(), "mu", (-0.5, 5.0), values={"mu": [1.0]})
    # period of the van der Pol equation at mu = 1: Andersen and Geer, SIAM J. Appl. Math. 42 (1982) 678
    assert cycles["UZ1"].values["period"] == pytest.approx(6.66328685932, rel=1e-9)


def test_may_leonard_orbits_fill_the_plane_between_the_hopf_point_and_the_heteroclinic_cycle():
    """At a + b = 2 the sum of the populations tends to 1 and x y z is kept (May and Leonard, 1975): no other orbits."""
    a = 0.8
    model = Model(
        "may-leonard", states={"x": 0.3, "y": 0.3, "z": 0.3}, parameters={"b": 1.1},
        equations={
            "x": f"x*(1 - x - {a}*y - b*z)", "y": f"y*(1 - b*x - y - {a}*z)", "z": f"z*(1 - {a}*x - b*y - z)",
        },
    )  # fmt: skip
    line = api.continuation(api.equilibrium(model), "b", (1.0, 1.6))
    assert line["HB1"].values["b"] == pytest.approx(2.0 - a, abs=1e-12)
    family = api.continuation(line["HB1"].switch(), "b", (1.0, 1.6))
    np.testing.assert_allclose(family.columns["b"], 2.0 - a, atol=1e-9)
    profile = family.problem.profile(family.z[len(family) // 2])
    np.testing.assert_allclose(profile.u.sum(axis=1), 1.0, atol=1e-6)
    product = profile.u.prod(axis=1)
    np.testing.assert_allclose(product, product[0], rtol=1e-4)
    assert [p.type for p in family.points] == ["HOM"]
    end = family.ends[1]
    assert end.reason == "heteroclinic"
    assert end.data["at"]["b"] == pytest.approx(2.0 - a, abs=1e-9)
    corners = sorted(tuple(round(v, 6) for v in s["state"].values()) for s in end.data["saddles"])
    assert corners == [(0, 0, 1), (0, 1, 0), (1, 0, 0)]
    for saddle in end.data["saddles"]:  # at (1, 0, 0): -1, 1 - b, 1 - a
        np.testing.assert_allclose(np.sort(np.real(saddle["eigenvalues"])), [-1.0, a - 1.0, 1.0 - a], atol=1e-6)
        assert saddle["saddle_quantity"] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("a", [0.7, 0.8, 0.9])
def test_the_multiplier_along_a_family_with_a_first_integral_is_not_counted(a):
    """Multipliers are 1, 1 and exp(-T) (the sum of the populations tends to 1 at rate 1): none is ever unstable."""
    model = Model(
        "may-leonard", states={"x": 0.3, "y": 0.3, "z": 0.3}, parameters={"b": 1.0},
        equations={
            "x": f"x*(1 - x - {a}*y - b*z)", "y": f"y*(1 - b*x - y - {a}*z)", "z": f"z*(1 - {a}*x - b*y - z)",
        },
    )  # fmt: skip
    line = api.continuation(api.equilibrium(model), "b", (0.9, 1.6))
    family = api.continuation(line["HB1"].switch(), "b", (0.9, 1.6))
    assert not family.columns["unstable"].any()
    assert family.unexplained == 0
    assert not any("without a label" in note for note in family.notes)


def test_a_simulation_of_a_conservative_system_says_that_its_orbits_are_a_continuum():
    """Lotka and Volterra: x - log x + y - log y is conserved."""
    model = Model(
        "prey", states={"x": 1.5, "y": 1.0}, parameters={"a": 1.0}, equations={"x": "a*x - x*y", "y": "x*y - y"}
    )
    with pytest.raises(NoSolutionError, match=r"closes, with period 6\.38.*continuum.*dissipative"):
        api.periodic_orbit(model)
