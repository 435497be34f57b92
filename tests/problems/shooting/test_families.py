"""Families by shooting: the metronomes' in-phase orbits, and agreement with collocation on smooth flows."""

from math import exp, pi

import numpy as np
import pytest

import contin
from contin import api
from contin.errors import NoSolutionError
from contin.problems.shooting.sampling import states

# in-phase orbit of the pair: (beta, eps) -> mu_c, computed independently (extended precision, both orders of crossing)
IN_PHASE = {
    (0.3, 0.001): 10.50272674, (0.3, 0.005): 10.24036985, (0.3, 0.01): 9.94802926, (0.3, 0.02): 9.45499633,
    (0.3, 0.05): 8.42583992, (0.8, 0.002): 4.67524551, (0.8, 0.005): 4.56191211, (0.8, 0.01): 4.39259243,
    (0.8, 0.02): 4.11199282,
}  # fmt: skip
PERIODS = {(0.3, 0.01): 5.70907683, (0.8, 0.01): 6.05186519, (0.3, 0.05): 4.55725141}


def pair_branch(beta, eps, **options):
    mu = IN_PHASE[beta, eps]
    orbit = api.periodic_orbit(contin.load("metronomes/pair"), "in-phase", {"beta": beta, "eps": eps, "mu": mu + 1.0})
    return api.continuation(orbit, "mu", (mu - 1.0, mu + 1.5), **options)


@pytest.mark.parametrize(("beta", "eps"), list(IN_PHASE))
def test_in_phase_orbits_lose_stability_where_known(beta, eps):
    branch = pair_branch(beta, eps)
    assert [p.type for p in branch.points] == ["BPC"]
    point = branch["BPC1"]
    # where the orbits' rounding is seen first depends on the processor (1e-9 to 1e-7 of mu), and the error says where
    assert point.values["mu"] == pytest.approx(IN_PHASE[beta, eps], abs=point.error + 5e-9)  # digits of the reference
    assert point.error < 1e-6
    assert point.normal_form["kind"] == "nonsmooth"
    if (beta, eps) in PERIODS:
        assert point.values["period"] == pytest.approx(PERIODS[beta, eps], abs=point.error + 5e-9)
    stable = branch.columns["stable"]
    above = branch.columns["mu"] > point.values["mu"]
    assert np.all(stable[above])
    assert not np.any(stable[: point.index])


@pytest.fixture(scope="module")
def pitchfork():
    return pair_branch(0.8, 0.01)


def test_the_family_that_crosses_breaks_the_exchange_symmetry(pitchfork):
    seed = pitchfork["BPC1"].switch("mu")
    other = api.continuation(seed, "mu", (3.9, 5.5), settings={"steps": 12})
    assert other.parent.label == "BPC1"
    gap = np.abs(other.columns["x1.max"] - other.columns["x2.max"])
    assert gap[0] < 1e-6 < 1e-3 < gap[-1]
    side = np.sign(other.columns["mu"][3] - other.columns["mu"][0])
    assert pitchfork["BPC1"].normal_form["side"] == ("above" if side > 0 else "below")


def test_an_orbit_of_the_crossing_family_returns_exactly(pitchfork):
    other = api.continuation(pitchfork["BPC1"].switch("mu"), "mu", (3.9, 5.5), settings={"steps": 8})
    problem, z = other.problem, other.z[-1]
    u = problem.profile(z).u
    np.testing.assert_allclose(u[-1], u[0], atol=1e-8)


@pytest.fixture(scope="module")
def lure():
    line = api.continuation(api.equilibrium(contin.load("classics/lure"), None, {"alpha": 1.5}), "alpha", (0.4, 2.0))
    return line["HB1"]


@pytest.mark.parametrize("segments", [None, 4])
def test_lure_doubles_its_period_where_known(lure, segments):
    settings = {"method": "shooting"} | ({} if segments is None else {"intervals": segments})
    family = api.continuation(lure.switch(), "alpha", (0.55, 2.0), settings=settings)
    assert [p.label for p in family.points] == ["PD1"]
    assert family["PD1"].values["alpha"] == pytest.approx(0.63030200616, abs=1e-10)
    assert family["PD1"].values["period"] == pytest.approx(6.36407133944, abs=1e-9)
    doubled = api.continuation(family["PD1"].switch("alpha"), "alpha", (0.577, 2.0))
    assert doubled["PD1"].values["alpha"] == pytest.approx(0.5796298409, abs=1e-9)
    assert doubled.columns["period"][0] == pytest.approx(2.0 * family["PD1"].values["period"])


@pytest.mark.parametrize(("name", "parameter", "value"), [("stuart-landau", "mu", 0.6), ("van-der-pol", "alpha", 3.0)])
def test_shooting_and_collocation_agree(name, parameter, value):
    model = contin.load(f"classics/{name}")
    line = api.continuation(api.equilibrium(model), parameter)
    points = []
    for method in ("shooting", "collocation"):
        family = api.continuation(
            line["HB1"].switch(), parameter, settings={"method": method}, values={parameter: [value]}
        )
        points.append(family["UZ1"])
    assert points[0].values["period"] == pytest.approx(points[1].values["period"], abs=1e-9)


def test_multiplier_of_stuart_landau_is_exact():
    model = contin.load("classics/stuart-landau")
    orbit = api.periodic_orbit(model, {"x": 0.9, "y": 0.0}, {"mu": 0.5}, method="shooting")
    problem = orbit.problem("mu")
    values = problem.multipliers(orbit.seed("mu").z)
    assert values[1].real == pytest.approx(exp(-2.0 * 0.5 * orbit.period), rel=1e-8)


def test_a_family_followed_back_to_its_hopf_point_ends_there():
    model = contin.load("classics/stuart-landau")
    orbit = api.periodic_orbit(model, {"x": 0.9, "y": 0.0}, {"mu": 0.5}, method="shooting")
    family = api.continuation(orbit, "mu", (-1.0, 1.0), direction="down")
    reasons = {end.reason for end in family.ends}
    assert "hopf" in reasons
    end = next(e for e in family.ends if e.reason == "hopf")
    assert end.data["at"]["mu"] == pytest.approx(0.0, abs=1e-9)


def test_a_trajectory_that_comes_to_rest_is_no_orbit():
    with pytest.raises(NoSolutionError, match="rest"):
        api.periodic_orbit(contin.load("metronomes/one"), {"x": 0.3, "y": 0.0}, {"alpha": 1.1, "eps": 0.2})


def averaged_fold(a: float, b: float) -> float:
    return 3.0 * a * a / (16.0 * pi * b)


# averaged folds of alpha: 3 a^2/(16 pi b), R/(pi (1 + R^2)), 2 (x2 - x1)/(pi x2^2), and none (rest bifurcates at 1/pi)
FOLDS = {"one": averaged_fold(4.0, 1.0), "one-rational": 0.12807872173209018, "one-constant": 2.0 * 0.5 / (pi * 2.25)}


def fold_of(name: str, eps: float) -> float:
    model = contin.load(f"metronomes/{name}")
    orbit = api.periodic_orbit(model, "oscillating", {"eps": eps})
    branch = api.continuation(orbit, "alpha", settings={"steps": 80}, direction="up")
    return float(branch["LPC1"].values["alpha"])


@pytest.mark.parametrize("name", list(FOLDS))
@pytest.mark.seldom
def test_one_metronome_folds_at_its_averaged_value_up_to_first_order(name):
    errors = [fold_of(name, eps) - FOLDS[name] for eps in (0.02, 0.01)]
    assert abs(errors[0]) < 0.02
    assert 1.7 < errors[0] / errors[1] < 2.5


@pytest.mark.parametrize("eps", [0.04, pytest.param(0.01, marks=pytest.mark.long)])
@pytest.mark.seldom
def test_a_fold_at_a_corner_is_found_whatever_the_step(eps):
    # the escapement of constant force ends at x2: the family turns where its orbit just reaches that far
    found = []
    for high in (0.2, 0.3, 1.3):  # of the range, and with it of the steps
        orbit = api.periodic_orbit(contin.load("metronomes/one-constant"), "oscillating", {"eps": eps, "alpha": 0.1})
        branch = api.continuation(orbit, "alpha", (0.02, high))
        assert [point.type for point in branch.points] == ["LPC"]
        assert branch["LPC1"].normal_form["kind"] == "nonsmooth"
        assert not branch.notes
        assert branch["LPC1"].values["x.max"] == pytest.approx(1.5, abs=1e-6)
        assert [end.text for end in branch.ends] == ["alpha reached 0.02"] * 2
        found.append(branch["LPC1"].values["alpha"])
    assert np.ptp(found) < 1e-9
    assert found[0] == pytest.approx(FOLDS["one-constant"], abs=0.025 * eps)


def test_states_of_a_segment_do_not_stand_in_for_those_of_one_that_escapes():
    """r' = r (r^2 - 1), angle' = 1 from the unit circle in four segments, the second one from far outside."""
    model = contin.Model(
        "unstable", states={"x": 1.0, "y": 0.0}, parameters={"b": 1.0},
        equations={"x": "-b*x - y + x*(x^2 + y^2)", "y": "x - b*y + y*(x^2 + y^2)"},
    )  # fmt: skip
    t = np.linspace(0.0, 2.0 * pi, 41)
    circle = np.column_stack([np.cos(t), np.sin(t)])
    seed = contin.periodic_orbit(model, circle, times=t, method="shooting", intervals=4).seed("b")
    z = seed.z.copy()
    z[2:4] = [0.0, 30.0]
    times = np.array([0.9, 0.1, 0.3, 0.45, 0.6])
    u = states(seed.problem, z, times)
    assert np.all(np.isnan(u[2:4]))
    kept = [0, 1, 4]
    turned = 2.0 * pi * (times[kept] - times[1]) + np.arctan2(u[1, 1], u[1, 0])  # from whatever phase
    np.testing.assert_allclose(u[kept], np.column_stack([np.cos(turned), np.sin(turned)]), atol=1e-8)
