"""Bad input: exit code 2, one message that says where, what, and what to write instead; no traceback, no output."""

import json

import pytest

from tests.cli.calls import FOLD, call, run_file

GOOD = """\
contin: 1
model: metronomes/pair
continuations:
  - {name: line, start: in-phase, parameter: mu, range: [0.05, 8]}
"""


@pytest.fixture
def message(tmp_path, capsys):
    """The message for a run file of this text; nothing may have been written or printed otherwise."""

    def attempt(text, *arguments):
        path = tmp_path / "case.yaml"
        path.write_text(text)
        out = tmp_path / "out.json"
        assert call("run", path, "--json", out, *arguments) == 2
        printed = capsys.readouterr()
        assert printed.out == ""
        assert "Traceback" not in printed.err
        assert not out.exists()
        assert [file.name for file in tmp_path.iterdir()] == ["case.yaml"]
        return printed.err.replace(f"{path}", "case.yaml")

    return attempt


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("contin: 1\n", "", "case.yaml:1:1: the format version is missing; add `contin: 1`"),
        ("contin: 1", "contin: 7", "case.yaml:1:9: contin: format version 7 is newer"),
        (GOOD[GOOD.index("continuations") :], "", "case.yaml:1:1: there is nothing to run; write `continuations:`,"),
        (GOOD[GOOD.index("continuations") :], "continuations: []\n", "case.yaml:1:1: there is nothing to run;"),
        ("model: metronomes/pair\n", "", "'model' is missing; add `model: NAME`"),
        (
            "metronomes/pair",
            "metronomes/pear",
            "case.yaml:2:8: model: no model is called 'metronomes/pear': did you mean",
        ),
        ("continuations", "continuation", "case.yaml:3:1: continuation: unknown key: did you mean 'continuations'"),
        (
            "parameter: mu",
            "parameter: mi",
            "case.yaml:4:46: continuations[0].parameter: pair has no parameter 'mi': did",
        ),
        ("parameter: mu", "paramter: mu", "continuations[0].paramter: unknown key: did you mean 'parameter'"),
        ("name: line", "parameters: {mu: 1}", "unknown key: values of parameters stand in the start"),
        ("name: line", "parameters: [mu, beta]", "unknown key: a curve in two parameters is written `parameter: "),
        (
            "parameter: mu",
            "parameter: [mu, beta]",
            "two parameters need a point to start from; write `from: NAME.LABEL`",
        ),
        (
            "start: in-phase",
            "start: inphase",
            "continuations[0].start: pair has no start 'inphase': did you mean 'in-phase'",
        ),
        (
            "start: in-phase",
            "start: {x3: 1}",
            "continuations[0].start.x3: pair has no state 'x3': did you mean 'x",
        ),
        ("start: in-phase", "start: {x1: 2*q}", "continuations[0].start.x1: unknown name 'q'"),
        ("start: in-phase", "from: line", "continuations[0].from: expected NAME.LABEL, such as line.BP1, got 'line'"),
        ("start: in-phase", "start: in-phase, from: a.BP1", "has both `start` and `from`; keep one of them"),
        ("[0.05, 8]", "[[0, 8], [0, 1]]", "ranges of several parameters are {NAME: [low, high], OTHER: [low, high]}"),
        ("[0.05, 8]", "[8, 0.05]", "continuations[0].range: expected [low, high] with low < high, got [8, 0.05]"),
        ("[0.05, 8]", "[0.05]", "continuations[0].range: expected two values [low, high], got a list"),
        ("[0.05, 8]", "[0.05, 5]", "the start has mu = 8, outside the range [0.05, 5]; widen the range, or set mu"),
        ("[0.05, 8]", "{beta: [0, 1]}", "continuations[0].range.beta: 'beta' does not vary in this run; it varies mu"),
        ("name: line", "name: a.b", "continuations[0].name: a run's name may not contain a dot"),
        ("name: line", "direction: left", "continuations[0].direction: expected 'both', 'up' or 'down', got 'left'"),
        ("name: line", "settings: {max_stp: 1}", "settings.max_stp: unknown key: did you mean 'max_step'"),
        ("name: line", "settings: {step: fast}", "settings.step: expected a positive number, got 'fast'"),
        ("name: line", "settings: {points: 8}", "settings.points: expected a number not above 7, got 8"),
        ("name: line", "settings: {intervals: 2}", "settings.intervals: expected a number not below 3, got 2"),
        ("name: line", "settings: {max_angle: 90}", "settings.max_angle: expected a number below 90, got 90"),
        ("name: line", "values: {nu: 1}", "continuations[0].values.nu: there is no column 'nu': did you mean 'mu'"),
        ("name: line", "extrema: [x1.maxx]", "there is no column 'x1.maxx'"),
        ("continuations:\n", "continuations: []\nx:\n", "unknown key"),
        (
            "contin: 1",
            "contin: 1\nparameters: {bta: 1}",
            "parameters.bta: pair has no parameter 'bta': did you mean 'beta'",
        ),
        ("contin: 1", "contin: 1\nparameters: {beta: 1 +}", "case.yaml:2:23: parameters.beta:"),
        (
            "contin: 1",
            "contin: 1\ntransform: [averge]",
            "transform[0]: there is no pass 'averge': did you mean 'average'",
        ),
        ("contin: 1", "contin: 1\noutputs: {plot: ../a.png}", "outputs.plot: must stay in or below this file's folder"),
        ("  - {", "  - !!python/object:os.system {", "the tag"),
    ],
)
def test_a_mistake_is_named_with_its_place_and_what_to_write(message, old, new, expected):
    assert old in GOOD
    assert expected in message(GOOD.replace(old, new))


def test_several_mistakes_are_reported_at_once(message):
    text = message(GOOD.replace("mu", "mi").replace("in-phase", "inphase"))
    assert "no parameter 'mi'" in text
    assert "no start 'inphase'" in text


def test_two_runs_of_one_name_are_refused(message):
    line = GOOD.splitlines()[-1]
    assert "continuations[1].name: 'line' is already the name of an earlier run" in message(GOOD + line)


def test_a_mistake_in_a_model_written_in_place_is_found_in_the_run_file(message):
    broken = json.dumps(
        {"contin": 1, "model": {**FOLD, "equations": {"x": "p - z^2"}}, "continuations": [{"parameter": "p"}]}
    )
    text = message(broken)
    assert "case.yaml:1:" in text
    assert "equations.x: unknown name 'z'" in text


def test_a_model_file_is_not_a_run_file(message):
    assert "this is a model file; name it under `model:` in a run file" in message(json.dumps(FOLD))


@pytest.mark.parametrize(
    ("setting", "expected"),
    [
        ("beta", "write --set NAME=VALUE"),
        ("bta=1", "--set bta: pair has no parameter 'bta': did you mean 'beta'"),
        ("beta=one", "unknown name 'one'"),
    ],
)
def test_a_mistake_on_the_command_line_is_named(message, setting, expected):
    assert expected in message(GOOD, "--set", setting)


def test_a_file_that_is_not_there_is_bad_input(tmp_path, capsys):
    assert call("run", tmp_path / "absent.yaml") == 2
    assert "cannot be read: No such file" in capsys.readouterr().err


def test_what_is_not_a_command_is_bad_input():
    assert call("fly") == 2
    assert call("run") == 2


def test_a_folder_or_a_binary_file_is_bad_input(tmp_path, capsys):
    binary = tmp_path / "b.yaml"
    binary.write_bytes(b"\xff\xfe\x00")
    assert call("run", tmp_path) == 2
    assert call("run", binary) == 2
    assert "Traceback" not in capsys.readouterr().err


@pytest.mark.parametrize("reference", ["a/../../b.png", "/tmp/x.png", "C:\\x.png", "~/../x.gif", "x.txt"])
def test_outputs_stay_in_the_folder_of_the_run_file(tmp_path, capsys, reference):
    path = run_file(tmp_path, FOLD, {"parameter": "p"}, outputs={"plot": reference})
    assert call("run", path) == 2
    assert "outputs.plot: must" in capsys.readouterr().err


def test_outputs_do_not_leave_the_folder_through_a_symbolic_link(tmp_path, capsys):
    home, outside = tmp_path / "home", tmp_path / "outside"
    home.mkdir()
    outside.mkdir()
    (home / "link").symlink_to(outside)
    (home / "file.png").symlink_to(outside / "x.png")
    for reference in ("link/x.png", "file.png"):
        assert call("run", run_file(home, FOLD, {"parameter": "p"}, outputs={"plot": reference})) == 2
        assert "leads out of it through a symbolic link" in capsys.readouterr().err
    assert list(outside.iterdir()) == []


def test_outputs_do_not_overwrite_the_run_file_or_one_another(tmp_path, capsys):
    path = run_file(tmp_path, FOLD, {"parameter": "p"}, name="case.json", outputs={"json": "case.json"})
    assert call("run", path) == 2
    assert "would overwrite the run file itself" in capsys.readouterr().err


def test_an_output_that_cannot_be_written_is_found_before_the_computation(tmp_path, capsys):
    (tmp_path / "taken").write_text("")
    path = run_file(tmp_path, FOLD, {"parameter": "p"}, outputs={"plot": "taken/x.png", "json": "done.json"})
    assert call("run", path) == 2
    assert "taken is a file; x.png needs a folder of that name" in capsys.readouterr().err
    assert call("run", run_file(tmp_path, FOLD, {"parameter": "p"}), "--json", tmp_path) == 2
    assert "is a folder; name a file" in capsys.readouterr().err
    assert not (tmp_path / "done.json").exists()
