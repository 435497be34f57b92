"""Forcing, m:n resonance, rotators, slow and slaved states: against quadrature of the equations of motion."""

import math

import numpy as np
import pytest
from oscillating import averaged_rates, mean_rates
from scipy.integrate import solve_ivp

import contin
from contin.errors import InputError
from contin.model.evaluate import evaluate_all


def system(equations, averaging, parameters=None, forcing=None, **more):
    return contin.Model(
        "test",
        states=dict.fromkeys(equations, 0.5),
        parameters={"eps": 0.01, **(parameters or {})},
        equations=equations,
        forcing=forcing and {"period": forcing},
        averaging={"small": "eps", **averaging},
        **more,
    )


def pair(x="x", y="y", **more):
    return {"position": x, "velocity": y, **more}


FORCED = {
    "duffing": (
        {"x": "y + eps*0.3*cos(Omega*t)", "y": "-x + eps*(-d*y - x^3 + F*cos(Omega*t + 0.4) + x*sin(2*Omega*t))"},
        {"oscillators": [pair()]},
        {"Omega": 1.0, "d": 0.2, "F": 0.7},
        "2*pi/Omega",
    ),
    "mathieu": (
        {"x": "y", "y": "-w^2*x + eps*((1 - x^2)*y + h*x*cos(Omega*t) + y^2*sin(Omega*t))"},
        {"oscillators": [pair()], "forcing": 2},
        {"Omega": 3.0, "w": 1.5, "h": 0.9},
        "2*pi/Omega",
    ),
    "third": (
        {"x": "y", "y": "-x + eps*((1 - x^2)*y + F*x^2*cos(Omega*t) + exp(-x^2)*sin(Omega*t)^2)"},
        {"oscillators": [pair()], "forcing": 3},
        {"Omega": 3.0, "F": 0.6},
        "2*pi/Omega",
    ),
    "switched": (
        {"x": "y", "y": "-x + eps*((x*y if x*y > 0 else 0) - sign(y + cos(Omega*t)))"},
        {"oscillators": [pair()]},
        {"Omega": 1.0},
        "2*pi/Omega",
    ),
    "two": (
        {"x": "y", "y": "-x + eps*(x*z + F*cos(2*Omega*t))",
         "z": "w", "w": "-4*z + eps*(x^2 - tanh(x)*w + cos(2*Omega*t))"},
        {"oscillators": [pair(), pair("z", "w", harmonic=2)]},
        {"Omega": 1.0, "F": 0.7},
        "2*pi/Omega",
    ),
}  # fmt: skip


@pytest.mark.parametrize("form", ["polar", "cartesian"])
@pytest.mark.parametrize("name", FORCED)
def test_forced_oscillators_agree_with_quadrature(name, form):
    equations, averaging, parameters, period = FORCED[name]
    model = system(equations, averaging, parameters, period)
    averaged = contin.average(model, form=form)
    assert averaged.forcing is None
    assert not averaged.rotation
    omega = 2 * math.pi / model.default_parameters()["Omega"]
    base = 2 * math.pi / omega / averaging.get("forcing", 1)
    chance = np.random.default_rng(4)
    for _ in range(2):
        point = {
            p["position"]: chance.uniform(0.4, 1.6) * np.exp(1j * chance.uniform(0, 6))
            for p in averaging["oscillators"]
        }
        fine = 400 if name == "switched" else 24
        expected = mean_rates(model, point, base, pieces=fine)
        tolerance = 2e-4 if name == "switched" else 1e-9  # of the quadrature at jumps, and of the difference in eps
        np.testing.assert_allclose(averaged_rates(model, averaged, point), expected, atol=tolerance)


def test_detuning_and_a_period_that_holds_eps():
    """Omega = 1 + eps sigma: A' = -i sigma A - (i/2) F, and the same with the frequency as a parameter."""
    equations = {"x": "y", "y": "-x + eps*F*cos((1 + eps*sigma)*t)"}
    model = system(equations, {"oscillators": [pair()]}, {"F": 0.6, "sigma": 0.8}, "2*pi/(1 + eps*sigma)")
    found = averaged_rates(model, contin.average(model, form="cartesian"), {"x": 0.3 + 0.4j})
    assert found[0] == pytest.approx(-0.8j * (0.3 + 0.4j) - 0.3j, abs=1e-14)
    equations = {"x": "y", "y": "-x + eps*F*cos(Omega*t)"}
    other = system(equations, {"oscillators": [pair()]}, {"F": 0.6, "Omega": 1.008}, "2*pi/Omega")
    near = averaged_rates(other, contin.average(other, form="cartesian"), {"x": 0.3 + 0.4j})
    assert near[0] == pytest.approx(found[0], abs=0.01)


def test_a_sweep_away_from_the_resonance_ends_in_words():
    """A difference of frequencies of more than 5 eps is no detuning of order eps."""
    equations = {"x": "y", "y": "-x + eps*(-0.2*y + cos(Omega*t))"}
    model = system(equations, {"oscillators": [pair()]}, {"Omega": 1.0}, "2*pi/Omega")
    start = contin.equilibrium(contin.average(model, form="cartesian"), {"u1": 0.0, "v1": -5.0})
    branch = contin.continuation(start, "Omega", (0.8, 1.5))
    low, high = branch.columns["Omega"][[0, -1]]
    assert 1 / math.sqrt(1 + 0.05 * 2.05) < low < 1.0  # all rows lie where 5 eps (2 + 5 eps) Omega^2 > |Omega^2 - 1|
    assert 1.0 < high < 1 / math.sqrt(1 - 0.05 * 2.05)
    assert "averaging holds near the resonance" in branch.ends[1].text


RESONANCES = {
    "one to two": ({"x": "y", "y": "-x + eps*(x*z - 0.1*y)", "z": "w", "w": "-4*z + eps*(x^2 + x*y)"}, (1, 2)),
    "one to three": ({"x": "y", "y": "-x + eps*x^2*z", "z": "w", "w": "-9*z + eps*(x^3 - z/(1 + 0.1*x^2))"}, (1, 3)),
    "two to three": ({"x": "y", "y": "-4*x + eps*x^2*z^2", "z": "w", "w": "-9*z + eps*(x^3*z + w*x^2)"}, (2, 3)),
    "stiff": ({"x": "y", "y": "-4*x + eps*(z if z*w > 0 else 0)", "z": "w", "w": "-z + eps*(1 - z^2)*w*x^2"}, (2, 1)),
}  # fmt: skip


@pytest.mark.parametrize("name", RESONANCES)
def test_other_resonances_agree_with_quadrature_and_their_forms_with_each_other(name):
    equations, (m, n) = RESONANCES[name]
    model = system(equations, {"oscillators": [pair(harmonic=m), pair("z", "w", harmonic=n)]})
    cartesian, polar = (contin.average(model, form=form) for form in ("cartesian", "polar"))
    chance = np.random.default_rng(5)
    a, b = chance.uniform(0.4, 1.6, 2) * np.exp(1j * chance.uniform(0, 6, 2))
    expected = mean_rates(model, {"x": a, "z": b}, 1.0)
    np.testing.assert_allclose(averaged_rates(model, cartesian, {"x": a, "z": b}), expected, atol=1e-9)
    turns = np.imag(expected / np.array([a, b]))
    psi = np.angle(b) - n / m * np.angle(a)
    values = polar.default_parameters() | {"r1": abs(a), "r2": abs(b), "psi": psi}
    found = evaluate_all(polar.equations, values)
    growth = np.real(expected * np.conj([a, b])) / np.abs([a, b])
    np.testing.assert_allclose(found, [*growth, turns[1] - n / m * turns[0]], atol=1e-8)
    assert m == 1 or "turn" in [s.name for s in polar.symmetries]


BESIDE = {
    "slow": (
        {"x": "y", "y": "-x + eps*(w*y - x^2*y)",
         "w": "eps*(1 - x^2 - w + (y if x > 0 and y > 0 else 0) + 1/(1 + x^2))"},
        {"oscillators": [pair()], "slow": ["w"]},
    ),
    "platform": (
        {
            "x": "y", "y": "-x + eps*((1 - x^2)*y + V^3 - (-3*X - 0.5*V + x))",
            "X": "V", "V": "-3*X - 0.5*V + x + 0.3*y + 0.7",
        },
        {"oscillators": [pair()], "slaved": ["X", "V"]},
    ),
    "first-order": (
        {"x": "y", "y": "-x + eps*(W + (W if x*y > 0 else 0))", "z": "w",
         "w": "-z + eps*W*z", "W": "-2*W + x - w"},
        {"oscillators": [pair(), pair("z", "w")], "slaved": ["W"]},
    ),
    "walkers": (
        {"x": "y", "y": "-x + eps*(-y + cos(p - 0.3) + cos(q))",
         "p": "1 + eps*(0.2 + y*cos(p))", "q": "2 + eps*x*y*sin(q)"},
        {"oscillators": [pair()], "rotators": [{"phase": "p"}, {"phase": "q", "harmonic": 2}]},
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", BESIDE)
def test_what_moves_beside_the_oscillators_agrees_with_quadrature(name):
    equations, averaging = BESIDE[name]
    model = system(equations, averaging)
    chance = np.random.default_rng(6)
    point = {p["position"]: complex(chance.uniform(0.5, 1.5)) for p in averaging["oscillators"]}
    point |= dict.fromkeys(averaging.get("slow", ()), 0.4) | {"p": 0.9, "q": 2.2}
    expected = mean_rates(model, point, 1.0)
    if name == "walkers":  # phases count from the oscillator's: h theta_1' is taken off
        averaged = contin.average(model)
        values = averaged.default_parameters() | {"r": abs(point["x"]), "p": 0.9, "q": 2.2}
        turn = (expected[0] / point["x"]).imag
        expected = np.real([expected[0], expected[1] - turn, expected[2] - 2 * turn])
        np.testing.assert_allclose(evaluate_all(averaged.equations, values), expected, atol=1e-9)
        return
    averaged = contin.average(model, form="cartesian")
    tolerance = 1e-5 if name == "first-order" else 1e-9  # the quadrature does not know where x y changes sign
    np.testing.assert_allclose(averaged_rates(model, averaged, point), expected, atol=tolerance)


def test_trajectories_of_a_forced_oscillator_with_a_platform_stay_near_the_averaged_ones():
    """Error of order eps on times of order 1/eps: halving eps halves it."""
    equations = {
        "x": "y", "y": "-x + eps*((1 - x^2)*y + F*cos((1 + eps*sigma)*t) + k*X + w)",
        "X": "V", "V": "-3*X - V + x", "w": "eps*(x^2 - w)",
    }  # fmt: skip
    averaging = {"oscillators": [pair()], "slaved": ["X", "V"], "slow": ["w"]}
    gaps = []
    for eps in (0.06, 0.03):
        values = {"F": 0.8, "sigma": 0.3, "k": 0.7, "eps": eps}
        model = system(equations, averaging, values, "2*pi/(1 + eps*sigma)")
        slow = contin.average(model, form="cartesian")
        p = slow.default_parameters()

        def rates(_, u, slow=slow, p=p):
            return evaluate_all(slow.equations, {**p, **dict(zip(slow.state_names, u, strict=True))})

        def motion(t, u, model=model, p=p):
            return evaluate_all(model.equations, {**p, **dict(zip(model.state_names, u, strict=True)), "t": t})

        end = 2.0
        a = solve_ivp(rates, (0, end), [1.0, 0.0, 0.2], "DOP853", rtol=1e-9, atol=1e-11).y[:, -1]
        full = solve_ivp(motion, (0, end / eps), [1.0, 0.0, 0.4, 0.2, 0.2], "DOP853", rtol=1e-8, atol=1e-10).y[:, -1]
        z = complex(full[0], -full[1]) * np.exp(-1j * (1 + eps * 0.3) * end / eps)
        gaps.append(abs(z - complex(a[0], a[1])))
    assert gaps[0] < 0.1
    assert 1.4 < gaps[0] / gaps[1] < 2.8


@pytest.mark.parametrize(
    ("equations", "averaging", "forcing", "words"),
    [
        ({"x": "y", "y": "-x + eps*t"}, {"oscillators": [pair()]}, "2*pi", "elsewhere than under sin and cos"),
        ({"x": "y", "y": "-x + eps*cos(1.5*t)"}, {"oscillators": [pair()]}, "2*pi", "turns 1.5 times"),
        ({"x": "y", "y": "-4*x + eps*cos(t)"}, {"oscillators": [pair()]}, "2*pi", "forcing asks for 1"),
        ({"x": "y", "y": "-x", "w": "x"}, {"oscillators": [pair()], "slow": ["w"]}, None, "slow:` must not move"),
        ({"x": "y", "y": "-x", "W": "-0.001*W+x"}, {"oscillators": [pair()], "slaved": ["W"]}, None, "no faster than"),
        ({"x": "y", "y": "-x", "W": "-W^3+x"}, {"oscillators": [pair()], "slaved": ["W"]}, None, "must be linear"),
        ({"x": "y", "y": "-x", "p": "2"}, {"oscillators": [pair()], "rotators": [{"phase": "p"}]}, None, "`harmonic`"),
        ({"x": "y", "y": "-x", "p": "2"}, {"oscillators": [pair()], "slow": ["x"]}, None, "already has a role"),
        ({"x": "y", "y": "-x", "r": "eps*x^2"}, {"oscillators": [pair()], "slow": ["r"]}, None, "rename r"),
        ({"x": "y", "y": "-x", "w": "0"}, {"oscillators": [pair()], "forcing": 2, "slow": ["w"]}, None, "no forcing"),
    ],
)
def test_what_cannot_be_averaged_is_said(equations, averaging, forcing, words):
    with pytest.raises(InputError, match=words):
        contin.average(system(equations, averaging, forcing=forcing))


def test_the_declarations_survive_writing_and_reading():
    equations, averaging = BESIDE["walkers"]
    model = system(equations, averaging)
    import yaml

    assert contin.load(yaml.safe_load(model.text())) == model
