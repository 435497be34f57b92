"""Ctrl-C: what was computed is written, also when it is pressed while the files are being written."""

import json
import os
import signal

import pytest

from tests.cli.calls import FOLD, call, run_file

LINE = {"name": "line", "start": "low", "parameter": "p", "range": [-1, 2]}


def pressing(function, times):
    """The function, with Ctrl-C pressed `times` times before it is called."""

    def pressed(*arguments, **options):
        for _ in range(times):
            os.kill(os.getpid(), signal.SIGINT)
        return function(*arguments, **options)

    return pressed


@pytest.mark.parametrize(("times", "code"), [(1, 0), (2, 130)])
def test_the_first_press_while_files_are_written_is_answered_in_words(tmp_path, capsys, monkeypatch, times, code):
    from contin.cli import outputs

    monkeypatch.setattr(outputs, "_write", pressing(outputs._write, times))
    file = run_file(tmp_path, FOLD, LINE, outputs={"json": "r.json"})
    assert call("run", file) == code
    assert "writing what was computed; Ctrl-C again gives it up" in capsys.readouterr().err
    assert (tmp_path / "r.json").exists() == (times == 1)
    if times == 1:
        assert [b["name"] for b in json.loads((tmp_path / "r.json").read_text())["branches"]] == ["line"]


def test_a_press_before_a_run_keeps_the_runs_before_it(tmp_path, monkeypatch):
    from contin.runs.engine import ContinEngine

    begun = []

    def start(self, model, run, parameters, original=ContinEngine.start):
        begun.append(run.name)
        if run.name == "second":
            os.kill(os.getpid(), signal.SIGINT)
        return original(self, model, run, parameters)

    monkeypatch.setattr(ContinEngine, "start", start)
    runs = [LINE, {**LINE, "name": "second"}, {**LINE, "name": "third"}]
    assert call("run", run_file(tmp_path, FOLD, *runs, outputs={"json": "r.json"})) == 1
    document = json.loads((tmp_path / "r.json").read_text())
    assert [b["name"] for b in document["branches"]] == ["line"]
    assert document["notes"] == ["second: stopped by the user", "third skipped: stopped by the user"]
    assert begun == ["line", "second"]


BAUTIN = {
    "contin": 1,
    "name": "bautin",
    "states": {"x": 0, "y": 0},
    "parameters": {"p": -0.5, "q": 0.5},
    "definitions": {"s": "x^2 + y^2", "g": "p + q*s - s^2"},
    "equations": {"x": "x*g - y", "y": "y*g + x"},
}
PHASE = {"parameter": ["p", "q"], "range": {"p": [-0.5, 0.5], "q": [-1, 1]}}


def interrupted_phase(tmp_path, monkeypatch, owner, name, call_number):
    """The results of a phase diagram with Ctrl-C pressed when a function is called for the n-th time."""
    calls, original = [], getattr(owner, name)

    def counted(*arguments, **options):
        calls.append(name)
        if len(calls) == call_number:
            os.kill(os.getpid(), signal.SIGINT)
        return original(*arguments, **options)

    monkeypatch.setattr(owner, name, counted)
    later = {"name": "line", "parameter": "p", "range": [-0.5, 0.5]}
    file = run_file(tmp_path, BAUTIN, later, phase=PHASE, outputs={"json": "r.json", "plot": "r.png"})
    assert call("run", file) == 1
    assert (tmp_path / "r.png").exists()
    document = json.loads((tmp_path / "r.json").read_text())
    assert document["notes"][-1] == "line skipped: stopped by the user"
    return document


def test_a_press_while_curves_are_followed_keeps_those_before_it(tmp_path, monkeypatch):
    from contin.diagram.phase.search import LociSearch

    document = interrupted_phase(tmp_path, monkeypatch, LociSearch, "line", 3)  # of six
    assert [b["locus"] for b in document["branches"]] == ["HB", "LPC"]
    assert document["phase"]["curves"] == [b["name"] for b in document["branches"]]
    assert document["phase"]["regions"] == []
    assert any(note.startswith("stopped by the user: there may be more curves") for note in document["notes"])


def test_a_press_within_a_curve_keeps_its_part(tmp_path, monkeypatch):
    from contin.continuation import trace

    def progress(problem, *arguments, original=trace._progress):
        if len(problem.parameters) == 2:
            os.kill(os.getpid(), signal.SIGINT)
        return original(problem, *arguments)

    monkeypatch.setattr(trace, "_progress", progress)
    assert call("run", run_file(tmp_path, BAUTIN, phase=PHASE, outputs={"json": "r.json"})) == 1
    (part,) = json.loads((tmp_path / "r.json").read_text())["branches"]
    assert part["locus"] == "HB"
    assert part["ends"][0]["reason"] == "stopped"
    assert len(part["columns"]["p"]) > 1


def test_a_press_while_regions_are_looked_at_keeps_those_before_it(tmp_path, monkeypatch):
    from contin.diagram.phase.survey import Survey

    document = interrupted_phase(tmp_path, monkeypatch, Survey, "_visit_row", 2)
    regions = document["phase"]["regions"]
    assert 0 < len(regions) < 3
    assert sum(r["area"] for r in regions) < 1.0
    assert all(pair < len(regions) for border in document["phase"]["borders"] for pair in border["regions"])
    left = 3 - len(regions)
    assert f"stopped by the user: {left} of 3 regions were not looked at" in document["notes"]
