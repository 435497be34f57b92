"""Orbits with jumps by the command: the example with its JSON, which can be read back."""

from pathlib import Path

import jsonschema
import numpy as np
import pytest

import contin
from contin.store.result_schema import RESULT_SCHEMA
from tests.cli.calls import call, results

EXAMPLE = Path(__file__).parents[2] / "examples" / "spiking-neuron.yaml"


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
