"""The README keeps what it promises: two commands, and examples that are right."""

import re
import runpy
from pathlib import Path

import pytest

from contin.model.yaml_loader import load_model_text
from contin.model.yaml_reader import read_text
from contin.runs.load import load_run_file, read_run
from contin.runs.plan import make_plan

ROOT = Path(__file__).resolve().parents[2]
TEXT = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```$", TEXT, re.M | re.S)


def test_the_first_two_commands_set_up_and_run_the_example_and_the_tests():
    example, tests = blocks("sh")[:2]
    for command in (example, tests):
        assert command.count("\n") == 1
        assert "-m venv .venv && .venv/bin/pip install" in command
    [file] = re.findall(r"contin run (\S+)", example)
    assert (ROOT / file).is_file()
    assert "-m pytest" in tests


def test_the_models_and_run_files_shown_are_right(tmp_path):
    model, run = blocks("yaml")
    (tmp_path / "brusselator.yaml").write_text(model)
    assert load_model_text(model).name == "brusselator"
    document = read_text(run)
    plan = make_plan(read_run(document.data, document.source), document.source, tmp_path / "run.yaml")
    assert [entry.name for entry in plan.runs] == ["steady"]


@pytest.mark.parametrize("path", sorted((ROOT / "examples").glob("*.yaml")), ids=lambda path: path.stem)
def test_every_example_passes_check(path):
    entry, source = load_run_file(path)
    plan = make_plan(entry, source, path)
    assert plan.runs or plan.diagram


@pytest.mark.seldom
def test_the_python_example_runs(tmp_path, monkeypatch, capsys):
    code = "".join(blocks("python")) + "\nprint(len(fork.points), 'points')"
    monkeypatch.chdir(tmp_path)  # the example writes a picture
    (tmp_path / "example.py").write_text(code)
    runpy.run_path("example.py")
    assert int(capsys.readouterr().out.splitlines()[-1].split()[0]) > 0
