"""Families of periodic orbits against closed forms and independently computed values."""

from math import exp, pi, sqrt

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from contin import api
from contin.errors import NoSolutionError
from contin.model.model import Model


def rotating(growth: str, omega: str = "1", **parameters: float) -> Model:
    """(x, y)' of w' = (growth(s) + i omega) w, s = |w|^2."""
    return Model(
        "rotating", states={"x": 0, "y": 0}, parameters=parameters, definitions={"s": "x^2 + y^2"},
        equations={"x": f"({growth})*x - ({omega})*y", "y": f"({omega})*x + ({growth})*y"},
    )  # fmt: skip


def labels(branch, type_):
    return [p for p in branch.points if p.type == type_]


def cycles(model, parameter, bounds, label="HB1", **options):
    line = api.continuation(api.equilibrium(model), parameter, bounds)
    return api.continuation(line[label].switch(), parameter, bounds, **options)


@pytest.fixture(scope="module")
def stuart():
    return rotating("r - s", "1 + 0.5*s", r=-0.5)


def test_stuart_landau_period_amplitude_and_multiplier_are_exact(stuart):
    family = cycles(stuart, "r", (-0.5, 1.0), values={"r": [0.25, 0.5]})
    uz = labels(family, "UZ")
    assert [p.values["r"] for p in uz] == pytest.approx([0.25, 0.5], abs=1e-13)
    for p in uz:
        r = p.values["r"]
        period = 2 * pi / (1 + 0.5 * r)
        assert p.values["period"] == pytest.approx(period, rel=1e-10)
        assert p.values["x.max"] == pytest.approx(sqrt(r), rel=1e-7)
        assert p.values["y.min"] == pytest.approx(-sqrt(r), rel=1e-7)
        assert p.eigenvalues[0].real == pytest.approx(1.0, abs=1e-9)
        assert p.eigenvalues[1].real == pytest.approx(exp(-2 * r * period), rel=1e-6)
    assert family.ends[0].reason == "start"
    assert family.ends[1].reason == "bound"
    assert np.all(family.columns["stable"])
    assert family.effort["steps"] < 40  # measured 23


def test_period_converges_with_order_two_m_in_the_number_of_intervals(stuart):
    exact = 2 * pi / 1.25
    for m in (2, 3):
        counts = np.array([10, 14, 20, 28])
        errors = []
        for n in counts:
            family = cycles(stuart, "r", (-0.5, 1.0), values={"r": [0.5]}, settings={"intervals": int(n), "points": m})
            errors.append(abs(labels(family, "UZ")[0].values["period"] - exact))
        order = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
        assert order == pytest.approx(2 * m, abs=0.35)


def test_user_values_of_the_period_and_of_an_amplitude_are_hit(stuart):
    family = cycles(stuart, "r", (-0.5, 1.0), values={"period": [5.0], "x.max": [0.6]})
    by_period, by_size = sorted(labels(family, "UZ"), key=lambda p: -p.values["period"])
    if by_period.values["period"] == pytest.approx(5.0, abs=1e-9):
        by_period, by_size = by_size, by_period
    assert by_size.values["r"] == pytest.approx(2 * (2 * pi / 5 - 1), rel=1e-8)
    assert by_period.values["r"] == pytest.approx(0.36, rel=1e-6)


def test_fold_of_cycles_of_the_bautin_normal_form():
    """s = r^2: b + s - s^2 = 0 folds at b = -1/4, s = 1/2; period 2 pi."""
    family = cycles(rotating("b + s - s^2", b=-1.0), "b", (-1.0, 1.0))
    assert [p.type for p in family.points] == ["LPC"]
    fold = family["LPC1"]
    assert fold.values["b"] == pytest.approx(-0.25, abs=1e-10)
    assert fold.values["period"] == pytest.approx(2 * pi, rel=1e-9)
    assert fold.values["x.max"] == pytest.approx(sqrt(0.5), rel=1e-6)
    assert abs(fold.values["b"] + 0.25) <= fold.error + 1e-12
    assert family.columns["unstable"][3] == 1
    assert family.columns["unstable"][-1] == 0


def test_a_family_between_two_hopf_points_ends_at_the_other_one():
    """Growth p (1 - p) - s: cycles of radius sqrt(p (1 - p)) from p = 0 to p = 1."""
    family = cycles(rotating("p*(1 - p) - s", p=-1.0), "p", (-1.0, 2.0))
    assert family.points == ()
    end = family.ends[1]
    assert end.reason == "hopf"
    assert end.data["at"]["p"] == pytest.approx(1.0, abs=1e-10) or end.data["at"]["p"] == pytest.approx(0.0, abs=1e-10)
    assert family.columns["x.max"].max() == pytest.approx(0.5, abs=2e-2)


def test_period_doublings_of_the_lure_system():
    """Values of MatCont's tutorial and of AUTO-07p."""
    model = Model(
        "lure", states={"x": 0, "y": 0, "z": 0}, parameters={"al": 1.5},
        equations={"x": "y", "y": "z", "z": "-al*z - y - x + x^2"},
    )  # fmt: skip
    family = cycles(model, "al", (0.3, 1.5))
    assert [p.type for p in family.points] == ["PD"]
    first = family["PD1"]
    assert first.values["al"] == pytest.approx(0.63030200616, abs=1e-9)
    assert first.values["period"] == pytest.approx(6.36407133944, rel=1e-9)
    doubled = api.continuation(first.switch(), "al", (0.3, 1.5))
    assert doubled["PD1"].values["al"] == pytest.approx(0.5796298409, rel=1e-8)
    assert doubled["PD1"].values["period"] == pytest.approx(12.7343655422, rel=1e-7)
    assert doubled.columns["period"][0] == pytest.approx(2 * first.values["period"], rel=1e-12)


@pytest.fixture(scope="module")
def lorenz():
    return Model(
        "lorenz", states={"x": 0, "y": 0, "z": 0}, parameters={"rho": 0.5, "s": 10, "b": "8/3"},
        equations={"x": "s*(y - x)", "y": "rho*x - y - x*z", "z": "x*y - b*z"},
        symmetries={"flip": {"x": "-x", "y": "-y", "z": "z"}},
    )  # fmt: skip


def test_lorenz_cycles_end_in_the_homoclinic_orbit_without_a_fold(lorenz):
    line = api.continuation(api.equilibrium(lorenz), "rho", (0.5, 30))
    fork = api.continuation(line["BP1"].switch(), "rho", (0.5, 30))
    family = api.continuation(fork["HB1"].switch(), "rho", (0.5, 30))
    end = family.ends[1]
    assert end.reason == "homoclinic"
    assert end.data["at"]["rho"] == pytest.approx(13.926557407, abs=1e-6)
    assert abs(end.data["at"]["rho"] - 13.926557407) < 3 * end.data["error"]
    saddle = np.sort(np.real(end.data["eigenvalues"]))
    rho = end.data["at"]["rho"]
    root = sqrt(121 + 40 * (rho - 1))
    np.testing.assert_allclose(saddle, [(-11 - root) / 2, -8 / 3, (-11 + root) / 2], rtol=1e-6)
    assert end.data["saddle_quantity"] == pytest.approx((-11 + root) / 2 - 8 / 3, rel=1e-6)
    assert [p.type for p in family.points] == ["HOM"]
    assert family.points[0].index == len(family) - 1


def test_symmetric_lorenz_orbit_from_a_simulation_breaks_its_symmetry_at_a_branch_point(lorenz):
    orbit = api.periodic_orbit(lorenz, {"x": 10, "y": 10, "z": 340}, {"rho": 350})
    family = api.continuation(orbit, "rho", (300, 360))
    assert [p.type for p in family.points] == ["BPC"]
    assert family["BPC1"].values["rho"] == pytest.approx(312.9735, abs=1e-3)  # Sparrow (1982): 313
    broken = api.continuation(family["BPC1"].switch(), "rho", (200, 360))
    assert [p.values["rho"] for p in labels(broken, "PD")] == pytest.approx([229.4067086], rel=1e-7)


def test_forced_duffing_response_has_its_two_folds_and_the_forcing_period():
    model = Model(
        "duffing", states={"x": 0.1, "v": 0}, parameters={"om": 1.2, "F": 0.3, "d": 0.1},
        equations={"x": "v", "v": "-d*v - x - x^3 + F*cos(om*t)"}, forcing={"period": "2*pi/om"},
    )  # fmt: skip
    family = api.continuation(api.periodic_orbit(model), "om", (0.5, 3.0))
    np.testing.assert_allclose(family.columns["period"], 2 * pi / family.columns["om"], rtol=1e-8)
    folds = labels(family, "LPC")
    assert len(folds) == 2
    for p in folds:  # Liouville: the product of the multipliers is exp(-d T)
        assert np.prod(p.eigenvalues).real == pytest.approx(exp(-0.1 * p.values["period"]), rel=1e-8)


def test_rotations_of_a_driven_pendulum_gain_one_turn_and_end_homoclinically():
    model = Model(
        "pendulum", states={"th": {"value": 0, "period": "2*pi"}, "v": 2}, parameters={"I": 1.5, "al": 0.3},
        equations={"th": "v", "v": "I - al*v - sin(th)"},
    )  # fmt: skip
    orbit = api.periodic_orbit(model)
    np.testing.assert_allclose(orbit.winding, [2 * pi, 0.0])
    family = api.continuation(orbit, "I", (0.1, 3.0))
    assert {e.reason for e in family.ends} == {"bound", "homoclinic"}
    for row in (0, len(family) // 2, -1):  # energy balance over a turn: I 2 pi = al * integral of v^2 dt
        z = family.z[row]
        profile = family.problem.profile(z)
        work = 0.3 * profile.period * (profile.weights @ profile.u[:, 1] ** 2)
        assert work == pytest.approx(2 * pi * profile.parameter, rel=1e-5)


def test_torus_bifurcation_where_growth_and_rotation_decouple():
    """A cycle of radius 1 in (x, y) and an oscillator (u, v) whose growth a - u^2 - v^2 crosses zero: NS at a = 0."""
    model = Model(
        "torus", states={"x": 1, "y": 0, "u": 0, "v": 0}, parameters={"a": -0.5},
        definitions={"s": "x^2 + y^2", "w": "u^2 + v^2"},
        equations={"x": "(1 - s)*x - y", "y": "x + (1 - s)*y", "u": "(a - w)*u - 0.3*v", "v": "0.3*u + (a - w)*v"},
    )  # fmt: skip
    family = api.continuation(api.periodic_orbit(model, {"x": 0.9, "y": 0.1, "u": 0, "v": 0}), "a", (-0.5, 0.5))
    assert [p.type for p in family.points] == ["NS"]
    assert family["NS1"].values["a"] == pytest.approx(0.0, abs=1e-9)
    angles = np.abs(np.angle(family["NS1"].eigenvalues))
    assert np.sort(angles)[-2:] == pytest.approx([0.6 * pi, 0.6 * pi], rel=1e-8)


def test_a_simulation_that_comes_to_rest_says_so(stuart):
    with pytest.raises(NoSolutionError, match="comes to rest at an equilibrium"):
        api.periodic_orbit(stuart, {"x": 0.3, "y": 0}, {"r": -0.5})


def test_an_orbit_from_an_array_is_polished(stuart):
    t = np.linspace(0.0, 1.0, 41)
    rough = 0.72 * np.stack([np.cos(2 * pi * t), np.sin(2 * pi * t)], axis=1)
    orbit = api.periodic_orbit(stuart, rough, {"r": 0.5}, period=5.2)
    assert orbit.period == pytest.approx(2 * pi / 1.25, rel=1e-9)


def test_rest_of_a_driven_oscillator_doubles_its_period_where_hills_equation_has_the_multiplier_minus_one():
    """x'' + 0.1 x' + (1 + F cos 2t) x + x^3 = 0 at x = 0; the linear part is integrated over pi by scipy."""
    model = Model(
        "driven", states={"x": 0.0, "y": 0.0}, parameters={"F": 0.0},
        equations={"x": "y", "y": "-0.1*y - (1 + F*cos(2*t))*x - x^3"}, forcing={"period": "pi"},
    )  # fmt: skip

    def antiperiodic(strength: float) -> float:
        def rhs(t, u):
            return [u[1], -0.1 * u[1] - (1 + strength * np.cos(2 * t)) * u[0]]

        columns = [solve_ivp(rhs, (0, pi), e, rtol=1e-12, atol=1e-14).y[:, -1] for e in np.eye(2)]
        return float(np.linalg.det(np.column_stack(columns) + np.eye(2)))

    rest = api.continuation(api.periodic_orbit(model), "F", (0.0, 1.0))
    (point,) = rest.points
    assert point.type == "PD"
    assert point.values["F"] == pytest.approx(brentq(antiperiodic, 0.1, 0.3, xtol=1e-12), abs=1e-9)
    moving = api.continuation(point.switch()[0], "F", (0.0, 1.0))
    assert moving.ends[1].reason == "bound"
    assert moving.columns["x.max"][-1] > 0.1
    assert len(rest) < 60


def test_a_relaxation_oscillation_of_100_000_fastest_times_is_waited_for():
    """Van der Pol at m = 200: T = (3 - 2 ln 2) m + 7.014 m^(-1/3) + O(ln m/m) (Dorodnicyn 1947, Urabe 1960)."""
    model = Model(
        "vdp", states={"x": 2, "y": 0}, parameters={"m": 200}, equations={"x": "y", "y": "m*(1 - x^2)*y - x"}
    )
    orbit = api.periodic_orbit(model)
    assert abs(orbit.period - (1.6137056388801094 * 200 + 7.014 * 200 ** (-1 / 3))) < 0.05


@pytest.mark.parametrize("beyond", [1e-7, 1e-5, 1e-3])
def test_a_bound_next_to_a_hopf_point_is_reached_by_the_family_itself(beyond):
    """The Brusselator's orbits at A = 1: r^2 = (2/3)(B - 2)(1 + O(B - 2)), r the amplitude of the first harmonic of x.

    The first point that can be told from the Hopf point may lie beyond the bound.
    """
    brusselator = {"x": "A - (B + 1)*x + x^2*y", "y": "B*x - x^2*y"}
    model = Model("brusselator", states={"x": 1, "y": 1}, parameters={"A": 1, "B": 1.5}, equations=brusselator)
    line = api.continuation(model, "B", (1.0, 3.0))
    family = api.continuation(line["HB1"].switch(), "B", (1.0, 2.0 + beyond))
    b, extent = (np.asarray(v) for v in (family.columns["B"], family.columns["x.max"] - family.columns["x.min"]))
    assert b[-1] == 2.0 + beyond
    assert b.max() == b[-1]
    assert extent[1:] ** 2 == pytest.approx(16.0 / 3.0 * (b[1:] - 2.0), rel=2.0 * beyond + 3e-4)
