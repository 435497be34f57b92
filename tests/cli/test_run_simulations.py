"""`simulate:`, `sweep:` and `scan:` in run files, and run files that come with contin, by name."""

import json

import numpy as np
import pytest
from jsonschema import Draft202012Validator

from contin.cli.main import main
from contin.model.bundled import runs
from contin.store.result_schema import RESULT_SCHEMA
from contin.store.sqlite import load

# x'' + x = -2 d x', from (1, 0): x = exp(-d t) (cos(w t) + (d/w) sin(w t)), w^2 = 1 - d^2
DAMPED = """contin: 1
model:
  contin: 1
  name: damped
  states: {x: 1, y: 0}
  parameters: {d: 0.1}
  equations: {x: y, y: -x - 2*d*y}
"""
# r' = r (m - r^2): the sweep settles on r = sqrt(m), the branch that is drawn beneath it
PITCHFORK = """contin: 1
model:
  contin: 1
  name: pitchfork
  states: {r: 1}
  parameters: {m: 1}
  equations: {r: r*(m - r^2)}
"""


def run(*words):
    """The exit code of `contin run`."""
    with pytest.raises(SystemExit) as stop:
        main(["run", *map(str, words)])
    return stop.value.code


def test_a_simulation_in_a_run_file_is_the_closed_form(tmp_path):
    file = tmp_path / "run.yaml"
    file.write_text(DAMPED + "simulate: [{name: fall, time: 10, samples: 50, parameters: {d: 0.3}, csv: fall.csv}]\n")
    assert run(file, "--json", tmp_path / "out.json", "-q") == 0
    document = json.loads((tmp_path / "out.json").read_text())
    assert not list(Draft202012Validator(RESULT_SCHEMA).iter_errors(document))
    (found,) = document["simulations"]
    t, w = np.array(found["columns"]["t"]), np.sqrt(1 - 0.09)
    exact = np.exp(-0.3 * t) * (np.cos(w * t) + 0.3 / w * np.sin(w * t))
    np.testing.assert_allclose(found["columns"]["x"], exact, atol=1e-8)
    assert (found["name"], found["parameters"], len(t)) == ("fall", {"d": 0.3}, 50)
    assert len((tmp_path / "fall.csv").read_text().splitlines()) == 51


def test_a_sweep_lies_on_the_branch_that_is_drawn_beneath_it(tmp_path):
    file = tmp_path / "run.yaml"
    sweep = "sweep: {parameter: m, range: [0.5, 2], steps: 4, settle: {window: 20, tolerance: 1e-6}}\n"
    outputs = "outputs: {plot: fork.png, save: fork.contin}\n"
    file.write_text(PITCHFORK + "diagram: {parameter: m, range: [0.5, 2]}\n" + sweep + outputs)
    assert run(file, "-q") == 0
    columns = load(tmp_path / "fork.contin")["sweep"]["columns"]  # the store keeps what the run found
    np.testing.assert_allclose(columns["r.mean"], np.sqrt(columns["m"]), rtol=1e-5)
    assert columns["direction"] == [1] * 5 + [-1] * 5
    assert (tmp_path / "fork.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ("simulate: [{start: nobody}]", "8:20: simulate[0].start: damped has no start 'nobody'"),
        ("simulate: [{tim: 3}]", "8:13: simulate[0].tim: unknown key: did you mean 'time'?"),
        ("simulate: [{parameters: {e: 3}}]", "8:26: simulate[0].parameters.e: damped has no parameter 'e'"),
        ("simulate: [{name: a}, {name: a}]", "'a' is already the name of an earlier simulation"),
        ("simulate: [{plot: ../up.png}]", "simulate[0].plot: must stay in or below this file's folder"),
        ("simulate: [{x: z}]", "there is no column 'z'; there are t, x, y"),
        ("sweep: {parameter: m, range: [0, 1]}", "sweep.parameter: damped has no parameter 'm'"),
        ("sweep: {parameter: d}", "the range of d is missing"),
        ("sweep: {parameter: d, range: [0, 1], measures: {s: x + q}}", "sweep.measures.s: "),
        ("scan: {axes: {d: [1]}}\nsweep: {parameter: d}", "a file with `scan:` has no `sweep:`"),
    ],
)
def test_mistakes_are_named_at_their_place(tmp_path, capsys, lines, message):
    file = tmp_path / "run.yaml"
    file.write_text(DAMPED + lines + "\n")
    assert run(file) == 2
    assert message in capsys.readouterr().err


def test_a_scan_file_is_carried_out_by_run(tmp_path):
    file = tmp_path / "scan.yaml"
    scan = "scan: {axes: {d: [0.5, 1]}, classes: {rest: x_max < 1e-3}, settle: {window: 30}}\n"
    file.write_text(DAMPED + scan + "outputs: {csv: scan.csv}\n")
    assert run(file, "-q") == 0
    assert [line.split(",")[2] for line in (tmp_path / "scan.csv").read_text().splitlines()[1:]] == ["rest", "rest"]


def test_a_bundled_run_is_found_by_name_and_writes_into_the_current_folder(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run("one-time-series", "-q") == 0
    assert {path.name for path in tmp_path.iterdir()} == {"one-time-series.png", "one-time-series.csv"}
    assert run("one-time-serie") == 2
    assert "did you mean" in capsys.readouterr().err


@pytest.mark.parametrize("name", runs())
def test_every_bundled_run_is_a_good_file(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as stop:
        main(["check", name])
    assert stop.value.code == 0


def test_the_list_of_models_names_the_bundled_runs_with_their_titles(capsys):
    with pytest.raises(SystemExit):
        main(["models"])
    lines = capsys.readouterr().out.splitlines()
    for name in runs():
        line = next(line for line in lines if line.startswith(f"{name} "))
        assert line.removeprefix(name).strip()
