"""Errors of user values on curves of orbits under conditions: beside limit cycles by Dormand and Prince's method."""

import pytest
from scipy.integrate import solve_ivp

from tests.cli.calls import call, results, run_file

SYSTEM = {  # a Hopf point at mu = 0
    "contin": 1, "name": "oscillator", "states": {"x": 0, "y": 0}, "parameters": {"mu": 0.1, "b": 1},
    "equations": {"x": "y", "y": "(mu - b*x^2)*y - x - 0.2*x^2"},
}  # fmt: skip
RUNS = [
    {"name": "rest", "parameter": "mu", "range": [-1, 1]},
    {"name": "cycles", "from": "rest.HB1", "parameter": "mu", "range": [-1, 1.1], "values": {"mu": [1]}},
    {
        "name": "height", "from": "cycles.UZ1", "parameter": "mu", "free": ["b"], "conditions": ["x.max = 1.5"],
        "range": [0.9, 1.3], "values": {"mu": [1.2], "b": [1.6]},
    },
]


def height(mu: float, b: float) -> float:
    """The largest x on the stable cycle, after so many turns that it stays."""

    def rate(_, u):
        return [u[1], (mu - b * u[0] ** 2) * u[1] - u[0] - 0.2 * u[0] ** 2]

    def top(_, u):
        return u[1]

    top.direction = -1
    path = solve_ivp(rate, (0, 40), [1.5, 0], method="DOP853", rtol=1e-12, atol=1e-13, events=top)
    tops = path.y_events[0][:, 0]
    assert abs(tops[-1] - tops[-2]) < 1e-11
    return float(tops[-1])


@pytest.mark.seldom
def test_user_values_state_how_far_a_finer_mesh_moves_the_parameters(tmp_path):
    """Of two parameters one is asked for, and exact; the other's error was stated as 0."""
    path = run_file(tmp_path, SYSTEM, *RUNS, outputs={"json": "out.json"})
    assert call("run", path, "--quiet") == 0
    points = results(tmp_path / "out.json")["branches"][2]["points"]
    assert len(points) == 2
    for point in points:
        mu, b = (point["values"][key] for key in ("mu", "b"))
        by_mu, by_b = (height(mu + 1e-4, b) - height(mu, b)) / 1e-4, (height(mu, b + 1e-4) - height(mu, b)) / 1e-4
        slope = by_b if abs(mu - 1.2) < 1e-9 else by_mu
        assert abs((height(mu, b) - 1.5) / slope) < point["error"] + 1e-10
        assert 0.0 < point["error"] < 1e-6
