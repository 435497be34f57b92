"""`contin phase` and a run file's `phase:`."""

import json

import jsonschema
import pytest

from contin.store.result_schema import RESULT_SCHEMA
from tests.cli.calls import call, results, run_file

CUSP = {
    "contin": 1,
    "name": "cusp",
    "states": {"x": 0.0},
    "parameters": {"p": 0.0, "q": {"value": -0.5, "range": [-1, 1]}},
    "equations": {"x": "p + q*x - x^3"},
}
PHASE = {"parameter": ["p", "q"], "range": {"p": [-1, 1], "q": [-1, 1.5]}}


@pytest.mark.seldom
def test_the_command_writes_regions_and_a_picture(tmp_path, capsys):
    (tmp_path / "cusp.yaml").write_text(json.dumps(CUSP))
    out, picture = tmp_path / "out.json", tmp_path / "out.png"
    typed = ("phase", tmp_path / "cusp.yaml", "p", "-1", "1", "q", "-1", "1.5", "--json", out, "--plot", picture)
    assert call(*typed) == 0
    document = results(out)
    jsonschema.validate(document, RESULT_SCHEMA)
    phase = document["phase"]
    assert [b["locus"] for b in document["branches"]] == ["LP"]
    assert phase["curves"] == [document["branches"][0]["name"]]
    assert sorted(r["words"] for r in phase["regions"]) == ["1 equilibrium, stable", "2 of 3 equilibria stable"]
    assert phase["borders"] == [{"regions": [0, 1], "curves": phase["curves"]}]
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert "2 of 3 equilibria stable" in capsys.readouterr().out


@pytest.mark.seldom
def test_a_run_file_draws_its_phase_diagram_and_may_go_on_from_its_curves(tmp_path):
    outputs = {"plot": "out.png", "json": "out.json", "save": "out.contin"}
    path = run_file(tmp_path, CUSP, phase=PHASE, outputs=outputs)
    assert call("run", path, "--quiet") == 0
    assert (tmp_path / "out.png").exists()
    assert call("export", tmp_path / "out.contin", tmp_path / "again.json") == 0
    assert results(tmp_path / "again.json")["phase"] == results(tmp_path / "out.json")["phase"]


@pytest.mark.parametrize(
    ("phase", "message"),
    [
        ({"parameter": ["p", "r"]}, "no parameter 'r'"),
        ({"parameter": ["p", "p"]}, "twice"),
        ({"parameter": ["p"]}, "parameter"),
        ({"parameter": ["p", "q"], "range": {"p": [1, -1]}}, "low < high"),
        ({"parameter": ["p", "q"], "range": {"q": [0, 1]}}, "the range of p is missing"),
        ({"parameter": ["p", "q"], "range": {"p": [0, 1]}, "start": "nowhere"}, "no start 'nowhere'"),
        ({"parameter": ["p", "q"], "ranges": {}}, "ranges"),
    ],
)
def test_mistakes_are_named_with_their_place(tmp_path, capsys, phase, message):
    assert call("run", run_file(tmp_path, CUSP, phase=phase)) == 2
    text = capsys.readouterr().err
    assert "phase" in text
    assert message in text


@pytest.mark.parametrize(("option", "curves"), [((), ["HB", "LPC"]), (("--no-orbits",), ["HB"])])
@pytest.mark.seldom
def test_periodic_orbits_take_part_unless_they_are_left_out(tmp_path, capsys, option, curves):
    """The Bautin normal form: between folds and Hopf points a stable orbit surrounds the stable equilibrium."""
    growth = "(p + q*(x^2 + y^2) - (x^2 + y^2)^2)"
    equations = {"x": f"x*{growth} - y", "y": f"y*{growth} + x"}
    bautin = {"contin": 1, "name": "bautin", "states": {"x": 0, "y": 0}, "parameters": {"p": -0.5, "q": 0.5}}
    (tmp_path / "bautin.yaml").write_text(json.dumps({**bautin, "equations": equations}))
    out = tmp_path / "out.json"
    box = ("p", "-0.5", "0.5", "q", "-1", "1")
    assert call("phase", tmp_path / "bautin.yaml", *box, "--json", out, "--plot", tmp_path / "out.png", *option) == 0
    document = results(out)
    jsonschema.validate(document, RESULT_SCHEMA)
    assert sorted(b["locus"] for b in document["branches"]) == curves
    orbits = [s for r in document["phase"]["regions"] for s in r["states"] if s["kind"] == "orbit"]
    assert len(orbits) == (0 if option else 3)
    assert ("1 equilibrium, stable, 1 stable orbit" in capsys.readouterr().out) == (not option)
