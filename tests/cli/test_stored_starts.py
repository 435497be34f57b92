"""`from: FILE.contin:BRANCH.LABEL`: a run goes on from what an earlier one saved."""

import json
import subprocess
import sys

import pytest

from contin.machine import environment
from tests.cli.calls import call

MODEL = """
contin: 1
name: bautin
states: {x: 0, y: 0}
parameters: {mu: -2, b: 2}
definitions: {r: mu + b*(x^2 + y^2) - (x^2 + y^2)^2}
equations: {x: x*r - y, y: x + y*r}
"""
FIRST = """
contin: 1
model: bautin.yaml
continuations:
  - {name: line, parameter: mu, range: [-2, 1]}
  - {name: cycles, from: line.HB1, parameter: mu, range: [-2, 1]}
  - {name: folds, from: cycles.LPC1, parameter: [mu, b], range: {mu: [-3, 1], b: [0.1, 3]}}
outputs: {save: first.contin, json: first.json}
"""
SECOND = """
contin: 1
model: bautin.yaml
continuations:
  - {name: cycles, from: first.contin:line.HB1, parameter: mu, range: [-2, 1]}
  - {name: folds, from: first.contin:cycles.LPC1, parameter: [mu, b], range: {mu: [-3, 1], b: [0.1, 3]}}
outputs: {json: second.json}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("stored")
    (place / "bautin.yaml").write_text(MODEL)
    (place / "first.yaml").write_text(FIRST)
    (place / "second.yaml").write_text(SECOND)
    if environment.fixed():
        assert call("run", place / "first.yaml", "--quiet") == 0
    else:  # the command fixes numpy and the libraries under it: this process computes with others
        subprocess.run([sys.executable, "-m", "contin", "run", "first.yaml", "--quiet"], cwd=place, check=True)
    return place


def refused(folder, capsys, text, *options):
    (folder / "wrong.yaml").write_text(text)
    assert call("run", folder / "wrong.yaml", *options) == 2
    return capsys.readouterr().err


@pytest.mark.seldom
def test_another_process_goes_on_with_the_same_digits(folder):
    subprocess.run([sys.executable, "-m", "contin", "run", "second.yaml", "--quiet"], cwd=folder, check=True)
    first, second = (json.loads((folder / f"{name}.json").read_text())["branches"] for name in ("first", "second"))
    for one, other in zip(first[1:], second, strict=True):
        assert one["columns"] == other["columns"]
        for point, again in zip(one["points"], other["points"], strict=True):
            assert {**point, "orbit": None} == {**again, "orbit": None}  # which only a file to be saved keeps
    assert second[0]["parent"] == {"branch": "first.contin:line", "label": "HB1"}


@pytest.mark.parametrize(
    ("written", "said"),
    [
        ("../first.contin:line.HB1", "in or below this file's folder"),
        ("/tmp/first.contin:line.HB1", "relative to this file's folder"),
        ("none.contin:line.HB1", "there is no file 'none.contin'"),
        ("bad.contin:line.HB1", "not a contin result file"),
        ("first.contin:lime.HB1", "did you mean 'line'?"),
        ("first.contin:line.HB2", "has no point HB2 (points: HB1)"),
        ("first.contin:line", "FILE.contin:NAME.LABEL"),
    ],
)
def test_what_is_not_there_is_said_with_its_place(folder, capsys, written, said):
    (folder / "bad.contin").write_text("not a database")
    error = refused(folder, capsys, SECOND.replace("first.contin:line.HB1", f"'{written}'"))
    assert "wrong.yaml:5:" in error
    assert "continuations[0].from" in error
    assert said in error


def test_other_equations_and_other_values_are_refused(folder, capsys):
    (folder / "other.yaml").write_text(MODEL.replace("x*r - y", "x*r - 2*y"))
    assert "other equations" in refused(folder, capsys, SECOND.replace("bautin.yaml", "other.yaml"))
    assert "the point has b = 2, and this run sets b = 1" in refused(folder, capsys, SECOND, "--set", "b=1")


def test_no_output_overwrites_the_results_that_are_read(folder, capsys):
    before = (folder / "first.contin").read_bytes()
    error = refused(folder, capsys, SECOND.replace("json: second.json", "save: first.contin"))
    assert "first.contin" in error
    assert (folder / "first.contin").read_bytes() == before
