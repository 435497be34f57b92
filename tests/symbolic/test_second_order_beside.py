"""Second-order averages with slow states and rotators, against the return map of the equations of motion."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import root

import contin
from contin.model.evaluate import evaluate, evaluate_all

CASES = {
    "slow": (
        "(1 + w - x^2)*y + 0.3*w^2*x + 0.4*x^2 + 0.2*w*x",
        "x^2 - 4*w + 0.5*x*w + x*y",
        lambda x, y, w: (1 + w - x * x) * y + 0.3 * w * w * x + 0.4 * x * x + 0.2 * w * x,
        lambda x, y, w: x * x - 4 * w + 0.5 * x * w + x * y,
        (2.8, 1.0),
    ),
    "slow, driven piecewise": (
        "(1 - w)*y + 0.3*w*x^2 + 0.4*x^2",
        "(x^2 if x > 0.4 else 0) - 4*w + 0.5*x*w + 0.3*w^2*y",
        lambda x, y, w: (1 - w) * y + 0.3 * w * x * x + 0.4 * x * x,
        lambda x, y, w: (x * x if x > 0.4 else 0.0) - 4 * w + 0.5 * x * w + 0.3 * w * w * y,
        (3.9, 1.0),
    ),
    "slow stiffness of a stop": (
        "(1 - x^2)*y + w*max(x - 0.5, 0)",
        "x*y - 2*w + 0.5*x*w + 1",
        lambda x, y, w: (1 - x * x) * y + w * max(x - 0.5, 0.0),
        lambda x, y, w: x * y - 2 * w + 0.5 * x * w + 1,
        (2.05, 0.5),
    ),
    "rotator": (
        "(1 - x^2)*y + 0.6*cos(w) + 0.3*x^2",
        "0.2 + 0.5*x*cos(w) + 0.4*y*sin(w)*cos(w)",
        lambda x, y, w: (1 - x * x) * y + 0.6 * math.cos(w) + 0.3 * x * x,
        lambda x, y, w: 0.2 + 0.5 * x * math.cos(w) + 0.4 * y * math.sin(w) * math.cos(w),
        None,
    ),
}


def returned(z, eps, force, rate, turns):
    """From (x, w) on y = 0, after one turn there again: (x, w - what a rotator has turned), and the time."""

    def motion(_, u):
        x, y, w = u
        return [y, -x + eps * force(x, y, w), turns + eps * rate(x, y, w)]

    def section(_, u):
        return u[1]

    section.terminal, section.direction = True, -1
    more = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-13, "max_step": 0.1}
    first = solve_ivp(motion, (0, 1.0), [z[0], 0.0, z[1]], **more)
    rest = solve_ivp(motion, (1.0, 9.0), first.y[:, -1], events=section, **more)
    x, _, w = rest.y[:, -1]
    return np.array([x, w - 2 * math.pi * turns]), rest.t[-1]


def invariants(jacobian):
    return [np.trace(jacobian), np.linalg.det(jacobian)]


def fixed_point(function, guess, h):
    """Where a function of two variables vanishes, and its derivative by differences of order 4."""
    z = root(function, guess, tol=1e-10).x
    columns = []
    for d in h * np.eye(2):
        columns.append((8 * (function(z + d) - function(z - d)) - function(z + 2 * d) + function(z - 2 * d)) / (12 * h))
    return z, np.array(columns).T


@pytest.mark.parametrize("name", list(CASES))
@pytest.mark.seldom
def test_slow_states_have_the_frequency_and_the_multipliers_of_the_return_map_to_order_eps_squared(name):
    force, rate, f, g, guess = CASES[name]
    turns = 1 if name == "rotator" else 0
    errors = {1: [], 2: []}
    for eps in (0.02, 0.01):
        model = contin.Model(
            "beside",
            states={"x": 1.0, "y": 0.0, "w": 0.5},
            parameters={"eps": eps},
            equations={"x": "y", "y": f"-x + eps*({force})", "w": f"{turns} + eps*({rate})"},
            averaging={
                "small": "eps",
                "oscillators": [{"position": "x", "velocity": "y"}],
                **({"rotators": [{"phase": "w"}]} if turns else {"slow": ["w"]}),
            },
        )
        found, start = {}, guess
        for order in errors:
            slow = contin.average(model, order=order)
            env = slow.default_parameters()

            def rates(u, slow=slow, env=env):
                return np.array(evaluate_all(slow.equations, {**env, "r": u[0], "w": u[1]}))

            u, jacobian = fixed_point(rates, start or stable(rates), 1e-3)
            start = tuple(u)
            shift = evaluate(frequency(slow), {**env, "r": u[0], "w": u[1]}) if not turns else 0.0
            found[order] = np.array([*invariants(jacobian), shift])
        z, jacobian = fixed_point(lambda z, eps=eps: returned(z, eps, f, g, turns)[0] - z, start, 1e-2)
        period = returned(z, eps, f, g, turns)[1]
        exponents = np.log(np.linalg.eigvals(jacobian + np.eye(2)).astype(complex)) / (eps * period)
        shift = 0.0 if turns else (2 * math.pi / period - 1) / eps
        exact = np.array([exponents.sum().real, np.prod(exponents).real, shift])
        for order, values in found.items():
            errors[order].append(np.linalg.norm(values - exact))
    for order, (coarse, fine) in errors.items():
        assert math.log2(coarse / fine) == pytest.approx(order, abs=0.35)
    assert errors[2][1] < 0.2 * errors[1][1]


def frequency(slow):
    return slow.observables["frequency_shift"]


def stable(rates):
    """An attracting equilibrium of the polar form near r = 2."""
    u = np.array([2.0, 1.0])
    for _ in range(4000):
        u = u + 0.02 * rates(u)
    return tuple(u)
