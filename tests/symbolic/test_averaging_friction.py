"""Dry friction with its stick set: the describing function against an exact simulation, and a damped platform."""

import math

import mpmath
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import contin
from contin.errors import InputError
from contin.model.evaluate import evaluate, evaluate_all
from contin.model.expression import symbol
from contin.model.parts import Oscillator
from contin.symbolic.averaging.friction import response_amplitude
from contin.symbolic.averaging.weak import Response

CRITICAL = 1 / math.sqrt(1 + math.pi**2 / 4)


def amplitude(b, level):
    """S of sign(V), V' = Re(b e^it) - level sign(V), by the formula."""
    response = Response(Oscillator("@s", "@z"), {0: (symbol("one"), symbol("zero"))}, symbol("level"))
    values = {"one": 1.0, "zero": 0.0, "level": level, "u": b.real, "v": b.imag}
    found = response_amplitude(response, [(symbol("u"), symbol("v"))], symbol("one"))
    return complex(*(evaluate(part, values) for part in found))


def simulated(m, turns=40):
    """S for B = 1, from instants of sticking and reversal found to 15 digits, after a transient of `turns`."""
    first, last = turns * 2 * math.pi, (turns + 1) * 2 * math.pi
    t, v, total = 0.0, 0.01, 0j
    while t < last:
        if v == 0.0 and abs(math.cos(t)) < m:  # stuck until |cos t| grows to m
            k = math.ceil((t + math.acos(m)) / math.pi + 1e-12)
            stop, slipping = k * math.pi - math.acos(m), 0
            v_next = math.copysign(1e-300, math.cos(stop))
        else:
            slipping = math.copysign(1.0, v if v != 0.0 else math.cos(t))

            def speed(x, t=t, v=v, sign=slipping):
                return v + math.sin(x) - math.sin(t) - m * sign * (x - t)

            x = t + 0.02
            while speed(x) * slipping > 0:
                x += 0.02
            stop, v_next = brentq(speed, max(x - 0.02, t + 1e-6), x, xtol=1e-15), 0.0
        low, high = max(t, first), min(stop, last)
        if high > low:
            total += _integral(high, slipping, m) - _integral(low, slipping, m)
        t, v = stop, v_next
    return total / math.pi


def _integral(t, sign, m):
    """Of sign e^-it while slipping, of (cos t/m) e^-it while stuck."""
    return 1j * sign * np.exp(-1j * t) if sign else (t / 2 + 0.25j * np.exp(-2j * t)) / m


@pytest.mark.parametrize("m", [0.2, 0.5, 0.54, 0.7, 0.9])
def test_the_first_harmonic_of_the_sign_is_that_of_stick_and_slip(m):
    assert amplitude(1.0 + 0j, m) == pytest.approx(
        simulated(m, 40 if m > 0.3 else 80), abs=1e-7 if m < CRITICAL else 1e-12
    )


def test_it_turns_with_the_drive_and_joins_at_its_borders():
    z = 1.7 * np.exp(0.8j)
    assert amplitude(z, 1.0) == pytest.approx(np.exp(0.8j) * amplitude(1.0 + 0j, 1 / 1.7), abs=1e-13)
    for m in (CRITICAL, 1.0):
        assert amplitude(1.0 + 0j, m * (1 - 1e-12)) == pytest.approx(amplitude(1.0 + 0j, m * (1 + 1e-12)), abs=1e-11)
    assert amplitude(1.0 + 0j, 2.0) == pytest.approx(0.5)  # stuck: sign(V) stands for f/level


def model():
    return contin.load("oscillators/coulomb-platform")


def test_the_expected_bifurcation_solves_its_equations():
    a, k = 1.0, 0.5

    def equations(mu, r):
        q = 2 * mu * mpmath.sqrt(1 - (mpmath.pi * mu / (4 * r)) ** 2) / (mpmath.pi * r)
        p = 1 - mu**2 / (2 * r**2)
        return a * (1 - r**2 / 4) - 2 * k * q, 3 * k * q**2 - a * q + k * p**2

    mu, r = mpmath.findroot(equations, (1.4, 1.5))
    [item] = model().expect
    values = model().default_parameters()
    assert evaluate(item.at[0]["mu"], values) == pytest.approx(float(mu), rel=1e-13)
    assert evaluate(item.at[0]["r1"], values) == pytest.approx(float(r), rel=1e-13)


@pytest.mark.parametrize("mu", [0.8, 3.0, 4.5])
def test_simulation_of_the_platform_comes_to_the_averaged_amplitude(mu):
    """Slipping, sticking and slipping, and stuck, in phase; sign(V) is made steep instead of jumping."""
    eps, full = 0.02, model()
    slow = contin.average(full)
    values = slow.default_parameters({"mu": mu})

    def growth(r):
        return evaluate_all(slow.equations, {**values, "r1": r, "r2": r, "psi": 0.0})[0]

    expected = brentq(growth, 1.0, 2.3)

    def motion(_, u):
        x, y, v = u
        push = 2 * x - mu * max(-1.0, min(1.0, v / 1e-3))
        return [y, -x + eps * ((1 - x * x) * y - 0.5 * push), push]

    end = 200.0
    times = np.linspace(end - 4 * math.pi, end, 200)
    run = solve_ivp(motion, (0, end), [1.05 * expected, 0.0, 0.0], "LSODA", t_eval=times, rtol=1e-6, atol=1e-8)
    assert np.mean(np.hypot(run.y[0], run.y[1])) == pytest.approx(expected, abs=eps)


@pytest.mark.parametrize(
    ("equation", "force", "words"),
    [
        ("x - 0.3*V - mu*sign(V)", "V", "does not fit"),
        ("x - mu*sign(V)", "V^2", "linearly only"),
        ("x - mu*sign(V)", "x*sign(V)", "linearly only"),
    ],
)
def test_what_the_describing_function_does_not_cover_is_said(equation, force, words):
    broken = contin.Model(
        "broken",
        states={"x": 1.0, "y": 0.0, "V": 0.0},
        parameters={"eps": 0.01, "mu": 0.4},
        equations={"x": "y", "y": f"-x + eps*({force})", "V": equation},
        averaging={"small": "eps", "oscillators": [{"position": "x", "velocity": "y"}], "slaved": ["V"]},
    )
    with pytest.raises(InputError, match=words):
        contin.average(broken)


def test_the_place_of_a_platform_that_nothing_pulls_back_is_left_out():
    full = contin.Model(
        "free",
        states={"x": 1.0, "y": 0.0, "X": 0.0, "V": 0.0},
        parameters={"eps": 0.01, "mu": 0.4},
        equations={"x": "y", "y": "-x + eps*(y - (x - mu*sign(V)))", "X": "V", "V": "x - mu*sign(V)"},
        averaging={"small": "eps", "oscillators": [{"position": "x", "velocity": "y"}], "slaved": ["X", "V"]},
        observables={"place": "X", "energy": "x^2 + y^2"},
    )
    slow = contin.average(full, form="cartesian")
    assert "energy" in slow.observables
    assert "place" not in slow.observables
    assert "Without place" in slow.description
