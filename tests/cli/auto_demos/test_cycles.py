"""Demos of AUTO-07p: cycles beside simulations and their monodromy matrices."""

from math import cos, pi, sin

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from tests.cli.auto_demos.results import branches_of, result_of


def test_rotations_of_pendula_double_where_their_difference_turns_by_half():
    """pen: the rotation by its return to a = 2 pi, the difference's multipliers along it, by simulation."""

    def rates(_, y, drive):
        a, u, d1, e1, d2, e2 = y
        pull = -(cos(a) + 0.35)
        return [u, -0.1 * u - sin(a) + drive, e1, pull * d1 - 0.1 * e1, e2, pull * d2 - 0.1 * e2]

    def turn(drive, speed):
        once = lambda t, y, drive: y[0] - 2 * pi  # noqa: E731
        once.terminal = True
        found = solve_ivp(
            rates, (0, 50), [0, speed, 1, 0, 0, 1], "DOP853", args=(drive,), events=once, rtol=1e-11, atol=1e-12
        )
        return found.y[:, -1]

    def off(drive):
        speed = brentq(lambda v: turn(drive, v)[1] - v, 2.0, 4.0, xtol=1e-11)
        _, _, d1, e1, d2, e2 = turn(drive, speed)
        return (d1 + 1) * (e2 + 1) - d2 * e1

    branches = branches_of("pen")
    (point,) = [p for p in branches["turns"]["points"] if p["type"] == "PD"]
    assert point["values"]["I"] == pytest.approx(brentq(off, 0.17, 0.19, xtol=1e-10), abs=1e-8)


def test_lorenz_cycles_double_where_their_monodromy_matrix_says_so():
    """lor: the orbit closes, and has the multiplier -1, by Dormand and Prince's method."""
    (branch,) = result_of("lor")["branches"]
    points = [p for p in branch["points"] if p["type"] == "PD"]
    assert len(points) == 2  # of both images under (x, y) -> -(x, y)
    for point in points:
        rho, start = point["values"]["rho"], [point["orbit"][name][0] for name in "xyz"]

        def rates(_, w, rho=rho):
            x, y, z = w[:3]
            matrix = np.array([[-10, 10, 0], [rho - z, -1, -x], [y, x, -8 / 3]])
            flow = [10 * (y - x), rho * x - y - x * z, x * y - 8 / 3 * z]
            return np.concatenate([flow, (matrix @ w[3:].reshape(3, 3)).ravel()])

        whole = np.concatenate([start, np.eye(3).ravel()])
        end = solve_ivp(rates, (0, point["values"]["period"]), whole, "DOP853", rtol=1e-11, atol=1e-11).y[:, -1]
        assert end[:3] == pytest.approx(start, abs=1e-3)
        assert np.abs(np.linalg.eigvals(end[3:].reshape(3, 3)) + 1).min() < 1e-4


def test_a_driven_cell_oscillates_where_the_divergence_vanishes_on_average():
    """ffn: at a Neimark-Sacker point of two equations det M = 1; the response by Dormand and Prince's method."""
    points = [p for branch in result_of("ffn")["branches"] for p in branch["points"] if p["type"] == "NS"]
    assert len(points) == 2  # as the amplitude grows, and as a does
    for point in points:
        amp, a = point["values"]["amp"], point["values"]["a"]

        def rates(t, y, amp=amp, a=a):
            x, y, _ = y
            growth = 3 * (1 - x * x) - 0.8 / 3
            return [3 * (x - x**3 / 3 + y - amp * cos(10 * t)), -(x - a + 0.8 * y) / 3, growth]

        start = [point["orbit"]["x"][0], point["orbit"]["y"][0], 0.0]
        end = solve_ivp(rates, (0, pi / 5), start, "DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
        assert end == pytest.approx(start, abs=1e-6)


def test_a_cycle_of_the_enzyme_has_the_period_of_a_simulation():
    """ph1 at rho = 4, where it attracts."""
    branches = branches_of("ph1")
    (point,) = [p for p in branches["cycles"]["points"] if p["type"] == "UZ"]

    def rates(_, y):
        eaten = 4 * y[0] * y[1] / (1 + y[0] + y[0] ** 2 / 10)
        return [110 - y[0] - eaten, (500 - y[1]) / 5 - eaten]

    up = lambda t, y: y[0] - 20  # noqa: E731
    up.direction = 1
    found = solve_ivp(rates, (0, 120), [20, 100], "LSODA", events=up, rtol=1e-10, atol=1e-10)
    assert np.diff(found.t_events[0])[-3:] == pytest.approx(point["values"]["period"], rel=1e-7)
