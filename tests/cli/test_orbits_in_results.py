"""`--orbits`: the orbit at every labelled point of families and of curves of orbits, against a closed form."""

import jsonschema
import numpy as np
import pytest

from contin.store.result_schema import RESULT_SCHEMA
from tests.cli.calls import call, results, run_file

# r' = r (b1 + b2 r^2 - r^4), angle' = 1: orbits fold at b1 = -b2^2/4, where r^2 = b2/2; period 2 pi
BAUTIN = {
    "contin": 1,
    "name": "bautin",
    "states": {"x": 0, "y": 0},
    "parameters": {"b1": -0.5, "b2": 0.8},
    "definitions": {"r": "x^2 + y^2"},
    "equations": {"x": "b1*x - y + x*(b2*r - r^2)", "y": "x + b1*y + y*(b2*r - r^2)"},
}
RUNS = (
    {"name": "line", "parameter": "b1", "range": [-1, 1]},
    {"name": "beat", "from": "line.HB1", "parameter": "b1", "range": [-1, 1]},
    {
        "name": "folds", "from": "beat.LPC1", "parameter": ["b1", "b2"], "range": {"b1": [-1, 1], "b2": [0.1, 1]},
        "values": {"b2": [0.5]},
    },
)  # fmt: skip


def test_labelled_orbits_are_written_where_they_are_asked_for(tmp_path):
    path, out = run_file(tmp_path, BAUTIN, *RUNS), tmp_path / "out.json"
    assert call("run", path, "--json", out, "--orbits", "--quiet") == 0
    document = results(out)
    jsonschema.validate(document, RESULT_SCHEMA)
    branches = {branch["name"]: branch for branch in document["branches"]}
    for name, type_, b2 in (("beat", "LPC", 0.8), ("folds", "UZ", 0.5)):
        [point] = [p for p in branches[name]["points"] if p["type"] == type_]
        orbit = {key: np.array(values) for key, values in point["orbit"].items()}
        assert set(orbit) == {"t", "x", "y"}
        assert orbit["t"][0] == 0.0
        assert orbit["t"][-1] == pytest.approx(2 * np.pi, rel=1e-8)
        assert orbit["x"] ** 2 + orbit["y"] ** 2 == pytest.approx(b2 / 2, rel=1e-6)
    assert "orbit" not in branches["line"]["points"][0]


def test_orbits_are_left_out_otherwise(tmp_path):
    path, out = run_file(tmp_path, BAUTIN, *RUNS[:2]), tmp_path / "out.json"
    assert call("run", path, "--json", out, "--quiet") == 0
    found = [p for branch in results(out)["branches"] for p in branch["points"]]
    assert found
    assert all("orbit" not in p for p in found)
