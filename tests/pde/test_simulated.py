"""Integration in time of `kind: pde`, by run files."""

import csv

import pytest
from ruamel.yaml import YAML

from tests.cli.calls import call


@pytest.mark.parametrize("method", ["DOP853", "Radau"])
def test_heat_decays_as_its_first_wave(method, tmp_path):
    """u_t = u_xx, u = 0 at the ends of (0, pi): sin x falls by exp(-t)."""
    document = {
        "contin": 1,
        "model": {
            "contin": 1, "name": "heat", "kind": "pde",
            "domain": {"x": {"from": 0, "to": "pi", "points": 13, "method": "chebyshev"}},
            "fields": {"u": "sin(x)"}, "parameters": {"D": 1},
            "equations": {"u": "D*dxx(u)"}, "boundary": {"all": "u = 0"}, "observables": {"middle": "u(pi/2)"},
        },
        "simulate": [{"name": "decay", "time": 1, "samples": 3, "method": method, "csv": "decay.csv"}],
    }  # fmt: skip
    file = tmp_path / "heat.yaml"
    YAML().dump(document, file)
    assert call("run", str(file), "--quiet") == 0
    rows = list(csv.DictReader((tmp_path / "decay.csv").open()))
    found = [float(row["middle"]) for row in rows]
    assert found == pytest.approx([1.0, 0.6065306597126334, 0.36787944117144233], rel=1e-7)
    assert [float(row["u.max"]) for row in rows] == pytest.approx(found, rel=1e-7)
