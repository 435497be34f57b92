"""Homoclinic orbits of two turns by Lin's method, in a run file."""

import json

import numpy as np
import pytest

import contin
from tests.cli.calls import call, results, run_file

NERVE = {  # travelling pulses of the FitzHugh-Nagumo equations, of AUTO's demo fnb
    "contin": 1, "name": "nerve", "states": {"u": 0, "v": 0, "w": 0},
    "parameters": {"c": 0.27, "a": 0.0, "eps": 0.0025}, "starts": {"rest": {"u": 0}},
    "equations": {"u": "v", "v": "c*v + u*(u - a)*(u - 1) + w", "w": "eps/c*u"},
}  # fmt: skip
PULSE = {
    "name": "pulse", "as": "connection", "start": "rest", "parameter": ["c", "a"],
    "range": {"c": [0.1, 0.4], "a": [-1e-5, 1e-5]}, "values": {"a": [0]},
}  # fmt: skip
TWO = {
    "name": "two", "as": "connection", "from": "pulse.UZ1", "pulses": 2, "parameter": ["c", "a"],
    "range": {"c": [0.1, 0.4], "a": [-1e-6, 1e-6]}, "values": {"a": [0]},
}  # fmt: skip


@pytest.mark.seldom
def test_a_run_switches_to_an_orbit_of_two_turns(tmp_path):
    """Two pulses like the single one, at the same speed but for exp(-time between them) (Shilnikov)."""
    path = run_file(tmp_path, NERVE, PULSE, TWO, outputs={"json": "out.json"})
    assert call("run", path, "--quiet", "--orbits") == 0
    one, two = results(tmp_path / "out.json")["branches"]
    assert (two["kind"], two["locus"]) == ("locus", "HOM")
    turns = []
    for branch in (one, two):
        u = np.array(branch["points"][0]["orbit"]["u"])
        turns.append(int(np.sum((u[:-1] < 0.2) & (u[1:] >= 0.2))))
    assert turns == [1, 2]
    assert two["points"][0]["values"]["c"] == pytest.approx(one["points"][0]["values"]["c"], abs=1e-9)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"from": None, "start": "rest"}, "give `from`"),
        ({"as": None}, "write `as: connection`"),
        ({"pulses": 1}, "pulses"),
    ],
)
def test_mistakes_are_named(tmp_path, capsys, change, message):
    entry = {key: value for key, value in (TWO | change).items() if value is not None}
    assert call("run", run_file(tmp_path, NERVE, PULSE, entry)) == 2
    assert message in capsys.readouterr().err


@pytest.mark.long
def test_gaps_vanish_half_a_turn_of_the_spiral_apart(tmp_path):
    """Times between pulses differ by pi/omega, omega the saddle-focus's frequency (Oldeman and others 2003)."""
    path = tmp_path / "nerve.json"
    path.write_text(json.dumps(NERVE))
    model = contin.load(str(path))
    curve = contin.continuation(contin.connection(model, "rest"), ("c", "a"), PULSE["range"], values={"a": [0]})
    start = contin.connection(curve["UZ1"], pulses=2)
    zeros = start._zeros(start._start(), 0, 1)
    times = [next(zeros).arcs[1].period for _ in range(2)]
    c = curve["UZ1"].values["c"]
    omega = np.abs(np.linalg.eigvals([[0, 1, 0], [0, c, 1], [0.0025 / c, 0, 0]]).imag).max()
    assert times[0] - times[1] == pytest.approx(np.pi / omega, rel=1e-3)
    three = contin.connection(curve["UZ1"], pulses=3).locus(("c", "a"))[0]
    u = three.problem.profile(three.z).u[:, 0]
    assert int(np.sum((u[:-1] < 0.2) & (u[1:] >= 0.2))) == 3
