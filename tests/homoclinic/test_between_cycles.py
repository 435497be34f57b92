"""Orbits homoclinic to a cycle, in run files: a forced oscillator whose symmetric homoclinic orbit bisection gives."""

import math

import numpy as np
import pytest

from tests.cli.calls import call, results, run_file

FORCED = {  # x'' = x - x^3 + g cos t, with its clock
    "contin": 1, "name": "forced", "states": {"x": -0.025, "y": 0, "a": 1, "b": 0}, "parameters": {"g": 0.05},
    "equations": {
        "x": "y", "y": "x - x^3 + g*a", "a": "a*(1 - a^2 - b^2) - b", "b": "b*(1 - a^2 - b^2) + a",
    },
}  # fmt: skip


def turning_points(g: float) -> list[float]:
    """x > 0 with x'(0) = 0 of the homoclinic orbits with x(-t) = x(t), to the forcing g cos t and to -g cos t.

    The orbit falls to the one or the other side of the cycle near x = 0: sections of 2,000 parts, Runge-Kutta.
    """

    forces = np.array([[g], [-g]])

    def rate(t: float, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return np.array([y, x - x * x * x + forces * math.cos(t)])

    def falls_left(x: np.ndarray) -> np.ndarray:
        u, h, left, done = np.array([x, np.zeros_like(x)]), 0.02, np.zeros(x.shape, bool), np.zeros(x.shape, bool)
        for k in range(1100):
            t = k * h
            a = rate(t, *u)
            b = rate(t + h / 2, *(u + h / 2 * a))
            c = rate(t + h / 2, *(u + h / 2 * b))
            u = u + h / 6 * (a + 2 * b + 2 * c + rate(t + h, *(u + h * c)))
            left |= ~done & (u[0] < -0.3)
            done |= left | ((u[1] > 0.0) & (u[0] > 0.1) & (t > 1.0))
        return left

    low, high = np.full((2, 1), 1.2), np.full((2, 1), 1.7)
    for _ in range(3):
        x = low + (high - low) * np.linspace(0.0, 1.0, 2001)
        last = np.argmin(~falls_left(x), axis=1)[:, None]  # the first that falls to the left
        low, high = np.take_along_axis(x, last - 1, axis=1), np.take_along_axis(x, last, axis=1)
    return [float(x) for x in 0.5 * (low + high).ravel()]


@pytest.mark.seldom
def test_a_run_finds_an_orbit_homoclinic_to_a_cycle_and_follows_it(tmp_path):
    t = 2 * math.pi * np.arange(101) / 100
    rows = np.column_stack([t, -0.025 * np.cos(t), 0.025 * np.sin(t), np.cos(t), np.sin(t)])
    np.savetxt(tmp_path / "cycle.csv", rows, delimiter=",", header="t,x,y,a,b", comments="")
    runs = [
        {"name": "cycle", "samples": "cycle.csv", "parameter": "g", "range": [0.04, 0.06], "values": {"g": [0.05]}},
        {
            "name": "loop", "as": "connection", "start": "cycle.UZ1", "parameter": "g", "range": [0.045, 0.055],
            "values": {"g": [0.05]},
        },
    ]  # fmt: skip
    path = run_file(tmp_path, FORCED, *runs, outputs={"json": "out.json"})
    assert call("run", path, "--quiet") == 0
    loop = results(tmp_path / "out.json")["branches"][1]
    assert (loop["kind"], [end["reason"] for end in loop["ends"]]) == ("connection", ["bound", "bound"])
    values = loop["points"][0]["values"]
    assert values["multiplier"] * values["multiplier2"] == pytest.approx(1.0, abs=1e-6)  # x, y keep areas
    assert values["multiplier.2"] == pytest.approx(math.exp(-4 * math.pi), rel=1e-6)
    largest = max(values["x.max"], -values["x.min"])
    assert min(abs(largest - x) for x in turning_points(0.05)) < 1e-6


@pytest.mark.long
def test_the_curve_of_tangencies_is_melnikovs_line_and_a_file_keeps_its_points(tmp_path):
    """x'' = x - x^3 - d x' + g cos t: a cycle's manifolds touch where g/d = 4 cosh(pi/2) / (3 sqrt(2) pi) + O(d^2)."""
    t = 2 * math.pi * np.arange(101) / 100
    rows = np.column_stack([t, -0.025 * np.cos(t), 0.025 * np.sin(t), np.cos(t), np.sin(t)])
    np.savetxt(tmp_path / "cycle.csv", rows, delimiter=",", header="t,x,y,a,b", comments="")
    damped = {
        **FORCED, "parameters": {"g": 0.05, "d": 0.03}, "equations": {**FORCED["equations"], "y": "x - x^3 - d*y + g*a"}
    }  # fmt: skip
    runs = [
        {"name": "cycle", "samples": "cycle.csv", "parameter": "g", "range": [0.02, 0.06], "values": {"g": [0.05]}},
        {
            "name": "loop", "as": "connection", "start": "cycle.UZ1", "parameter": "g", "range": [0.01, 0.055],
            "direction": "down", "settings": {"stop_at": ["LP"]},
        },
    ]  # fmt: skip
    assert call("run", run_file(tmp_path, damped, *runs, outputs={"save": "a.contin"}), "--quiet") == 0
    touch = {
        "name": "touch", "from": "a.contin:loop.LP1", "parameter": ["d", "g"],
        "range": {"d": [0.029, 0.03], "g": [0, 1]}, "direction": "down", "settings": {"step": 0.05},
    }  # fmt: skip
    assert call("run", run_file(tmp_path, damped, touch, outputs={"json": "out.json"}), "--quiet") == 0
    curve = results(tmp_path / "out.json")["branches"][0]
    assert (curve["locus"], curve["ends"][0]["text"]) == ("LP", "d reached 0.029")
    d, g = np.array(curve["columns"]["d"]), np.array(curve["columns"]["g"])
    np.testing.assert_allclose(g / d, 4 * math.cosh(math.pi / 2) / (3 * math.sqrt(2) * math.pi), rtol=2e-4)
    assert np.ptp(g / d) > 0.0
