"""What a run file asks for is obeyed or refused: which parameters a run from a label solves for, settings, keys."""

import numpy as np
import pytest

from tests.cli.calls import call, results, run_file

DECAY = {  # x = exp(-k t): the end is R after the time T, so T = -log(R)/k
    "contin": 1, "name": "decay", "kind": "bvp", "time": {"name": "t", "from": 0, "to": 1}, "states": {"x": 1},
    "parameters": {"T": {"value": 0.01, "range": [0, 9]}, "k": {"value": 1, "range": [0.1, 2]}, "R": 1},
    "equations": {"x": "-T*k*x"}, "conditions": ["x(start) = 1", "x(end) = R"],
}  # fmt: skip
SHRINKING = {"name": "line", "parameter": "T", "free": ["R"], "range": [0, 3], "values": {"T": [2]}}


def test_a_run_from_a_user_value_solves_for_the_parameters_that_it_names(tmp_path):
    slower = {"name": "slower", "from": "line.UZ1", "parameter": "k", "free": ["T"], "range": [0.5, 2]}
    out = tmp_path / "out.json"
    assert call("run", run_file(tmp_path, DECAY, SHRINKING, slower), "--json", out) == 0
    branch = results(out)["branches"][1]
    assert branch["free"] == ["T"]
    columns = {name: np.array(column) for name, column in branch["columns"].items()}
    np.testing.assert_allclose(columns["T"], 2.0 / columns["k"], rtol=1e-7)


@pytest.mark.parametrize(
    ("run", "told"),
    [
        ({"from": "line.UZ1", "parameter": "k", "free": ["T", "R"]}, "free"),
        ({"from": "line.UZ1", "parameter": "T", "free": ["T"]}, "T varies in this run already"),
    ],
)
def test_too_many_free_parameters_are_refused(run, told, tmp_path, capsys):
    assert call("run", run_file(tmp_path, DECAY, SHRINKING, {"name": "more", **run})) == 2
    assert told in capsys.readouterr().err


def test_a_branch_that_is_born_keeps_its_parents_free_parameters_or_says_so(tmp_path):
    """x'' = -p x, x(0) = x(1) = 0: another parameter q does nothing but be determined, q = mean(x)."""
    model = {
        "contin": 1, "name": "string", "kind": "bvp", "time": {"name": "t", "from": 0, "to": 1},
        "states": {"x": 0, "v": 0}, "parameters": {"p": {"value": 5, "range": [5, 15]}, "q": 0, "s": 0},
        "equations": {"x": "v", "v": "-p*(x - x^3) + 0*s"},
        "conditions": ["x(start) = 0", "x(end) = 0", "mean(x^2) = q + s"],
    }  # fmt: skip
    line = {"name": "line", "parameter": "p", "free": ["q"], "range": [5, 15]}
    born = {"name": "born", "from": "line.BP1", "parameter": "p", "free": ["s"], "range": [5, 15]}
    out = tmp_path / "out.json"
    assert call("run", run_file(tmp_path, model, line, born), "--json", out) == 1
    assert any("free parameters of its parent (q)" in note for note in results(out)["notes"])
    kept = {**born, "free": ["q"]}
    assert call("run", run_file(tmp_path, model, line, kept), "--json", out) == 0
    assert results(out)["branches"][1]["free"] == ["q"]


@pytest.mark.parametrize(
    ("run", "told"),
    [
        ({"parameter": "T", "free": ["R"], "settings": {"method": "shooting"}}, "are solved by collocation"),
        ({"parameter": "T", "free": ["R"], "settings": {"stop_at": ["LP1"]}}, "'LP1' is no type of special point"),
        ({"parameter": "T", "free": ["R"], "settings": {"stop_at": ["hopf"]}}, "known: EX, UZ"),
        ({"as": "manifold", "of": {"x": 0}, "length": 3, "values": {"T": [1]}}, "leave out `values`"),
        ({"as": "manifold", "of": {"x": 0}, "length": 3, "settings": {"steps": 9}}, "leave out `settings`"),
    ],
)
def test_what_a_run_would_read_past_is_refused(run, told, tmp_path, capsys):
    assert call("run", run_file(tmp_path, DECAY, run)) == 2
    assert told in capsys.readouterr().err
