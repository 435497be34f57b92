"""Second-order averages against known expansions and against the exact branch point of the metronome pair."""

import math
from functools import cache

import numpy as np
import pytest
from oscillating import oscillators
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import contin
from contin.errors import InputError
from contin.model.evaluate import evaluate, evaluate_all
from contin.model.expression import compare, if_, number, symbol
from contin.symbolic.averaging.cells import regions
from contin.symbolic.averaging.cut_turn import CutTurn


@cache
def pair(form):
    return contin.average(contin.load("metronomes/pair"), form=form, order=2)


def test_van_der_pol_frequency_is_one_minus_eps_squared_over_16():
    averaged = contin.average(oscillators("(1 - x^2)*y"), order=2)
    env = {"eps": 0.1, "r": 2.0}
    assert evaluate(averaged.equations[0], env) == pytest.approx(0, abs=1e-15)
    assert evaluate(averaged.observables["frequency_shift"], env) == pytest.approx(-0.1 / 16, rel=1e-13)


def test_duffing_frequency_as_a_function_of_the_energy():
    """x'' + x + eps x^3 = 0 from x = a at rest, against the exact period.

    There A = a, and the averaged amplitude is r = a - eps w. In A' = i eps exp(-it) x^3 the harmonics exp(ikt) with
    k = 2, -2, -4 have the coefficients i a^3 (1, 3, 1)/8, so w = a^3 (1/16 - 3/16 - 1/32) at phase 0.
    """
    averaged = contin.average(oscillators("-x^3"), order=2)
    for eps in (0.02, 0.01):
        a = 1.0
        # energy: x'^2 = (a^2 - x^2)(1 + eps (a^2 + x^2)/2); x = a sin s
        nodes, weights = np.polynomial.legendre.leggauss(60)
        s = (nodes + 1) * math.pi / 4
        period = 4 * np.sum(weights * math.pi / 4 / np.sqrt(1 + eps * a * a * (1 + np.sin(s) ** 2) / 2))
        exact = (2 * math.pi / period - 1) / eps
        r = a - eps * a**3 * (1 / 16 - 3 / 16 - 1 / 32)
        found = evaluate(averaged.observables["frequency_shift"], {"eps": eps, "r": r})
        assert found == pytest.approx(exact, abs=0.5 * eps**2)


@pytest.mark.seldom
def test_the_metronomes_branch_point_moves_with_eps_as_the_exact_one():
    """mu_c(eps) for beta = 0.3, a = 4, b = 1 from multipliers of the full equations, digits as quoted."""
    exact = {0.0: 10.572900507, 0.001: 10.50272674, 0.005: 10.24036985, 0.01: 9.94802926, 0.02: 9.45499633}
    eps = np.array(list(exact))
    slope = np.polynomial.Polynomial.fit(eps, list(exact.values()), 4).deriv()(0.0)  # -71.16
    averaged = pair("polar")
    found = []
    for small in (0.0, 1e-5):
        start = contin.equilibrium(averaged, "in-phase", {"beta": 0.3, "mu": 12, "eps": small})
        (point,) = contin.continuation(start, "mu", (9, 13)).points
        found.append(point.values["mu"])
    assert found[0] == pytest.approx(exact[0.0], abs=1e-9)
    assert (found[1] - found[0]) / 1e-5 == pytest.approx(slope, rel=3e-3)


def period_of(force, eps, low, high):
    """Amplitude and period of the limit cycle by a Poincare map, quadrant by quadrant (the force jumps)."""

    def turn(r):
        state, time = np.array([r, 0.0]), 0.0
        for k, signs in enumerate(((1, -1), (-1, -1), (-1, 1), (1, 1))):

            def motion(_, u, signs=signs):
                return [u[1], -u[0] + eps * force(u[0], u[1], signs)]

            def crossing(t, u, k=k):
                return u[k % 2] if t > 1e-2 else (1.0, -1.0, -1.0, 1.0)[k]

            crossing.terminal = True
            leg = solve_ivp(motion, (0, 6), state, events=crossing, rtol=1e-11, atol=1e-12, method="DOP853")
            state, time = leg.y_events[0][0], time + leg.t_events[0][0]
        return state[0], time

    r = brentq(lambda r: turn(r)[0] - r, low, high, xtol=1e-11)
    return r, turn(r)[1]


@pytest.mark.seldom
def test_piecewise_forces_predict_the_frequency_one_order_better():
    model = oscillators(
        "-alpha*y + s*x^2 + q*x*y + (a*x^3 - b*x^5 if x*y > 0 else 0)",
        parameters={"alpha": 0.5, "a": 4, "b": 1, "s": 0.7, "q": 0.3},
    )

    def force(x, y, signs):
        return -0.5 * y + 0.7 * x * x + 0.3 * x * y + (4 * x**3 - x**5 if signs[0] * signs[1] > 0 else 0.0)

    errors = {1: [], 2: []}
    for eps in (0.02, 0.01):
        _, period = period_of(force, eps, 2.0, 2.4)
        exact = (2 * math.pi / period - 1) / eps
        for order in errors:
            averaged = contin.average(model, order=order)
            env = averaged.default_parameters({"eps": eps})
            r = brentq(lambda r, m=averaged, env=env: evaluate(m.equations[0], {**env, "r": r}), 2.0, 2.4, xtol=1e-13)
            errors[order].append(abs(evaluate(averaged.observables["frequency_shift"], {**env, "r": r}) - exact))
    for order, (coarse, fine) in errors.items():
        assert math.log2(coarse / fine) == pytest.approx(order, abs=0.3)
    assert errors[2][1] < 0.1 * errors[1][1]


@pytest.mark.parametrize("form", ["cartesian", pytest.param("stokes", marks=pytest.mark.long)])
@pytest.mark.seldom
def test_second_order_forms_agree_with_the_polar_one(form):
    curves = []
    for name in ("polar", form):
        averaged = pair(name)
        start = contin.equilibrium(averaged, "in-phase", {"beta": 0.3, "mu": 12, "eps": 0.002})
        (point,) = contin.continuation(start, "mu", (9, 13)).points
        curves.append((point.values["mu"], point.values["r1"]))
    assert curves[1] == pytest.approx(curves[0], rel=1e-9)


@pytest.mark.parametrize("force", ["y*tanh(x) if x > 1 else 0", "tanh(y)"])
def test_forces_beyond_second_order_are_refused(force):
    with pytest.raises(InputError, match="second-order averaging"):
        contin.average(oscillators(force), order=2)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("huygens-clocks", r"takes no kicks: the event where .* crosses zero. Use `order: 1`, or write the kick as a"),
        ("clocks-on-a-beam", r"takes no slaved states, and \w+ is one: use `order: 1`"),
        ("coulomb-platform", r"takes no slaved states, and \w+ is one: use `order: 1`"),
    ],
)
def test_what_has_no_second_order_is_refused_with_what_to_write_instead(name, words):
    with pytest.raises(InputError, match=words):
        contin.average(contin.load(f"oscillators/{name}"), order=2)


def test_a_slow_threshold_is_refused():
    model = contin.Model(
        "sliding",
        states={"x": 1.0, "y": 0.0, "w": 0.5},
        parameters={"eps": 0.01},
        equations={"x": "y", "y": "-x + eps*((1 if x > w else 0) - y)", "w": "eps*(x^2 - w)"},
        averaging={"small": "eps", "oscillators": [{"position": "x", "velocity": "y"}], "slow": ["w"]},
    )
    with pytest.raises(InputError, match="w, which is slow, may multiply a force with conditions, and not stand in"):
        contin.average(model, order=2)


def next_turn(r, eps, force, thresholds):
    """From (r, 0) to the next such point: (its x, the time), leg by leg between the thresholds.

    The force takes (x, y, ahead): conditions are decided at `ahead`, the point of the leg shortly after its start.
    """

    def motion(_, u, ahead):
        return [u[1], -u[0] + eps * force(u[0], u[1], ahead)]

    def event(level):
        def crossing(_t, u, _ahead):
            return u[1] if level is None else u[0] - level

        crossing.terminal = True
        return crossing

    events = [event(level) for level in (None, *thresholds)]
    u, t, small = np.array([r, 0.0]), 0.0, 2e-4
    while True:
        c, s = math.cos(small / 2), math.sin(small / 2)
        ahead = (u[0] * c + u[1] * s, u[1] * c - u[0] * s)
        for end, met in ((t + small, None), (t + 7, events)):
            leg = solve_ivp(motion, (t, end), u, "DOP853", args=(ahead,), events=met, rtol=1e-11, atol=1e-12)
            t, u = leg.t[-1], leg.y[:, -1]
        if len(leg.t_events[0]) and u[0] > 0 and t > 3:
            return u[0], t


PIECEWISE = {
    "thresholds": (
        "-a*y + (k if x > c and y > 0 else 0) + s*x^2 + (b if x^2 < d^2 and y < 0 else 0)",
        {"a": 0.4, "k": 1.5, "c": 0.3, "s": 0.7, "d": 0.5, "b": -0.4},
        lambda x, y, at: (
            -0.4 * y + 0.7 * x * x + 1.5 * (at[0] > 0.3 and at[1] > 0) - 0.4 * (abs(at[0]) < 0.5 and at[1] < 0)
        ),
        (0.3, 0.5, -0.5),
    ),
    "friction and a dead zone": (
        "2*y - y^3 - m*sign(y) - k*max(x - c, 0)",
        {"m": 0.2, "k": 2.0, "c": 0.6},
        lambda x, y, at: 2 * y - y * y * y - 0.2 * np.sign(at[1]) - 2 * (x - 0.6) * (at[0] > 0.6),
        (0.6,),
    ),
}


@pytest.mark.parametrize("name", list(PIECEWISE))
@pytest.mark.seldom
def test_thresholds_have_the_frequency_and_the_multiplier_of_the_simulation_to_order_eps_squared(name):
    text, parameters, force, thresholds = PIECEWISE[name]
    errors = {1: [], 2: []}
    slow = {order: contin.average(oscillators(text, parameters=parameters), order=order) for order in errors}
    for eps in (0.04, 0.02):
        r = brentq(lambda r, eps=eps: next_turn(r, eps, force, thresholds)[0] - r, 1.0, 2.2, xtol=1e-11)
        period, h = next_turn(r, eps, force, thresholds)[1], 2e-3
        a, b, c, d = (next_turn(r + k * h, eps, force, thresholds)[0] for k in (-1, 1, -2, 2))
        exact = np.array([2 * math.pi / period - 1, math.log((8 * (b - a) - (d - c)) / (12 * h)) / period]) / eps
        for order, model in slow.items():
            env = model.default_parameters({"eps": eps})
            rate = lambda r, m=model, env=env: evaluate(m.equations[0], {**env, "r": r})  # noqa: E731
            at = brentq(rate, 1.0, 2.2, xtol=1e-13)
            slope = (rate(at + 1e-5) - rate(at - 1e-5)) / 2e-5
            shift = evaluate(model.observables["frequency_shift"], {**env, "r": at})
            errors[order].append(np.abs(np.array([shift, slope]) - exact))
    for order, (coarse, fine) in errors.items():
        assert math.log2(coarse[0] / fine[0]) == pytest.approx(order, abs=0.2)
    # the exponent of the first system has two terms of order eps^2 that cancel at an eps near by
    assert errors[2][1][1] < 0.05 * errors[1][1][1]


@pytest.mark.seldom
def test_the_second_order_of_thresholds_is_one_function_in_both_forms():
    model = contin.load("metronomes/one-constant")
    polar, cartesian = (contin.average(model, form=form, order=2) for form in ("polar", "cartesian"))
    for r in (0.6, 1.4, 2.9):
        env = polar.default_parameters({"eps": 0.05}) | {"r": r, "u1": 0.6 * r, "v1": 0.8 * r}
        u, v = evaluate_all(cartesian.equations, env)
        assert 0.6 * u + 0.8 * v == pytest.approx(evaluate(polar.equations[0], env), abs=1e-12)


def test_an_orbit_that_just_reaches_a_jump_is_outside_of_the_limits():
    polar = contin.average(contin.load("metronomes/one-constant"), order=2)
    env = polar.default_parameters({"eps": 0.01})
    for far, holds in ((1.005, False), (1.05, True)):
        at = {**env, "r": env["x1"] * far}
        assert (min(evaluate(limit.margin, at) for limit in polar.limits) >= 0) is holds


def test_zero_mean_antiderivative_of_a_jump_at_a_threshold():
    """f = 1 for x > c, with r = 1, c = 1/2: cuts at +-pi/3."""
    (_, region), _ = regions(
        if_(compare(">", symbol("@x"), symbol("c")), number(1), number(0)), number(1), {"c": 0.5}, ("c",)
    )
    turn, _ = CutTurn.of(region)
    pieces = [{(0, 0): (number(k), number(0))} for k in (1, 0)]
    found = turn.antiderivative(pieces)
    env = {"c": 0.5, "@r": 1.0}
    start, middle, stop = (evaluate(p.angle, env) for p in turn.points)
    ends = [(5 + k) * math.pi / 3 for k in (0, 2, 6)]
    assert [start, middle, stop] == pytest.approx(ends)
    for terms, (a, b), slope in ((found[0], (start, middle), 2 / 3), (found[1], (middle, stop), -1 / 3)):
        values = [sum(evaluate(c[0], env) * (phi if m else 1.0) for (m, _), c in terms.items()) for phi in (a, b)]
        # K is odd about the middle of each arc
        assert values == pytest.approx([-slope * (b - a) / 2, slope * (b - a) / 2], abs=1e-14)


def mathieu(ratio, stiffness, drive, parameters, small=0.1):
    """x'' + (ratio^2 + eps * stiffness) x = eps * drive with the time's period pi."""
    return contin.Model(
        "mathieu",
        states={"x": 1.0, "y": 0.0},
        parameters={"eps": small, **parameters},
        equations={"x": "y", "y": f"-{ratio**2}*x - eps*({stiffness})*x + eps*({drive})"},
        forcing={"period": "pi"},
        averaging={
            "small": "eps",
            "forcing": 2,
            "oscillators": [{"position": "x", "velocity": "y", "harmonic": ratio}],
        },
    )


def borders(slow, eps):
    """Values of c at which rest has a zero eigenvalue."""

    def determinant(c):
        at = {"eps": eps, "c": c}
        one, two = (
            np.array(evaluate_all(slow.equations, {**at, "u1": a, "v1": b})) for a, b in ((1.0, 0.0), (0.0, 1.0))
        )
        return float(np.linalg.det(np.array([one, two])))

    grid = np.linspace(-1.4, 1.4, 201)
    values = [determinant(c) for c in grid]
    return [
        brentq(determinant, a, b, xtol=1e-14)
        for a, b, f, g in zip(grid, grid[1:], values, values[1:], strict=False)
        if f * g < 0
    ]


def test_the_tongues_of_mathieu_s_equation_to_second_order():
    """x'' + (a - 2 q cos 2t) x = 0: a_1, b_1 = 1 +- q - q^2/8; a_2, b_2 = 4 + 5 q^2/12, 4 - q^2/12 (DLMF 28.6)."""
    for eps in (0.02, 0.01):
        slow = contin.average(mathieu(1, "c", "2*cos(2*t)*x", {"c": 0.1}, eps), form="cartesian", order=2)
        low, high = borders(slow, eps)
        assert [low, high] == pytest.approx([-1 - eps / 8, 1 - eps / 8], abs=0.2 * eps**2)
        slow = contin.average(mathieu(2, "eps*c", "2*cos(2*t)*x", {"c": 0.1}, eps), form="cartesian", order=2)
        assert borders(slow, eps) == pytest.approx([-1 / 12, 5 / 12], abs=1e-12)


def test_a_forced_piecewise_oscillator_to_second_order():
    """Multipliers of the entrained oscillation, log/(eps T), against the eigenvalues at the averaged equilibrium."""
    gaps = {1: [], 2: []}
    for eps in (0.04, 0.02):
        model = contin.Model(
            "forced",
            states={"x": 1.0, "y": 0.0},
            parameters={"eps": eps},
            equations={"x": "y", "y": "-x + eps*((x if x*y > 0 else 0) - 0.8*y - 0.3*x^3 + cos(t))"},
            forcing={"period": "2*pi"},
            averaging={"small": "eps", "oscillators": [{"position": "x", "velocity": "y"}]},
        )
        found = {order: averaged_exponents(contin.average(model, order=order)) for order in (1, 2)}
        (r, psi), _ = found[2]
        exact = exponents(eps, np.array([r * math.cos(psi), -r * math.sin(psi)]))
        for order, (_, eigenvalues) in found.items():
            gaps[order].append(float(np.max(np.abs(eigenvalues - exact))))
    assert 1.6 < gaps[1][0] / gaps[1][1] < 2.6
    assert 3.2 < gaps[2][0] / gaps[2][1] < 5.0


def averaged_exponents(slow):
    """The equilibrium (r, psi) of a forced polar form, and its eigenvalues."""

    def rates(u):
        return np.array(evaluate_all(slow.equations, slow.default_parameters() | {"r": u[0], "psi": u[1]}))

    u = np.array(contin.equilibrium(slow, {"r": 1.1, "psi": -1.8}).u)
    h = 1e-6
    jacobian = np.array([(rates(u + d) - rates(u - d)) / (2 * h) for d in h * np.eye(2)]).T
    return u, np.sort_complex(np.linalg.eigvals(jacobian).astype(complex))


def exponents(eps, u):
    """log(multiplier)/(eps 2 pi) of the periodic solution near u, by Newton's method on the map of one period."""

    def force(t, u, sign):
        x, y = u
        return [y, -x + eps * ((x if sign > 0 else 0.0) - 0.8 * y - 0.3 * x**3 + math.cos(t))]

    def quarter(t, u, _):
        return u[0] * u[1]

    quarter.terminal = True

    def after(t, u, end, **more):
        sign = 1.0 if u[0] * u[1] + 1e-9 * (u[1] ** 2 - u[0] ** 2) > 0 else -1.0
        run = solve_ivp(force, (t, end), u, "DOP853", args=(sign,), rtol=1e-11, atol=1e-12, **more)
        return run.t[-1], run.y[:, -1]

    def period_map(u):
        t, end = 0.0, 2 * math.pi
        while t < end:
            t, u = after(t, u, min(t + 1e-4, end))
            t, u = after(t, u, end, events=quarter)
        return u

    h = 1e-4
    for _ in range(3):
        jacobian = np.array([(period_map(u + d) - period_map(u - d)) / (2 * h) for d in h * np.eye(2)]).T
        u = u + np.linalg.solve(jacobian - np.eye(2), u - period_map(u))
    return np.sort_complex(np.log(np.linalg.eigvals(jacobian).astype(complex)) / (eps * 2 * math.pi))
