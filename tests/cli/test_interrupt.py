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
