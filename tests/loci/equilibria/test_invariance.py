"""Curves and their points belong to the system: units, order and direction do not matter."""

import numpy as np
import pytest

import contin
from contin.loci.equilibria import curves
from tests.loci.equilibria.planes import BOGDANOV_TAKENS, BOX, DOUBLE_HOPF, assert_points, follow, found, zero_hopf

TANK_BOX = {"p": (0.0, 0.5), "q": (0.5, 5.0)}
# A stirred tank (Uppal, Ray and Poore 1974) with b = 18. Equilibria v = b u/(1 + q), p = u exp(-v)/(1 - u); folds
# where dp/du = 0: 1 + q = b u (1 - u); their cusp is at u = 1/2
CUSP_POINT = ("CP", np.exp(-2.0), 3.5)


def tank(units=(1.0, 1.0)):
    a, b = units
    f = {"u": "-U + p*(1 - U)*exp(V)", "v": "-V + 18*p*(1 - U)*exp(V) - q*V"}
    return contin.Model(
        "tank", states={"u": 0.0, "v": 0.0}, parameters={"p": 0.0, "q": 2.0},
        definitions={"U": f"u/{a!r}", "V": f"v/{b!r}"},
        equations={"u": f"{a!r}*({f['u']})", "v": f"{b!r}*({f['v']})"},
    )  # fmt: skip


def tank_line(units=(1.0, 1.0)):
    return contin.continuation(contin.equilibrium(tank(units)), "p", (0.0, 0.5))


@pytest.mark.parametrize("units", [(1.0, 1.0), (1e6, 1e-6), (1e-7, 1e-7)])
@pytest.mark.parametrize("label", ["LP1", "LP2"])
def test_tank_has_its_cusp_at_exp_minus_two_and_seven_halves_in_any_units(units, label):
    curve = follow(tank_line(units)[label], box=TANK_BOX)
    u = curve.columns["u"] / units[0]
    np.testing.assert_allclose(18 * u * (1 - u) / (1 + curve.columns["q"]), 1.0, atol=1e-8)
    cusps = [p for p in curve.points if p.type == "CP"]
    assert [(p.values["p"], p.values["q"]) for p in cusps] == [pytest.approx(CUSP_POINT[1:], rel=1e-11)]
    takens = [p for p in curve.points if p.type == "BT"]
    assert [(p.values["p"], p.values["q"]) for p in takens] == [pytest.approx(_bogdanov_takens(), rel=1e-10)]


def _bogdanov_takens():
    """Trace zero on the folds: with p e^v = u/(1 - u), -1 - u/(1 - u) - (1 + q) + 18 u = 0 and 1 + q = 18 u (1 - u)."""
    from scipy.optimize import brentq

    def trace(u):
        return -1 - 1 / (1 - u) + 1 - 18 * u * (1 - u) + 18 * u

    u = brentq(trace, 0.05, 0.9)
    q = 18 * u * (1 - u) - 1
    return u / (1 - u) * np.exp(-18 * u / (1 + q)), q


@pytest.mark.parametrize("plane", [BOGDANOV_TAKENS, DOUBLE_HOPF, zero_hopf(1, 0.7)], ids=["BT", "HH", "ZH"])
def test_the_order_of_the_two_parameters_only_swaps_columns(plane):
    points = plane.line(5).points
    assert points
    for point in points:
        one, other = follow(point), follow(point, ("q", "p"))
        assert other.parameters == ("q", "p")
        assert found(one)
        assert_points(other, found(one))
        assert sorted(e.reason for e in one.ends) == sorted(e.reason for e in other.ends)


@pytest.mark.parametrize("direction", ["up", "down"])
def test_each_arm_alone_finds_the_points_of_its_side(direction):
    whole = BOGDANOV_TAKENS.curve("LP1", 4)
    arm = BOGDANOV_TAKENS.curve("LP1", 4, direction=direction)
    other = BOGDANOV_TAKENS.curve("LP1", 4, direction="down" if direction == "up" else "up")
    assert sorted(found(arm) + found(other)) == [pytest.approx(p, abs=1e-9) for p in found(whole)]
    sense = 1.0 if direction == "up" else -1.0
    assert sense * (arm.columns["p"][1] - arm.columns["p"][0]) > 0.0


@pytest.mark.parametrize("plane", [BOGDANOV_TAKENS, DOUBLE_HOPF, zero_hopf(-1, 0.8)], ids=["BT", "HH", "ZH"])
def test_minimally_augmented_systems_give_the_same_points_to_1e_minus_10(plane, monkeypatch):
    line = plane.line(6)
    assert line.points
    extended = [follow(point) for point in line.points]
    monkeypatch.setattr(curves, "LARGE", 1)
    for point, wanted in zip(line.points, extended, strict=True):
        bordered = follow(point)
        assert not bordered.problem.curve.compiled
        assert wanted.problem.curve.compiled
        assert_points(bordered, found(wanted), atol=1e-10)
        for a, b in zip(_by_place(bordered), _by_place(wanted), strict=True):
            for key, value in b.normal_form.items():
                if isinstance(value, float):
                    assert a.normal_form[key] == pytest.approx(value, rel=1e-6, abs=1e-9)


def _by_place(branch):
    return sorted(branch.points, key=lambda p: (p.type, round(p.values["p"], 8), round(p.values["q"], 8)))


@pytest.mark.seldom
def test_a_user_function_gives_the_curves_of_the_same_model():
    def residual(u, p):
        return np.array([u[1], p["p"] + p["q"] * u[0] + u[0] ** 2 - u[0] * u[1]])

    problem = contin.FunctionProblem(residual, [-1.0, 0.0], {"p": -0.5, "q": -0.5})
    line = contin.continuation(problem, "p", BOX["p"])
    for label in ("LP1", "HB1"):
        curve = follow(line[label], box={"p": (-0.6, 0.6), "q": (-0.6, 0.4)})
        assert_points(curve, [("BT", 0.0, 0.0)], atol=1e-6)  # derivatives by differences
        wanted = curve.columns["q"] ** 2 / 4 if label == "LP1" else 0.0
        np.testing.assert_allclose(curve.columns["p"], wanted, atol=1e-7)
