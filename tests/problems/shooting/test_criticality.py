"""Criticality of period doublings and tori by shooting: closed forms, and agreement with collocation."""

from math import pi

import numpy as np
import pytest

import contin
from contin import api
from contin.problems.shooting.normal_form import period_doubling
from contin.problems.shooting.return_map import ReturnMap
from tests.loci.equilibria.planes import amplitude
from tests.loci.orbits.test_codim_two import SQUARE, orbit_on_circle, twisted
from tests.problems.shooting.oscillators import forced_family, relays_in_phase
from tests.truth.ledger import Expected, Ledger
from tests.truth.planted_orbits import SIMPLE, Hidden
from tests.truth.test_orbits import coefficient_complaint


@pytest.fixture(scope="module")
def doubling():
    """Of the Lur'e system, by both methods."""
    line = api.continuation(api.equilibrium(contin.load("classics/lure"), None, {"alpha": 1.5}), "alpha", (0.4, 2.0))
    found = {}
    for method in ("shooting", "collocation"):
        family = api.continuation(line["HB1"].switch(), "alpha", (0.6, 2.0), settings={"method": method})
        found[method] = family["PD1"]
    return found


def test_coefficient_of_a_period_doubling_is_that_of_collocation(doubling):
    shot, collocated = doubling["shooting"].normal_form, doubling["collocation"].normal_form
    assert shot["criticality"] == collocated["criticality"] == "supercritical"
    errors = shot["errors"]["c"] + collocated["errors"]["c"]
    assert abs(shot["c"] - collocated["c"]) <= errors < 1e-4 * abs(shot["c"])


def test_derivatives_of_the_return_map_are_symmetric(doubling):
    point = doubling["shooting"]
    sizes, (a, b) = point.problem.sizes(point.z, point.scale), np.eye(2)
    one, other = (ReturnMap(point.problem, point.z, sizes).jet() for _ in range(2))  # each keeps what it computed
    np.testing.assert_allclose(one.form(a, b), other.form(b, a), rtol=1e-6)
    mixed = 0.5 * (one.form(a + b, a + b, a) - one.form(a, a, a) - one.form(b, b, a))  # C[a, b, a]
    np.testing.assert_allclose(mixed, other.form(a, a, b), rtol=1e-4, atol=1e-5 * float(np.abs(mixed).max()))


@pytest.mark.parametrize("real", [-0.3, 0.2])
def test_coefficient_of_a_torus_bifurcation_is_that_of_the_amplitude_equation(real):
    """v' = (p + i/3 + (real + i/20) |v|^2) v beside the unit circle; by both methods."""
    x, y = amplitude("c", "d", f"p + {real}*(c^2 + d^2)", "(1/3 + 0.05*(c^2 + d^2))")
    found = {}
    for method in ("shooting", "collocation"):
        orbit = orbit_on_circle({"c": x, "d": y}, {"p": -0.3}, method=method)
        found[method] = api.continuation(orbit, "p", (-0.3, 0.2))["NS1"]
    point = found["shooting"]
    assert point.normal_form["criticality"] == ("supercritical" if real < 0 else "subcritical")
    shot, collocated = point.normal_form, found["collocation"].normal_form
    errors = shot["errors"]["d"] + collocated["errors"]["d"]
    assert np.linalg.norm(np.subtract(shot["d"], collocated["d"])) <= errors < 1e-4 * abs(real)


def test_a_return_map_that_is_only_piecewise_smooth_has_no_coefficient():
    assert dict(relays_in_phase("e", -0.15, 0.1)["NS1"].normal_form) == {}


def test_period_doubling_of_a_forced_flow_with_crossings_has_the_sense_of_its_doubled_orbits():
    family = forced_family()
    point = family["PD1"]
    doubled = api.continuation(point.switch("w"), "w", (2.1, 2.5), settings={"steps": 6})
    unstable_above = family.columns["unstable"][np.argmax(family.columns["w"])] > 0
    above = doubled.columns["w"][3] > point.values["w"]
    supercritical = bool(above == unstable_above)
    assert point.normal_form["criticality"] == ("supercritical" if supercritical else "subcritical")
    assert bool(doubled.columns["stable"][3]) == supercritical
    assert doubled.columns["period"][3] == pytest.approx(4 * pi / doubled.columns["w"][3])


@pytest.mark.parametrize("q", [-0.3, 0.1])
def test_coefficient_beside_a_second_multiplier_near_minus_one(q):
    """s' = z, z' = q z - s^3 in a turning plane: z = s^3/q + ... on the centre manifold, so that c = 1/q."""
    equations = twisted("0", f"{q}", along_by_z="1", across_by_s=f"p - {SQUARE}")
    orbit = orbit_on_circle(equations, {"p": 0.0}, method="shooting")
    problem, z = orbit.problem("p"), orbit.seed("p").z
    found = period_doubling(ReturnMap(problem, z, np.ones(4)))
    assert found.value == pytest.approx(1.0 / q, rel=1e-5)


def test_torus_whose_phase_runs_faster_off_the_orbit():
    """theta' = 1 + 0.7 |v|^2 beside the unit circle, also at first order: by both methods the same d, real and
    imaginary."""
    rate = "(1 + 0.7*(c^2 + d^2) + 0.3*c)"
    x, y = amplitude("c", "d", "p - 0.3*(c^2 + d^2) + 0.2*c*a", "(1/3 + 0.2*(c^2 + d^2))")
    circle = {
        "a": f"(1 - a^2 - b^2)*a - {rate}*b + 0.2*d^2", "b": f"(1 - a^2 - b^2)*b + {rate}*a",
    }  # fmt: skip
    found = {}
    for method in ("shooting", "collocation"):
        orbit = orbit_on_circle({**circle, "c": x, "d": y}, {"p": -0.3}, method=method)
        found[method] = api.continuation(orbit, "p", (-0.3, 0.2))["NS1"].normal_form
    errors = sum(form["errors"]["d"] for form in found.values())
    assert abs(found["collocation"]["d"][1]) > 0.1
    assert np.linalg.norm(np.subtract(found["shooting"]["d"], found["collocation"]["d"])) <= errors < 1e-5


@pytest.mark.parametrize("core", SIMPLE, ids=lambda core: core.name)
@pytest.mark.seldom
def test_coefficients_by_shooting_hold_to_their_errors(core):
    """In coordinates that are rotated and bent, and in other units."""
    hidden = Hidden(core, 4, "bent", 3, rate=1.3, length=0.7)
    rate = 1.3 * (core.radius**2 if core.name == "LPC, period changing" else 1.0)
    samples = hidden.points(np.linspace(0, 2 * pi, 101))
    orbit = contin.periodic_orbit(hidden.model, samples, period=2 * pi / rate, method="shooting")
    ledger = Ledger()
    family = contin.continuation(orbit, "p", core.range)
    expected = [Expected(core.type, core.at, coefficient_complaint(hidden))]
    ledger.judge(core.name, str(hidden), family, expected, "p", 0.7)
    ledger.assert_clean()
    assert not [note for note in family.notes if "normal form" in note]
