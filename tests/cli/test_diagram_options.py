"""`contin diagram` with budgets, settings and files; completion in shells."""

import json

import pytest

from contin.cli.main import main
from tests.cli.calls import call

CALL = ["diagram", "classics/brusselator", "B", "0", "4"]


def test_a_diagram_without_orbits_writes_what_it_is_asked_for_and_tells_of_each_branch(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    files = ["--save", "b.contin", "--html", "b.html", "--json", "b.json"]
    settings = ["--settings", "max_step=0.05", "--settings", "steps=400", "--budget", "seconds=60"]
    assert call(*CALL, "--no-orbits", *files, *settings) == 0
    assert {path.name for path in tmp_path.iterdir()} == {"b.contin", "b.html", "b.json"}
    (line,) = json.loads((tmp_path / "b.json").read_text())["branches"]
    assert [point["label"] for point in line["points"]] == ["HB1"]
    assert len(line["columns"]["B"]) > 20
    assert "start: " in capsys.readouterr().err


def test_the_budget_ends_a_diagram_in_words(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    call(*CALL, "--budget", "branches=1", "--json", "b.json", "-q")
    document = json.loads((tmp_path / "b.json").read_text())
    assert [branch["name"] for branch in document["branches"]] == ["start"]
    assert any("HB1" in note for note in document["notes"])


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--budget", "branch=1"], "did you mean 'branches'?"),
        (["--budget", "many"], "write --budget NAME=VALUE, such as --budget branches=20"),
        (["--settings", "max_step=-1"], "expected a positive number"),
        (["--save", "b.json"], "must end in .contin"),
        (["--html", "b.png"], "must end in .html"),
    ],
)
def test_wrong_options_of_a_diagram_are_bad_input(options, words, capsys):
    assert call(*CALL, *options) == 2
    assert words in capsys.readouterr().err


@pytest.mark.parametrize(
    ("shell", "typed"),
    [
        ("bash", {"COMP_WORDS": "contin dia", "COMP_CWORD": "1"}),
        ("zsh", {"_TYPER_COMPLETE_ARGS": "contin dia"}),
        ("fish", {"_TYPER_COMPLETE_ARGS": "contin dia", "_TYPER_COMPLETE_FISH_ACTION": "get-args"}),
    ],
)
def test_shells_complete_commands(shell, typed, monkeypatch, capsys):
    monkeypatch.setenv("_CONTIN_COMPLETE", f"complete_{shell}")
    for name, value in typed.items():
        monkeypatch.setenv(name, value)
    with pytest.raises(SystemExit, match="0"):
        main([])
    assert "diagram" in capsys.readouterr().out
