"""Amplitude, norm, frequency and formulas in integrals and extrema are columns of families of orbits."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import contin
from contin.errors import InputError
from contin.problems.shooting.sampling import states

OMEGA = 1.5


@pytest.fixture(scope="module")
def circle():
    """r' = r (mu - r^2) on circles of radius sqrt(mu), centre (c, 0), angular speed OMEGA."""
    return contin.Model(
        "circle", states={"x": 2.0, "y": 0.0}, parameters={"mu": -1.0, "c": 2.0, "w": OMEGA},
        equations={
            "x": "mu*(x - c) - w*y - (x - c)*((x - c)^2 + y^2)", "y": "w*(x - c) + mu*y - y*((x - c)^2 + y^2)",
        },
    )  # fmt: skip


@pytest.fixture(scope="module")
def birth(circle):
    return contin.continuation(contin.equilibrium(circle), "mu", (-1.0, 1.0))["HB1"]


@pytest.mark.parametrize("method", ["collocation", "shooting"])
def test_columns_of_circles_are_those_of_geometry(birth, method):
    formulas = ["mean(x^2)", "integral(x^2)", "max(x) - min(y)", "mean(x)*frequency"]
    branch = contin.continuation(birth.switch(), "mu", (-1, 1), columns=formulas, settings={"method": method})
    mu, period = branch.columns["mu"], 2 * np.pi / OMEGA
    expected = {
        "amplitude": np.sqrt(mu), "norm": np.sqrt(mu + 4.0), "frequency": 0 * mu + 1 / period,
        "mean(x^2)": 4.0 + mu / 2, "integral(x^2)": period * (4.0 + mu / 2), "max(x) - min(y)": 2.0 + 2 * np.sqrt(mu),
        "mean(x)*frequency": 0 * mu + 2 / period,
    }  # fmt: skip
    for name, values in expected.items():
        np.testing.assert_allclose(branch.columns[name], values, atol=1e-8, rtol=1e-8, err_msg=name)


@pytest.mark.parametrize("method", ["collocation", "shooting"])
def test_user_values_of_formulas_are_hit(birth, method):
    values = {"amplitude": [0.5], "norm": [2.1], "mean(x^2)": [4.25]}
    branch = contin.continuation(birth.switch(), "mu", (-1, 1), values=values, settings={"method": method})
    found = sorted(point.values["mu"] for point in branch.points if point.type == "UZ")
    assert found == pytest.approx([0.25, 2.1**2 - 4, 0.5], abs=1e-7)


def test_extrema_of_amplitude_are_labelled_on_responses():
    """x'' + 2 d x' + x = f cos(w t): the amplitude is largest at w^2 = 1 - 2 d^2, where it is f/(2 d sqrt(1 - d^2))."""
    d = 0.3
    model = contin.Model(
        "linear", states={"x": 0.0, "v": 0.0}, parameters={"w": {"value": 0.5, "range": [0.5, 1.5]}, "d": d},
        forcing={"period": "2*pi/w"}, equations={"x": "v", "v": "cos(w*t) - 2*d*v - x"},
    )  # fmt: skip
    for method in ("collocation", "shooting"):
        start = contin.periodic_orbit(model, {"x": 0.4})
        branch = contin.continuation(start, "w", extrema=["amplitude"], settings={"method": method})
        point = branch["EX1"]
        assert abs(point.values["w"] - np.sqrt(1 - 2 * d**2)) <= point.error < 1e-6
        assert branch["EX1"].values["amplitude"] == pytest.approx(0.5 / d / np.sqrt(1 - d**2), rel=1e-8)
        assert branch["EX1"].normal_form["kind"] == "maximum"
        assert branch.ends[1].reason == "bound"


def test_integrals_of_piecewise_smooth_orbits_are_as_exact_as_the_orbits():
    """x'' = -x - 0.2 x' + sign-like forcing by abs: |x| averaged over one period, beside a dense sum."""
    model = contin.Model(
        "kinked", states={"x": 0.3, "v": 0.0}, parameters={"w": {"value": 1.3, "range": [1.2, 1.4]}},
        forcing={"period": "2*pi/w"}, equations={"x": "v", "v": "cos(w*t) - 0.4*v - x - 0.5*abs(x)"},
    )  # fmt: skip
    start = contin.periodic_orbit(model, {"x": 0.3})
    branch = contin.continuation(start, "w", columns=["mean(abs(x))", "integral(v^2)"], settings={"steps": 4})
    problem, z = branch.problem, branch.z[0]
    times = (np.arange(20_000) + 0.5) / 20_000
    u = states(problem, z, times)
    period = branch.columns["period"][0]
    assert branch.columns["mean(abs(x))"][0] == pytest.approx(np.abs(u[:, 0]).mean(), rel=1e-8)
    assert branch.columns["integral(v^2)"][0] == pytest.approx(period * (u[:, 1] ** 2).mean(), rel=1e-8)


def test_names_of_the_model_win_and_mistakes_are_told(circle, birth):
    own = contin.Model(
        "own", states={"x": 0.0, "y": 0.0}, parameters={"mu": -1.0, "norm": 1.0},
        observables={"amplitude": "x^2 + y^2"},
        equations={"x": "mu*x - y - x*(x^2 + y^2)", "y": "x + mu*y - norm*y*(x^2 + y^2)"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(own), "mu", (-1, 1))
    columns = contin.continuation(line["HB1"].switch(), "mu", (-1, 1)).columns
    assert {"amplitude.max", "frequency"} < set(columns)
    assert not {"amplitude", "norm"} & set(columns)
    for wrong, said in {"mean(z)": "unknown name 'z'", "x^2": "mean", "mean(x) = 1": "not an equation"}.items():
        with pytest.raises(InputError, match=said):
            contin.continuation(birth.switch(), "mu", (-1, 1), columns=[wrong])
    plain = contin.continuation(contin.equilibrium(circle), "mu", (-1, 1), columns=["mean(x)"])
    assert any("mean(x)" in note for note in plain.notes)


def test_spikes_of_orbits_found_by_shooting_have_their_height():
    """x'' = k s x' - x with s = 1 where |x| < 1, else -1, at k = 30: spikes last for 1 % of a period.

    By halves: from x = 1 outwards at speed v the solution of the outer piece returns to x = 1; the inner one leads to
    x = -1, where the speed is -v again. The largest speed is v, where the damping begins.
    """
    model = contin.Model(
        "relaxing", states={"x": 2, "y": 0}, parameters={"k": 30},
        equations={"x": "y", "y": "k*(1 if abs(x) < 1 else -1)*y - x"},
    )  # fmt: skip

    def passed(k: float, state: list[float], at: float) -> list[float]:
        def level(t, u):
            return u[0] - at

        level.terminal, level.direction = True, -1.0
        found = solve_ivp(
            lambda t, u: [u[1], k * u[1] - u[0]], (0.0, 200.0), state, method="DOP853", rtol=1e-12, atol=1e-13,
            events=level,
        )  # fmt: skip
        return found.y_events[0][0].tolist()

    def closes(v: float) -> float:
        returned = passed(-30.0, [1.0, v], 1.0)
        return -passed(30.0, returned, -1.0)[1] - v

    speed = brentq(closes, 50.0, 70.0, xtol=1e-12)
    branch = contin.continuation(contin.periodic_orbit(model), "k", (30.0, 30.01))
    assert branch.columns["y.max"][0] == pytest.approx(speed, rel=1e-8)
    assert branch.columns["x.max"][0] == pytest.approx(-branch.columns["x.min"][0], rel=1e-9)


def test_spikes_between_the_samples_of_a_smooth_orbit():
    """Van der Pol's equation at mu = 30: y spikes for 1 % of the period; both methods agree on their height."""
    model = contin.Model(
        "van-der-pol", states={"x": 2, "y": 0}, parameters={"mu": 30}, equations={"x": "y", "y": "mu*(1 - x^2)*y - x"}
    )
    orbit = contin.periodic_orbit(model)
    one, other = (
        contin.continuation(orbit, "mu", (30.0, 30.01), settings={"method": method}).columns
        for method in ("collocation", "shooting")
    )
    assert other["y.max"][0] == pytest.approx(one["y.max"][0], rel=1e-6)
    assert other["x.max"][0] == pytest.approx(one["x.max"][0], rel=1e-7)
    assert other["norm"][0] == pytest.approx(one["norm"][0], rel=1e-5)
