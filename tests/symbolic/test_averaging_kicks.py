"""Kicks: events that move states by order eps, against jumps summed over one turn and against simulation."""

import math

import numpy as np
import pytest
from oscillating import averaged_rates

import contin
from contin.errors import InputError
from contin.model.evaluate import evaluate, evaluate_all


def kicked(events, equations=None, oscillators=("xy",), parameters=None, **more):
    equations = equations or {n: r for x, y in oscillators for n, r in ((x, y), (y, f"-{x}"))}
    pairs = [{"position": x, "velocity": y} for x, y in oscillators]
    return contin.Model(
        "kicked",
        states=dict.fromkeys(equations, 0.7),
        parameters={"eps": 1e-3, **(parameters or {})},
        equations=equations,
        events=events,
        averaging={"small": "eps", "oscillators": pairs, **more},
    )


def jumps_of_a_turn(model, point, base=1.0):
    """A_i' in slow time: the jumps at the crossings of one unperturbed turn, found by bisection."""
    eps, pairs = 1e-7, model.averaging.oscillators
    values = model.default_parameters({"eps": eps})

    def at(tau):
        env = dict(values)
        for pair in pairs:
            z = point[pair.position] * np.exp(1j * pair.harmonic * tau)
            env[pair.position], env[pair.velocity] = z.real, -pair.harmonic * base * z.imag
        return env

    total = {pair.position: 0j for pair in pairs}
    for event in model.events:
        grid = np.linspace(0.1234, 0.1234 + 2 * math.pi, 2001)
        g = [evaluate(event.when, at(tau)) for tau in grid]
        for k in range(2000):
            if g[k] * g[k + 1] >= 0 or (event.direction != "both" and (g[k] < 0) != (event.direction == "up")):
                continue
            low, high = grid[k], grid[k + 1]
            for _ in range(60):
                middle = 0.5 * (low + high)
                low, high = (middle, high) if evaluate(event.when, at(middle)) * g[k] > 0 else (low, middle)
            env = at(low)
            for pair in pairs:
                h = pair.harmonic * base
                dx, dy = (
                    (evaluate(event.jumps[n], env) - env[n]) / eps if n in event.jumps else 0.0
                    for n in (pair.position, pair.velocity)
                )
                total[pair.position] += np.exp(-1j * pair.harmonic * low) * (dx - 1j * dy / h)
    return np.array([total[pair.position] * base / (2 * math.pi) for pair in pairs])


CASES = {
    "crossing": ([{"when": "x - 0.3", "direction": "up", "set": {"y": "y + eps*(0.4 + x*y)"}}], {}),
    "both ways": ([{"when": "x + 0.2", "direction": "both", "set": {"y": "y + eps*y^3"}}], {}),
    "turning point": ([{"when": "y", "direction": "down", "set": {"x": "x + eps*0.5"}}], {}),
    "two": (
        [{"when": "x", "direction": "up", "set": {"y": "y*sqrt(1 + eps*2/y^2)", "w": "w - eps*0.3 + eps*z*y"}}],
        {"oscillators": ("xy", "zw")},
    ),
    "a common line": (
        [{"when": "x - 2*z - 0.3", "direction": "down", "set": {"y": "y + eps*0.4*y"}}],
        {"oscillators": ("xy", "zw")},
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("form", ["cartesian", "polar"])
def test_kicks_agree_with_the_jumps_of_one_turn(name, form):
    events, more = CASES[name]
    model = kicked(events, **more)
    averaged = contin.average(model, form=form)
    point = {p.position: a for p, a in zip(model.averaging.oscillators, (0.9 + 0.5j, -0.4 + 1.2j), strict=False)}
    expected = jumps_of_a_turn(model, point)
    if form == "cartesian":
        np.testing.assert_allclose(averaged_rates(model, averaged, point), expected, atol=1e-6)
        return
    a = np.array([point[p.position] for p in model.averaging.oscillators])
    values = averaged.default_parameters()
    if a.size == 1:
        growth = evaluate_all(averaged.equations, {**values, "r": abs(a[0])})
        assert growth == pytest.approx(np.real(expected * np.conj(a)) / np.abs(a), abs=1e-6)
        return
    found = evaluate_all(averaged.equations, {**values, "r1": abs(a[0]), "r2": abs(a[1]), "psi": np.angle(a[1] / a[0])})
    turns = np.imag(expected / a)
    assert found == pytest.approx([*np.real(expected * np.conj(a)) / np.abs(a), turns[1] - turns[0]], abs=1e-6)


def test_an_oscillator_three_times_as_fast_is_kicked_three_times_in_a_period():
    equations = {"x": "y", "y": "-x", "z": "w", "w": "-9*z"}
    events = [{"when": "z - 0.2", "direction": "up", "set": {"w": "w + eps*0.7", "y": "y + eps*x"}}]
    model = kicked(events, equations, ("xy", "zw"))
    averaging = {
        "small": "eps",
        "oscillators": [{"position": "x", "velocity": "y"}, {"position": "z", "velocity": "w", "harmonic": 3}],
    }
    model = contin.Model(
        "fast",
        states=dict.fromkeys(equations, 0.5),
        parameters={"eps": 1e-3},
        equations=equations,
        events=events,
        averaging=averaging,
    )
    point = {"x": 0.8 + 0.3j, "z": 0.2 - 0.9j}
    found = averaged_rates(model, contin.average(model, form="cartesian"), point)
    np.testing.assert_allclose(found, jumps_of_a_turn(model, point), atol=1e-6)


def test_below_its_threshold_a_kick_does_not_happen():
    model = kicked([{"when": "x - 0.8", "direction": "up", "set": {"y": "y + eps"}}])
    averaged = contin.average(model)
    assert evaluate_all(averaged.equations, {"eps": 1e-3, "r": 0.79}) == [0.0]
    [above] = evaluate_all(averaged.equations, {"eps": 1e-3, "r": 1.0})
    assert above == pytest.approx(0.6 / (2 * math.pi))  # -sin(phi)/(2 pi) where cos(phi) = 0.8 is crossed upwards


def test_two_clocks_on_a_wall_end_in_opposite_phase():
    """Oliveira and Melo's map psi -> psi + (16 alpha mu/h^2) sin(psi) a turn, and a simulation of the clocks."""
    clocks = contin.load("oscillators/huygens-clocks")
    slow = contin.average(clocks)
    mu, h, alpha, eps = 0.5, 2.0, 1e-6, 0.01
    r = h**2 / (8 * mu)
    values = slow.default_parameters({"alpha": alpha})
    rates = evaluate_all(slow.equations, {**values, "r1": r, "r2": r, "psi": 0.9})
    assert 2 * math.pi * rates[2] == pytest.approx(16 * alpha * mu / h**2 * math.sin(0.9), rel=1e-9)
    alpha = 0.3
    start = {"x1": r, "y1": 0.0, "x2": r * math.cos(2.0), "y2": -r * math.sin(2.0)}
    turns = 30
    run = contin.simulate(clocks, start, {"alpha": alpha, "eps": eps}, time=turns * 2 * math.pi)
    x1, y1, x2, y2 = (run.columns[n][-1] for n in ("x1", "y1", "x2", "y2"))
    psi = np.angle(complex(x2, -y2) / complex(x1, -y1)) % (2 * math.pi)
    from scipy.integrate import solve_ivp

    values = slow.default_parameters({"alpha": alpha})
    state = ("r1", "r2", "psi")
    motion = solve_ivp(
        lambda _, u: evaluate_all(slow.equations, {**values, **dict(zip(state, u, strict=True))}),
        (0, eps * turns * 2 * math.pi), [r, r, 2.0], "DOP853", rtol=1e-8,
    )  # fmt: skip
    assert psi == pytest.approx(motion.y[2, -1], abs=3 * eps)
    assert abs(psi - math.pi) < abs(2.0 - math.pi)
    assert np.hypot(x1, y1) == pytest.approx(motion.y[0, -1], abs=5 * eps)


@pytest.mark.parametrize(
    ("event", "words"),
    [
        ({"when": "x", "set": {"y": "y + 0.1"}}, "is not small"),
        ({"when": "x", "set": {"y": "sqrt(y^2 + eps)"}}, "is not small"),
        ({"when": "y", "set": {"y": "y - eps"}}, "may happen again at once"),
        ({"when": "x^2 - 0.5", "set": {"y": "y - eps"}}, "linear function"),
    ],
)
def test_what_is_no_kick_is_said(event, words):
    with pytest.raises(InputError, match=words):
        contin.average(kicked([event]))


def test_narrow_pulses_become_kicks():
    """A force k/width for c < x < c + width, y > 0 acts in a time width/y: the kick k/y at c, to the width's order."""

    def rate(width):
        force = f"0.7/{width} if 0.2 < x and x < 0.2 + {width} and y > 0 else 0"
        model = contin.Model(
            "pulse",
            states={"x": 0.8, "y": 0.0},
            parameters={"eps": 0.01},
            equations={"x": "y", "y": f"-x + eps*({force})"},
            averaging={"small": "eps", "oscillators": [{"position": "x", "velocity": "y"}]},
        )
        return evaluate_all(contin.average(model).equations, {"eps": 0.01, "r": 0.9})[0]

    kick = kicked([{"when": "x - 0.2", "direction": "up", "set": {"y": "y + eps*0.7/y"}}])
    limit = evaluate_all(contin.average(kick).equations, {"eps": 1e-3, "r": 0.9})[0]
    wide, narrow = (abs(rate(width) - limit) for width in (0.02, 0.01))
    assert wide < 0.02 * limit
    assert 1.8 < wide / narrow < 2.2 if narrow > 1e-12 else wide < 1e-12


def test_clocks_on_a_beam_swing_as_averaged_in_phase_and_in_anti_phase():
    """A slaved beam and kicks at a threshold, simulated with jumps: amplitudes to the order of eps."""
    clocks = contin.load("oscillators/clocks-on-a-beam")
    q, gamma, c, k, friction = 3 / math.pi, 0.3, 0.5, 0.2, 0.5
    for sign, damping in ((1, gamma + k * friction / (1 + friction**2)), (-1, gamma)):
        r = math.sqrt((q**2 + q * math.sqrt(q**2 - 4 * damping**2 * c**2)) / 2) / damping
        start = {"x1": 1.1 * r, "y1": 0.0, "x2": 1.1 * r * sign, "y2": 0.0, "V": 0.0}
        run = contin.simulate(clocks, start, {"k": k, "eps": 0.02}, time=400.0, rtol=1e-7)
        size = np.hypot(run.columns["x1"], run.columns["y1"])[-150:]
        assert np.mean(size) == pytest.approx(r, rel=0.03)
        assert np.sign(run.columns["x1"][-150:] @ run.columns["x2"][-150:]) == sign


@pytest.mark.parametrize("mass", [0.15, pytest.param(0.4, marks=pytest.mark.long)])
@pytest.mark.seldom
def test_clocks_on_a_free_platform_move_as_their_average(mass):
    """In opposite phase: stable beyond mass = A^2/8 - 2 c J/(pi A^2) = .2658."""
    clocks, eps, r = contin.load("oscillators/clocks-and-metronomes"), 0.005, 1.5619
    start = {"x1": r, "y1": 0.0, "x2": -r * math.cos(0.1), "y2": r * math.sin(0.1)}
    values = {"mass": mass, "eps": eps}
    run = contin.simulate(clocks, start, values, time=20 / eps, samples=20)
    begun = {"r1": r, "r2": r, "psi": math.pi + 0.1}
    slow = contin.simulate(contin.average(clocks), begun, values, time=20, samples=20)
    phases = [np.angle(run.columns[f"x{k}"] - 1j * run.columns[f"y{k}"]) for k in (1, 2)]
    psi = (phases[1] - phases[0]) % (2 * math.pi)
    assert np.abs(psi - slow.columns["psi"]).max() < 10 * eps
    away = np.abs(slow.columns["psi"] - math.pi)
    assert (away[-5:].max() > 0.2) == (mass < 0.2658)
