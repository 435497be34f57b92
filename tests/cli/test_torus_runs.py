"""Tori in a run file."""

from pathlib import Path

import numpy as np
import pytest

from tests.cli.calls import call, results, run_file

RING = {
    "contin": 1, "name": "ring", "kind": "map", "states": {"x": 0.0, "y": 0.0}, "parameters": {"a": -0.1, "b": 0.0},
    "equations": {
        "x": "(1 + a + b - x^2 - y^2)*(cos(0.71)*x - sin(0.71)*y)",
        "y": "(1 + a + b - x^2 - y^2)*(sin(0.71)*x + cos(0.71)*y)",
    },
}  # fmt: skip
LINE = {"name": "line", "start": {"x": 0}, "parameter": "a", "range": [-0.1, 0.2]}
TORUS = {"name": "beats", "from": "line.NS1", "as": "torus", "parameter": "a", "range": [-0.1, 0.2]}
EXAMPLE = Path(__file__).parents[2] / "examples" / "coupled-van-der-pol.yaml"


def test_a_run_follows_the_circle_of_a_map_in_any_parameter(tmp_path):
    other = TORUS | {"name": "b", "parameter": "b", "range": [-0.1, 0.1]}
    outputs = {"json": "out.json", "plot": "out.png", "html": "out.html", "save": "out.contin"}
    path = run_file(tmp_path, RING, continuations=[LINE, TORUS, other], outputs=outputs)
    assert call("run", path, "--quiet") == 0
    _, first, second = results(tmp_path / "out.json")["branches"]
    for branch, name, last in ((first, "a", 0.2), (second, "b", 0.1)):
        assert (branch["kind"], branch["parameters"]) == ("torus", [name])
        assert branch["parent"] == {"branch": "line", "label": "NS1"}
        assert [end["reason"] for end in branch["ends"]] == ["start", "bound"]
        assert branch["columns"]["x.max"][-1] == pytest.approx(np.sqrt(last), abs=1e-7)
    assert (tmp_path / "out.png").stat().st_size > 1000
    assert call("export", tmp_path / "out.contin", tmp_path / "again.json") == 0
    again = results(tmp_path / "again.json")["branches"][1]
    assert again["columns"] == first["columns"]
    assert again["ends"] == first["ends"]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"from": None}, "from: NAME.NS1"), ({"parameter": ["a", "b"]}, "one `parameter`"),
        ({"values": {"a": [0.1]}}, "`values`"), ({"as": "tori"}, "torus"),
    ],
)  # fmt: skip
def test_mistakes_are_named(tmp_path, capsys, change, message):
    entry = {key: value for key, value in (TORUS | change).items() if value is not None}
    assert call("run", run_file(tmp_path, RING, continuations=[LINE, entry])) == 2
    assert message in capsys.readouterr().err


def test_a_label_that_bears_no_torus_is_skipped(tmp_path, capsys):
    fold = RING | {"equations": {"x": "x + a - x^2", "y": "y/2"}}
    line = {"name": "line", "start": {"x": 0.4}, "parameter": "a", "range": [-0.1, 0.2]}
    fold["parameters"] = {"a": 0.1, "b": 0.0}
    path = run_file(tmp_path, fold, continuations=[line, TORUS | {"from": "line.LP1"}], outputs={"json": "out.json"})
    assert call("run", path) == 1
    assert any("NS" in note for note in results(tmp_path / "out.json")["notes"])


@pytest.mark.long
def test_the_example_of_van_der_pol(tmp_path):
    (tmp_path / "run.yaml").write_text(EXAMPLE.read_text("utf-8"), "utf-8")
    assert call("run", tmp_path / "run.yaml", "--quiet") == 0
    _, beats = results(tmp_path / "coupled-van-der-pol.json")["branches"]
    assert beats["ends"][1]["reason"] == "bound"
    assert max(beats["columns"]["error"]) < 1e-5
    assert all(beats["columns"]["stable"])
