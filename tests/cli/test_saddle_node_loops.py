"""From a family of orbits over the homoclinic orbits to a saddle-node to those of a saddle, by a run file."""

import pytest

from tests.cli.calls import call, results, run_file

MORRIS_LECAR = {
    "contin": 1,
    "name": "morris-lecar",  # class I of Rinzel and Ermentrout (1998)
    "states": {"V": 0.0, "w": 0.0},
    "parameters": {"I": 60.0, "phi": 0.0667},
    "definitions": {
        "open": "0.5*(1 + tanh((V + 1.2)/18))",
        "slow": "0.5*(1 + tanh((V - 12)/17.4))",
    },
    "equations": {
        "V": "(I - 4*open*(V - 120) - 8*w*(V + 84) - 2*(V + 60))/20",
        "w": "phi*(slow - w)*cosh((V - 12)/34.8)",
    },
}
PLANE = {"parameter": ["I", "phi"], "range": {"I": [30, 60], "phi": [0.05, 0.4]}}


@pytest.mark.seldom
def test_spikes_at_rest_lose_the_invariant_circle_at_a_non_central_orbit(tmp_path):
    """The fold does not move with phi, the time scale of w: the circle breaks at one value of it."""
    runs = [
        {"name": "rest", "start": {"V": 6, "w": 0.34}, "parameter": "I", "range": [-20, 80]},
        {"name": "spikes", "as": "orbit", "parameter": "I", "range": [30, 80]},
        {"name": "circle", "from": "spikes.HOM1"} | PLANE,
        {"name": "loops", "from": "circle.NCH1"} | PLANE,
    ]
    path = run_file(tmp_path, MORRIS_LECAR, continuations=runs, outputs={"json": "out.json"})
    assert call("run", path, "--quiet") == 0
    rest, spikes, circle, loops = results(tmp_path / "out.json")["branches"]
    (end,) = [e for e in spikes["ends"] if e["reason"] == "homoclinic"]
    fold = max(p["values"]["I"] for p in rest["points"] if p["type"] == "LP")
    assert end["at"]["I"] == pytest.approx(fold, abs=1e-9)
    assert end["saddle_node"] is True
    assert circle["columns"]["I"] == pytest.approx([fold] * len(circle["columns"]["I"]), abs=1e-9)
    assert all(circle["columns"]["saddle_node"])
    (point,) = circle["points"]
    assert (point["type"], point["index"]) == ("NCH", len(circle["columns"]["I"]) - 1)
    assert 0 < point["error"] < 1e-6
    assert loops["parent"] == {"branch": "circle", "label": "NCH1"}
    assert len(loops["columns"]["I"]) > 10
    assert all(value < fold for value in loops["columns"]["I"][1:])
    assert all(value > point["values"]["phi"] for value in loops["columns"]["phi"][1:])
