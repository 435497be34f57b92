"""One oscillator: averages against adaptive quadrature of the equations of motion, and against closed forms."""

import math

import numpy as np
import pytest
from oscillating import mean_motion, oscillators
from scipy.integrate import solve_ivp

import contin
from contin.errors import InputError
from contin.model.evaluate import evaluate
from contin.model.printing import to_text

QUARTERS = [k * math.pi / 2 for k in range(4)]

# force, parameters, thresholds of |x| (or of |y|), may it be a quadrature
CASES = [
    ("(mu + x^2 - x^4)*y", {"mu": 0.3}, [], False),
    ("a*x^3 - b*x^5 if x*y > 0 else 0", {"a": 4, "b": 1}, [], False),
    ("x^3/(1 + x^4) if x*y > 0 else 0", {}, [], False),
    ("x/(1 + k*x^2)^2 if x*y > 0 else 0", {"k": 2}, [], False),
    ("y/(1 + x^2)", {}, [], False),
    ("1 if 1 < x < 1.5 and y > 0 else -1 if -1.5 < x < -1 and y < 0 else 0", {}, [1, 1.5], False),
    ("c if x1 < x < x2 and y > 0 else 0", {"x1": 0.7, "x2": 1.6, "c": 2}, [0.7, 1.6], False),
    ("max(x - 1, 0)*y + abs(x)*x", {}, [1], False),
    ("x^2*y if x > 0.5 else y^3", {}, [0.5], False),
    ("-c*sign(y) + mu*y", {"c": 0.4, "mu": 0.2}, [], False),
    ("tanh(2*x) if x*y > 0 else 0", {}, [], True),
    ("tanh(k*y) - x*exp(-x^2)", {"k": 1.5}, [], True),
    ("y*exp(-x) if x > 1 else 0", {}, [1], True),
]


@pytest.mark.parametrize(("force", "parameters", "thresholds", "rule"), CASES)
def test_average_agrees_with_quadrature_of_the_equations(force, parameters, thresholds, rule):
    model = oscillators(force, parameters=parameters)
    averaged = contin.average(model)
    for r in (0.31, 0.85, 1.27, 2.2, 3.4):
        cuts = [*QUARTERS, *(s * math.acos(t * c / r) for t in thresholds if t < r for s in (1, -1) for c in (1, -1))]
        motion = mean_motion(model, [r], cuts=cuts)[0]
        env = {**averaged.default_parameters(), "r": r}
        assert evaluate(averaged.equations[0], env) == pytest.approx(motion.real, abs=2e-12)
        assert evaluate(averaged.observables["frequency_shift"], env) == pytest.approx(motion.imag / r, abs=4e-12)
    assert (to_text(averaged.equations[0]).count("tanh") > 3 or "exp" in to_text(averaged.equations[0])) == rule


@pytest.mark.seldom
def test_random_polynomials_between_random_lines_agree_with_quadrature():
    chance = np.random.default_rng(2)
    for _ in range(4):
        slope, level = chance.uniform(-1.5, 1.5), chance.uniform(0.1, 0.6)
        m, n = chance.integers(0, 4, 2)
        force = f"x^{m}*y^{n} if y > {slope:.3f}*x + {level:.3f} else -y"
        model = oscillators(force)
        averaged = contin.average(model)
        for r in (0.05, 1.1, 2.3):
            size = math.hypot(1.0, round(slope, 3)) * r
            cuts = []
            if round(level, 3) < size:
                # -slope r cos(phi) - r sin(phi) = level
                beta, delta = math.acos(round(level, 3) / size), math.atan2(-1.0, -round(slope, 3))
                cuts = [delta + beta, delta - beta]
            motion = mean_motion(model, [r], cuts=cuts)[0]
            env = {**averaged.default_parameters(), "r": r}
            assert evaluate(averaged.equations[0], env) == pytest.approx(motion.real, abs=1e-11)


def test_the_frequency_may_be_a_parameter():
    model = oscillators("a*y - x^2*y", parameters={"a": 0.5, "w": 2.5}, stiffness="w^2")
    averaged = contin.average(model)
    for r in (0.4, 1.3):
        motion = mean_motion(model, [r], omega=2.5)[0]
        assert evaluate(averaged.equations[0], {**averaged.default_parameters(), "r": r}) == pytest.approx(motion.real)
    assert "w" not in to_text(averaged.equations[0])  # r' = a r/2 - r^3/8 for every w


def test_van_der_pol_reads_as_in_a_book():
    averaged = contin.average(oscillators("(1 - x^2)*y"), time="fast")
    assert to_text(averaged.equations[0]) == "eps*(-r^3/8 + r/2)"


def test_averaging_follows_the_motion_to_order_eps():
    """sup |r(t) - r_averaged(t)| over times 1/eps falls like eps."""
    model = oscillators("(0.8 - x^2)*y - 0.4*x^3 + (0.3 if x*y > 0 else 0)*x")
    averaged = contin.average(model)

    def motion(t, u, eps):
        x, y = u
        return [y, -x + eps * ((0.8 - x * x) * y - 0.4 * x**3 + (0.3 * x if x * y > 0 else 0.0))]

    def slow(t, u):
        return [evaluate(averaged.equations[0], {"eps": 0, "r": float(u[0])})]

    curve = solve_ivp(slow, (0, 3), [0.6], "DOP853", rtol=1e-10, atol=1e-12, dense_output=True).sol
    errors = []
    for eps in (0.04, 0.02, 0.01):
        full = solve_ivp(motion, (0, 3 / eps), [0.6, 0.0], args=(eps,), rtol=1e-7, atol=1e-9, max_step=0.2)
        errors.append(np.max(np.abs(np.hypot(*full.y) - curve(eps * full.t)[0])))
    assert np.diff(np.log(errors)) / np.log(0.5) == pytest.approx([1, 1], abs=0.15)


def test_rest_is_an_ordinary_equilibrium_where_the_closed_form_reads_zero_over_zero():
    model = oscillators("-alpha*y + (x/(1 + x^2) if x*y > 0 else 0)", parameters={"alpha": 0.15})
    averaged = contin.average(model)
    line = contin.continuation(contin.equilibrium(averaged, {"r": 0}), "alpha", (0.05, 0.7))
    (point,) = line.points
    assert point.type == "BP"
    assert point.values["alpha"] == pytest.approx(1 / math.pi, rel=1e-10)
    assert point.normal_form["kind"] == "pitchfork"


@pytest.mark.parametrize(
    ("force", "more", "message"),
    [
        ("y if sin(x) > 0.5 else 0", {}, "cannot locate where the condition"),
        ("y if x^5 - x + y^3 > 0 else 0", {}, "cannot locate"),
    ],
)
def test_conditions_that_cannot_be_located_are_quoted(force, more, message):
    with pytest.raises(InputError, match=message):
        contin.average(oscillators(force, **more))


def test_what_is_not_harmonic_at_zero_is_named():
    model = contin.Model(
        "hard", states={"x": 1, "y": 0}, parameters={"eps": 0.1}, equations={"x": "y", "y": "-x - x^3 + eps*y"},
        averaging={"small": "eps", "oscillators": [{"position": "x", "velocity": "y"}]},
    )  # fmt: skip
    with pytest.raises(InputError, match=r"the term -x\^3 is left over"):
        contin.average(model)
    with pytest.raises(InputError, match="omega"):
        contin.average(oscillators("y", stiffness="-1"))
    with pytest.raises(InputError, match="declares no oscillators"):
        contin.average(contin.Model("m", states={"x": 1}, equations={"x": "-x"}))
    with pytest.raises(InputError, match="did you mean 'polar'"):
        contin.average(oscillators("y"), form="polr")
    with pytest.raises(InputError, match="two oscillators"):
        contin.average(oscillators("y"), form="stokes")


def test_presumptions_about_parameters_are_stated():
    model = oscillators("1 if c < x and y > 0 else 0", parameters={"c": 0.5, "d": 1})
    assert "presume 0 < c" in contin.average(model).description


def test_a_polar_solution_that_falls_to_rest_ends_there_and_names_the_smooth_form():
    """r' = r (mu + r^2/4 - r^4/8)/2: fold at mu = -1/8, r = 1, and rest reached at mu = 0."""
    averaged = contin.average(oscillators("(mu + x^2 - x^4)*y", parameters={"mu": 0.5}))
    line = contin.continuation(contin.equilibrium(averaged, {"r": 1.7}), "mu", (-1, 1))
    assert [(p.type, p.values["mu"]) for p in line.points] == [
        ("BP", pytest.approx(0, abs=1e-9)),
        ("LP", pytest.approx(-1 / 8, rel=1e-9)),
    ]
    assert line.ends[0].reason == "bound"
    assert "form cartesian" in line.ends[0].text
    rest = contin.continuation(contin.equilibrium(averaged, {"r": 0}), "mu", (-1, 1))
    assert [p.type for p in rest.points] == ["BP"]
    assert [end.reason for end in rest.ends] == ["bound", "bound"]
    assert np.all(np.abs(rest.columns["r"]) < 1e-12)
