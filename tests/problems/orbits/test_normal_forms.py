"""Critical normal forms of orbits against systems whose coefficients are known in closed form."""

from math import pi, sqrt

import numpy as np
import pytest

from contin import api
from contin.model.model import Model
from contin.problems.orbits.linearised import bordered
from contin.problems.orbits.linearised.bordered import factors
from contin.problems.orbits.linearised.solved_orbit import SolvedOrbit
from contin.problems.orbits.normal_forms.normal_form import on_two_meshes
from contin.problems.orbits.special_orbits.defining import special_on_finer_mesh


def test_coefficient_of_a_fold_of_cycles_with_shear(monkeypatch):
    """r' = r (b + s - s^2), theta' = 1 + s, s = r^2: fold at b = -1/4, s = 1/2.

    The phase tau = theta / w0 has tau' = 1 + (w1 / w0) (r - r0), w0 = 3/2, w1 = 2 r0, so xi = -(w1 / w0) (r - r0) and
    xi' = -(w0 / w1) (g''/2) xi^2 with g'' = -4 r0: b = w0 g''/(-2 w1) = 3/2.
    """
    growth = "b + s - s^2"
    model = Model(
        "bautin", states={"x": 0, "y": 0}, parameters={"b": -1}, definitions={"s": "x^2 + y^2"},
        equations={"x": f"({growth})*x - (1 + s)*y", "y": f"(1 + s)*x + ({growth})*y"},
    )  # fmt: skip
    line = api.continuation(api.equilibrium(model), "b", (-1.0, 1.0))
    family = api.continuation(line["HB1"].switch(), "b", (-1.0, 1.0))
    point = family["LPC1"]
    assert point.normal_form["b"] == pytest.approx(1.5, rel=1e-6)
    made = []

    def counted(matrix):
        made.append(matrix)
        return factors(matrix)

    monkeypatch.setattr(bordered, "factors", counted)
    finer = special_on_finer_mesh(family.problem, "LPC", point.z, point.scale)
    made.clear()
    solved = SolvedOrbit(point.z, 0.0, 0.0, 0.0, np.zeros((0, 1)), point.scale, finer)
    for found in on_two_meshes(family.problem, "LPC", solved):
        assert found.value.real == pytest.approx(1.5, rel=1e-6)
    assert len(made) == 4 + 2  # three for two borders, that of one is known from these; on the finer mesh both are


def test_coefficient_of_a_fold_of_cycles_of_constant_period():
    """The same with theta' = 1: the coordinate is (r - r0), of unit size, and b = g''/2 = -2 r0 up to its sense."""
    growth = "b + s - s^2"
    model = Model(
        "bautin", states={"x": 0, "y": 0}, parameters={"b": -1}, definitions={"s": "x^2 + y^2"},
        equations={"x": f"({growth})*x - y", "y": f"x + ({growth})*y"},
    )  # fmt: skip
    line = api.continuation(api.equilibrium(model), "b", (-1.0, 1.0))
    family = api.continuation(line["HB1"].switch(), "b", (-1.0, 1.0))
    assert abs(family["LPC1"].normal_form["b"]) == pytest.approx(sqrt(2.0), rel=1e-6)


def test_coefficient_of_a_fold_with_shear_does_not_depend_on_coordinates():
    """The first system in x, w = y + 0.3 x^2."""
    growth, turn = "b + s - s^2", "1 + s"
    model = Model(
        "bent", states={"x": 0, "w": 0}, parameters={"b": -1},
        definitions={"y": "w - 0.3*x^2", "s": "x^2 + y^2", "fx": f"({growth})*x - ({turn})*y"},
        equations={"x": "fx", "w": f"({turn})*x + ({growth})*y + 0.6*x*fx"},
    )  # fmt: skip
    line = api.continuation(api.equilibrium(model), "b", (-1.0, 1.0))
    family = api.continuation(line["HB1"].switch(), "b", (-1.0, 1.0))
    assert family["LPC1"].values["b"] == pytest.approx(-0.25, abs=1e-9)
    assert family["LPC1"].normal_form["b"] == pytest.approx(1.5, rel=1e-5)


def test_coefficient_of_a_fold_of_forced_orbits():
    """x = s + sin t with s' = mu + 3 s^2: v = 1 and b = 3."""
    model = Model(
        "forced", states={"x": -0.3}, parameters={"mu": -0.25}, forcing={"period": "2*pi"},
        equations={"x": "mu + 3*(x - sin(t))^2 + cos(t)"},
    )  # fmt: skip
    family = api.continuation(api.periodic_orbit(model, {"x": -0.3}), "mu", (-1.0, 1.0))
    assert family["LPC1"].values["mu"] == pytest.approx(0.0, abs=1e-9)
    assert abs(family["LPC1"].normal_form["b"]) == pytest.approx(3.0, rel=1e-6)


def moebius(cubic: float, shear: float) -> Model:
    """X' = mu X + cubic X^3, Y' = -Y, theta' = 1 + shear X^2 on a band with half a twist.

    (X, Y) are the coordinates across the circle r = 1 in axes that turn by half of theta, so that X is antiperiodic.
    """
    states = {"x": 1, "y": 0, "z": 0}
    definitions = {
        "r": "sqrt(x^2 + y^2)", "R": "r - 1", "co": "x/r", "si": "y/r",
        "cc": "(1 + co)/2", "ss": "(1 - co)/2", "cs": "si/2",
        "Xc": "R*cc + z*cs", "Xs": "R*cs + z*ss", "Yc": "z*cc - R*cs", "Ys": "z*cs - R*ss",
        "XX": "R^2*cc + 2*R*z*cs + z^2*ss",
        "gX": f"mu + ({cubic})*XX", "turn": f"1 + ({shear})*XX",
        "dR": "gX*Xc + Ys - turn/2*z", "dz": "gX*Xs - Yc + turn/2*R",
    }  # fmt: skip
    equations = {"x": "dR*co - turn*y", "y": "dR*si + turn*x", "z": "dz"}
    return Model("moebius", states=states, parameters={"mu": -0.5}, definitions=definitions, equations=equations)


@pytest.mark.parametrize(("cubic", "shear"), [(-1.0, 0.0), (0.7, 0.0), (-0.4, 0.9)])
def test_coefficient_and_criticality_of_a_period_doubling(cubic, shear):
    model = moebius(cubic, shear)
    start = api.periodic_orbit(model, {"x": 1.05, "y": 0.0, "z": 0.02}, {"mu": -0.5})
    family = api.continuation(start, "mu", (-0.5, 0.5))
    point = family["PD1"]
    assert point.values["mu"] == pytest.approx(0.0, abs=1e-9)
    assert point.normal_form["c"] == pytest.approx(cubic, rel=1e-6)
    assert point.normal_form["criticality"] == ("supercritical" if cubic < 0 else "subcritical")
    doubled = api.continuation(point.switch(), "mu", (-0.5, 0.5))
    side = doubled.columns["mu"][len(doubled) // 2]
    assert (side > 0) == (cubic < 0)  # 0 = mu + cubic X^2
    assert bool(doubled.columns["stable"][len(doubled) // 2]) == (cubic < 0)


@pytest.mark.parametrize(("cubic", "shear", "spin"), [(-1.0, 0.0, 0.0), (0.5, 0.6, 0.0), (-0.3, 0.4, 0.7)])
def test_coefficient_and_criticality_of_a_torus_bifurcation(cubic, shear, spin):
    """w = u + i v: w' = (a + 0.3 i + (cubic + spin i) |w|^2) w beside a cycle with theta' = 1 + shear |w|^2.

    With w = sqrt(2) xi for |v| = 1, d = 2 (cubic + i spin); the frequency is 0.3 for w = xi v + conjugate.
    """
    model = Model(
        "torus", states={"x": 1, "y": 0, "u": 0, "v": 0}, parameters={"a": -0.5},
        definitions={
            "s": "x^2 + y^2", "w": "u^2 + v^2", "g": f"a + ({cubic})*w",
            "o": f"0.3 + ({spin})*w", "k": f"1 + ({shear})*w",
        },
        equations={"x": "(1 - s)*x - k*y", "y": "k*x + (1 - s)*y", "u": "g*u - o*v", "v": "o*u + g*v"},
    )  # fmt: skip
    start = api.periodic_orbit(model, {"x": 0.9, "y": 0.1, "u": 0, "v": 0})
    point = api.continuation(start, "a", (-0.5, 0.5))["NS1"]
    assert point.values["period"] == pytest.approx(2 * pi, rel=1e-9)
    real, imaginary = point.normal_form["d"]
    assert real == pytest.approx(2 * cubic, rel=1e-6)
    assert imaginary == pytest.approx(2 * spin, abs=1e-6)
    assert point.normal_form["criticality"] == ("supercritical" if cubic < 0 else "subcritical")


def test_coefficient_of_a_period_doubling_gives_the_size_of_the_doubled_orbits():
    """Second method, Lur'e system: half the difference of u(t) and u(t + T) is xi v with 0 = m (al - al0) + c xi^2,
    where -exp(m (al - al0) T) is the multiplier of the simple orbit. The mean of |v|^2 is 1.
    """
    model = Model(
        "lure", states={"x": 0, "y": 0, "z": 0}, parameters={"al": 1.5},
        equations={"x": "y", "y": "z", "z": "-al*z - y - x + x^2"},
    )  # fmt: skip
    line = api.continuation(api.equilibrium(model), "al", (0.6, 1.5))
    family = api.continuation(line["HB1"].switch(), "al", (0.6, 1.5))
    point = family["PD1"]
    logs = []
    for shift in (-1e-3, 1e-3):
        z = family.problem.at_parameter(point.z, point.values["al"] + shift, point.scale)
        multiplier = np.min(family.problem.multipliers(z).real)
        logs.append(np.log(-multiplier) / family.problem.profile(z).period)
    rate = (logs[1] - logs[0]) / 2e-3
    doubled = api.continuation(point.switch(), "al", (0.6, 1.5), settings={"max_step": 0.01, "steps": 30, "step": 1e-3})
    shifts, squares = [], []
    for z in doubled.z[1:]:
        profile = doubled.problem.profile(z)
        half = 0.5 * (profile.u - profile.at((profile.times + 0.5) % 1.0))
        squares.append(float(profile.weights @ np.sum(half**2, axis=1)))
        shifts.append(profile.parameter - point.values["al"])
    slope = np.polyfit(shifts, np.divide(squares, shifts), 2)[2]
    assert point.normal_form["c"] == pytest.approx(-rate / slope, rel=1e-4)
    assert point.normal_form["criticality"] == "supercritical"
