"""Orbits of systems whose states are all angles, which return after turns and never to where they were before these."""

import numpy as np
import pytest

from tests.cli.calls import call, results, run_file

ADLER = {
    "contin": 1,
    "name": "adler",
    "states": {"th": {"value": 0.1, "period": "2*pi"}},
    "parameters": {"w": 1.5, "k": 1.0},
    "equations": {"th": "w - k*sin(th)"},
}
PHASES = {
    "contin": 1,
    "name": "phases",
    "states": {name: {"value": value, "period": "2*pi"} for name, value in (("a", 0.1), ("b", 0.5), ("c", 2.0))},
    "parameters": {"K": 1.0, "w": 0.2},
    "equations": {
        "a": "1 + K/3*(sin(b-a) + sin(c-a))",
        "b": "1 + w + K/3*(sin(a-b) + sin(c-b))",
        "c": "1 - w + K/3*(sin(a-c) + sin(b-c))",
    },
}


def ran(folder, model, *runs):
    path = run_file(folder, model, continuations=list(runs), outputs={"json": "out.json"})
    assert call("run", path, "--quiet") == 0
    return results(folder / "out.json")["branches"]


def test_a_single_angle_turns(tmp_path):
    """Adler's equation: T = 2 pi/sqrt(w^2 - k^2), the circle ends on a saddle-node at w = k."""
    run = {"name": "drift", "as": "orbit", "parameter": "w", "range": [0.5, 2], "values": {"period": [5.0]}}
    (drift,) = ran(tmp_path, ADLER, run)
    (five,) = (p for p in drift["points"] if p["type"] == "UZ")
    assert five["values"]["w"] == pytest.approx(np.sqrt(1.0 + (2.0 * np.pi / 5.0) ** 2), abs=1e-8)
    (end,) = (e for e in drift["ends"] if e["reason"] == "homoclinic")
    assert end["at"]["w"] == pytest.approx(1.0, abs=1e-6)
    assert end["saddle_node"] is True


def test_phases_that_are_locked_turn_together_until_they_drift(tmp_path):
    """b - a = a - c = x: w = (K/3)(sin x + sin 2x) has solutions down to K = 3 w/max(sin x + sin 2x)."""
    (locked,) = ran(tmp_path, PHASES, {"name": "locked", "as": "orbit", "parameter": "K", "range": [0.3, 2]})
    cosine = (np.sqrt(33.0) - 1.0) / 8.0  # where cos x + 2 cos 2x = 0
    most = np.sqrt(1.0 - cosine**2) * (1.0 + 2.0 * cosine)
    (fold,) = (p for p in locked["points"] if p["type"] == "LPC")
    assert fold["values"]["K"] == pytest.approx(0.6 / most, abs=1e-8)
    np.testing.assert_allclose(locked["columns"]["period"], 2.0 * np.pi, rtol=1e-7)
