"""Orbits with jumps by the command: the example with its JSON, which can be read back."""

from pathlib import Path

import jsonschema
import numpy as np
import pytest

import contin
from contin.store.result_schema import RESULT_SCHEMA
from tests.cli.calls import call, results

EXAMPLE = Path(__file__).parents[2] / "examples" / "spiking-neuron.yaml"


@pytest.mark.seldom
def test_the_example_of_a_spiking_neuron_runs(tmp_path):
    path, out = tmp_path / "neuron.yaml", tmp_path / "out.json"
    path.write_text(EXAMPLE.read_text().replace("range: [3, 20]", "range: [9.5, 12]"))
    assert call("run", path, "--json", out, "--orbits", "--quiet") == 0
    document = results(out)
    jsonschema.validate(document, RESULT_SCHEMA)
    spiking, doubled = document["branches"]
    assert [p["label"] for p in spiking["points"]] == ["PD1"]
    assert [end["reason"] for end in spiking["ends"]] == ["bound", "bound"]
    assert doubled["parent"] == {"branch": "spiking", "label": "PD1"}
    [point] = spiking["points"]
    assert point["multipliers"][0] == [1.0, 0.0]
    assert point["orbit"]["t"][-1] == pytest.approx(point["values"]["period"])
    assert point["orbit"]["v"][-1] == -55.0
    assert np.max(point["orbit"]["v"]) == pytest.approx(30.0)
    again = contin.read(out)["spiking"]["PD1"]
    assert again.orbit.period == pytest.approx(point["values"]["period"])


@pytest.mark.seldom
def test_a_saved_run_keeps_its_orbits_and_its_curve_of_doublings(tmp_path):
    """x -> a x (1 - x) + b at each tick: doublings at (a - 1)^2 = 4 - 4 a b."""
    (tmp_path / "r.yaml").write_text(
        """contin: 1
model:
  name: ticks
  states: {s: 0, x: 0.6}
  parameters: {a: {value: 2.8, range: [2.7, 3.1]}, b: {value: 0, range: [-0.02, 0.02]}}
  equations: {s: 1, x: 0}
  events: [{when: s - 1, direction: up, set: {s: 0, x: a*x*(1 - x) + b}}]
continuations:
  - {name: ticks, as: orbit, parameter: a}
  - {name: flips, from: ticks.PD1, parameter: [a, b], values: {b: [0.01]}}
outputs: {save: r.contin, json: r.json, html: r.html}
"""
    )
    assert call("run", tmp_path / "r.yaml", "--quiet") == 0
    for name in ("r.contin", "r.json"):
        found = contin.read(tmp_path / name)
        assert not found.notes
        assert found["ticks"]["PD1"].orbit.period == pytest.approx(1.0)
        assert len(found["ticks"].kept) > 5
        a, b = found["flips"].columns["a"], found["flips"].columns["b"]
        assert np.abs((a - 1.0) ** 2 + 4.0 * a * b - 4.0).max() < 1e-8
        assert found["flips"]["UZ1"].orbit.period == pytest.approx(1.0)
