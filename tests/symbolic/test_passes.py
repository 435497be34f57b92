"""Passes against independent computations: sampled vector fields, pushed forward numerically."""

import math

import numpy as np
import pytest

import contin
from contin.errors import InputError
from contin.model.evaluate import evaluate_all
from contin.symbolic.passes.arclength import with_arclength
from contin.symbolic.passes.coordinates import change_coordinates
from contin.symbolic.passes.corotating import corotate
from contin.symbolic.passes.fix_parameters import fix_parameters
from contin.symbolic.passes.linearisation import linearise
from contin.symbolic.passes.scaling import scale

HOPF = contin.Model(
    "hopf", states={"x": 0.7, "y": 0.2}, parameters={"mu": 0.5, "w": 2.0, "c": 0.3},
    equations={"x": "mu*x - w*y - x*(x^2 + y^2)", "y": "w*x + mu*y - y*(x^2 + y^2)"},
    observables={"energy": "x^2 + y^2"}, symmetries={"flip": {"x": "-x", "y": "-y"}},
    starts={"ring": {"x": "sqrt(mu)", "y": 0}},
)  # fmt: skip
POLAR = {
    "states": {"r": "sqrt(x^2 + y^2)", "theta": "atan2(y, x)"},
    "inverse": {"x": "r*cos(theta)", "y": "r*sin(theta)"},
    "periods": {"theta": "2*pi"},
}


def field(model, point, **parameters):
    return np.array(evaluate_all(model.equations, {**model.default_parameters(parameters), **point}))


def test_polar_coordinates_of_the_hopf_normal_form():
    polar = change_coordinates(HOPF, **POLAR)
    for r, theta in ((0.3, 0.4), (1.2, -2.0)):
        assert field(polar, {"r": r, "theta": theta}) == pytest.approx([0.5 * r - r**3, 2.0], abs=1e-13)
    assert polar.start_point("ring")[0] == pytest.approx([math.sqrt(0.5), 0])
    assert polar.periods() == pytest.approx([0, 2 * math.pi])


def test_coordinates_are_the_pushforward_of_the_field():
    new = change_coordinates(HOPF, {"a": "x + y^3", "b": "exp(y)"}, {"x": "a - log(b)^3", "y": "log(b)"})
    x, y = 0.4, -0.3
    h = 1e-6
    f = field(HOPF, {"x": x, "y": y})
    shifted = [np.array([x + s * h * f[0] + (y + s * h * f[1]) ** 3, math.exp(y + s * h * f[1])]) for s in (1, -1)]
    found = field(new, {"a": x + y**3, "b": math.exp(y)})
    assert found == pytest.approx((shifted[0] - shifted[1]) / (2 * h), rel=1e-8)
    with pytest.raises(InputError, match="does not undo"):
        change_coordinates(HOPF, {"a": "x + y", "b": "y"}, {"x": "a + b", "y": "b"})


def test_scaling_converts_field_starts_and_observables():
    scaled = scale(HOPF, time="1/w", states={"x": "sqrt(mu)", "y": 2})
    x, y, mu, w = 0.4, -0.3, 0.5, 2.0
    f = field(HOPF, {"x": x, "y": y})
    found = field(scaled, {"x": x / math.sqrt(mu), "y": y / 2})
    assert found == pytest.approx([f[0] / w / math.sqrt(mu), f[1] / w / 2])
    assert scaled.start_point("ring")[0] == pytest.approx([1, 0])
    env = {**scaled.default_parameters(), "x": 1.0, "y": 0.5}
    assert evaluate_all(scaled.observables.values(), env) == pytest.approx([mu + 1])
    again = scale(scaled, time="w", states={"x": "1/sqrt(mu)", "y": 0.5})
    assert field(again, {"x": x, "y": y}) == pytest.approx(f)


def test_fixed_parameters_are_gone_and_the_field_is_the_same():
    fixed = fix_parameters(HOPF, {"w": "4*mu", "c": 1})
    assert fixed.parameter_names == ("mu",)
    point = {"x": 0.4, "y": -0.3}
    assert field(fixed, point, mu=0.5) == pytest.approx(field(HOPF, point, mu=0.5, w=2.0))
    with pytest.raises(InputError, match="did you mean 'mu'"):
        fix_parameters(HOPF, {"muu": 1})


def test_linearisation_is_the_derivative_of_the_field():
    linear = linearise(HOPF, "ring")
    mu, h = 0.8, 1e-6
    ring = np.array([math.sqrt(mu), 0])
    v = np.array([0.3, -0.7])
    sides = [field(HOPF, dict(zip("xy", ring + s * h * v, strict=True)), mu=mu) for s in (1, -1)]
    found = field(linear, dict(zip("xy", v, strict=True)), mu=mu)
    assert found == pytest.approx((sides[0] - sides[1]) / (2 * h), rel=1e-8)


def test_rotating_waves_are_equilibria_of_the_corotating_frame():
    turned = corotate(HOPF, {"x": "-y", "y": "x"})
    wave = contin.equilibrium(turned, {"x": 0.6, "y": 0.1})
    assert wave.u == pytest.approx([math.sqrt(0.5), 0], abs=1e-12)
    _, jacobian = wave.system.jacobian(wave.u, wave.p)
    assert sorted(np.linalg.eigvals(jacobian[:, :2]).real) == pytest.approx([-1, -1])  # -2 mu, and the phase's
    declared = contin.Model(
        "declared", states={"x": 0.7, "y": 0.2}, parameters={"mu": 0.5, "w": 2.0}, rotation={"x": "-y", "y": "x"},
        equations={"x": "mu*x - w*y - x*(x^2 + y^2)", "y": "w*x + mu*y - y*(x^2 + y^2)"},
    )  # fmt: skip
    for start in ({"x": 0, "y": 0.6}, {"x": -0.5, "y": -0.1}):  # turned to the phase that the frame keeps
        wave = contin.equilibrium(declared, start)
        assert wave.u == pytest.approx([math.sqrt(0.5), 0], abs=1e-12)
    assert contin.equilibrium(declared, {"x": 0, "y": 0}).u == pytest.approx([0, 0])  # rest, in the frame of the file
    line = contin.continuation(wave, "mu", (-1, 1))
    assert line.points == ()
    assert "rest is an equilibrium" in line.ends[0].text
    with pytest.raises(InputError, match="not a symmetry"):
        corotate(HOPF, {"x": "-y", "y": "2*x"})
    with pytest.raises(InputError, match="declares no rotation"):
        corotate(HOPF)


def test_cartesian_averaged_pair_loses_in_phase_where_the_polar_one_does():
    pair = contin.average(contin.load("metronomes/pair"), form="cartesian")
    line = contin.continuation(contin.equilibrium(pair, "in-phase", {"beta": 0.3, "mu": 14}), "mu", (5, 15))
    beta, a, b = 0.3, 4, 1
    critical = (
        -15 * math.pi * beta / 8
        + 27 * a**2 / (64 * b)
        + 9 * a / (64 * b) * math.sqrt(9 * a**2 - 48 * math.pi * b * beta)
    )
    assert [p.values["mu"] for p in line.points] == pytest.approx([critical], rel=1e-9)
    assert line.points[0].type == "BP"


def test_passes_compose_from_a_run_file():
    from contin.model.source import CallSource, Problems
    from contin.runs.transforms import apply_passes

    problems = Problems(CallSource("test"))
    model = contin.load("metronomes/pair")
    steps = [
        {"fix": {"parameters": {"a": 4, "b": 1, "sigma": 0}}},
        {"average": {"form": "stokes"}},
        {"scale": {"time": 2}},
    ]
    made = apply_passes(model, steps, problems)
    problems.raise_if_any()
    direct = contin.average(model, form="stokes")
    point = {"S1": 0.3, "S2": 4.0, "S3": -1.0}
    assert field(made, point) == pytest.approx(2 * field(direct, point))
    apply_passes(model, ["linearize"], problems)
    with pytest.raises(InputError, match="did you mean 'linearise'"):
        problems.raise_if_any()


def test_passes_see_the_parameters_of_the_run():
    """With x1 = 2 > x2 = 1 the escapement never pushes: the averaged amplitude only decays."""
    from contin.model.source import CallSource, Problems
    from contin.runs.transforms import apply_passes

    model = contin.load("metronomes/one-constant")
    problems = Problems(CallSource("test"))
    made = apply_passes(model, [{"average": {"form": "polar"}}], problems, {"x1": 2, "x2": 1, "alpha": 0.1})
    problems.raise_if_any()
    for r in (0.5, 1.5, 3.0):
        assert field(made, {"r": r})[0] == pytest.approx(-0.05 * r)


@pytest.mark.parametrize("backward", [False, True])
def test_arclength_grows_at_the_speed_of_the_orbit_in_either_sense_of_time(backward):
    named = contin.Model("taken", states={"arclength": 1.0}, parameters={"a": 2.0}, equations={"arclength": "-a"})
    assert with_arclength(named).state_names == ("arclength", "arclength_")
    for x, y in ((0.4, -0.3), (-1.2, 0.7)):
        f = field(HOPF, {"x": x, "y": y})
        found = field(with_arclength(HOPF, backward), {"x": x, "y": y, "arclength": 3.0})
        assert found == pytest.approx([*((-f) if backward else f), math.hypot(*f)], rel=1e-15)
