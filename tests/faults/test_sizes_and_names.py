"""Numbers beyond double precision, absurd counts, names that steer terminals: refused in one message, exit code 2."""

import warnings
from pathlib import Path

import numpy as np
import pytest

import contin
from contin.errors import InputError, InputWarning
from contin.model.yaml_loader import load_model_text
from tests.faults.command import contin_command

MODEL = (
    "{contin: 1, name: m, states: {x: 1}, parameters: {a: {value: 1, range: [-1, 2]}, b: 0}, "
    "equations: {x: a - x^2 + b}, symmetries: {s: {x: x}}}"
)
RUN = f"contin: 1\nmodel: {MODEL}\n"
HUGE = ("1" + "0" * 309, "-1" + "0" * 320, "9" * 399, "9" * 5000)
PLACES = (
    "parameters: {b: @}",
    "continuations: [{parameter: a, range: [@, 1]}]",
    "continuations: [{parameter: a, range: [0, @]}]",
    "continuations: [{parameter: a, start: {x: @}}]",
    "continuations: [{parameter: a, values: {x: @}}]",
    *(f"continuations: [{{parameter: a, settings: {{{key}: @}}}}]" for key in (
        "step", "min_step", "max_step", "steps", "max_angle", "tolerance", "intervals", "points")),
    *(f"diagram: {{parameter: a, budget: {{{key}: @}}}}" for key in ("branches", "steps", "seconds")),
    "diagram: {parameter: a, start: all, box: {x: [0, @]}}",
    "phase: {parameter: [a, b], range: {a: [0, @], b: [0, 1]}}",
    *(f"simulate: [{{{key}: @}}]" for key in ("time", "transient", "samples", "rtol", "box")),
    "sweep: {parameter: a, steps: @}",
    "sweep: {parameter: a, settle: {window: @}}",
    "scan: {axes: {a: {from: @, to: 1, points: 3}}}",
    "scan: {axes: {a: {from: 0, to: 1, points: @}}}",
    "scan: {axes: {a: [@]}}",
    "scan: {axes: {a: [0]}, settle: {longest: @}}",
)  # fmt: skip


def check(folder: Path, text: str) -> str:
    """What `contin check` says of a file that it refuses."""
    file = folder / "run.yaml"
    file.write_text(text, encoding="utf-8")
    answer = contin_command("check", file)
    assert answer.code == 2, (text, answer)
    assert "Traceback" not in answer.err
    assert answer.err.startswith(f"{file}")
    return answer.err


@pytest.mark.parametrize("place", PLACES)
def test_numbers_of_hundreds_of_digits_are_refused_in_words(place, tmp_path):
    for number in HUGE:
        text = place.replace("@", number)
        head = RUN + ("continuations: [{parameter: a}]\n" if place.startswith("parameters") else "")
        assert len(check(tmp_path, head + text + "\n")) < 2000


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("simulate: [{samples: 2000000000}]", "at most"),
        ("continuations: [{parameter: a, settings: {intervals: 100000000}}]", "not above 10000"),
        ("transform: [{}]\ncontinuations: [{parameter: a}]", "one pass an entry"),
        ("scan: {axes: {a: {from: 0, to: 1, points: 5000}, b: {from: 0, to: 1, points: 5000}}}", "more than"),
    ],
)
def test_absurd_sizes_are_refused_in_words(body, words, tmp_path):
    assert words in check(tmp_path, RUN + body + "\n")


def test_samples_times_columns_have_a_limit_in_calls_too():
    model = contin.Model("m", states={"x": 1, "y": 0}, parameters={"a": 1}, equations={"x": "y", "y": "-a*x"})
    with pytest.raises(InputError, match="samples must be 6666666 at most; got 2000000000"):
        contin.simulate(model, samples=2_000_000_000)


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("continuations: [{name: l, parameter: a}, {from: k.LP1, parameter: b, range: [0, 1]}]", "no run 'k'"),
        ("continuations: [{from: l.LP1, parameter: a}, {name: l, parameter: a}]", "comes later"),
        ("continuations: [{name: l, from: l.LP1, parameter: a}]", "this run itself"),
        ("continuations: [{name: l, parameter: a}, {from: l.fold, parameter: a}]", "a label such as"),
        ("continuations: [{name: l, parameter: a}, {from: l~t.LP1, parameter: a}]", "no run 'l~t'"),
        ("diagram: {parameter: a}\ncontinuations: [{from: stat/BP1.LP1, parameter: a}]", "did you mean 'start'"),
        ("continuations: [{parameter: a}]\noutputs: {x: q}", "no column 'q'"),
        ("continuations: [{parameter: a}]\noutputs: {y: [x, x.max, z.max]}", "no column 'z.max'"),
        ('continuations: [{name: "a\\e[31m", parameter: a}]', "control characters"),
        ('continuations: [{parameter: a}]\ntitle: "\\e]0;x\\a"', "control characters"),
    ],
)
def test_what_a_file_does_not_define_is_found_before_anything_is_computed(body, words, tmp_path):
    message = check(tmp_path, RUN + body + "\n")
    assert words in message
    assert "\x1b" not in message
    assert contin_command("run", tmp_path / "run.yaml").err == message  # `run` begins with the same check


def test_branches_that_a_file_does_define_are_accepted(tmp_path):
    points = ("l~s.LP1", "l.2.LP1", "start.LP1", "start/BP1/HB1.PD1")
    runs = ", ".join(["{name: l, parameter: a}", *(f"{{from: {point}, parameter: a}}" for point in points)])
    (tmp_path / "run.yaml").write_text(RUN + f"diagram: {{parameter: a}}\ncontinuations: [{runs}]\n")
    assert contin_command("check", tmp_path / "run.yaml").code == 0


def test_escape_sequences_in_a_model_do_not_reach_the_terminal(tmp_path):
    base = "contin: 1\nname: m\nstates: {x: 1}\nparameters: {a: 1}\nequations: {x: a - x}\n"
    for line in (
        'title: "t\\a"',
        'description: "q\\x9b"',
        'source: "\\x7f"',
        'starts: {"s\\e": {x: 1}}',
        '"\\e[1m": 1',
    ):
        answer = contin_command("check", _written(tmp_path, base + line))
        assert answer.code == 2
        assert not any(c in answer.out + answer.err for c in "\x1b\x07\x7f\x9b")


def _written(folder: Path, text: str) -> Path:
    file = folder / "m.yaml"
    file.write_text(text, encoding="utf-8")
    return file


def test_what_other_programs_wrote_does_not_steer_the_terminal():
    import io

    from rich.table import Table
    from rich.text import Text

    from contin.cli.terminal import console

    stream = io.StringIO()
    report = console(stream, quiet=False)
    table = Table("a\x1b[31mb")
    table.add_row("\x07c\x9bd")
    for part in ("one\x1b[2Jtwo", Text("three\x1b]0;x\x07"), table):
        report.print(part)
    assert "one?[2Jtwo" in stream.getvalue()
    assert not any(c in stream.getvalue() for c in "\x1b\x07\x9b")


def test_a_default_outside_its_own_range_is_a_warning_with_its_place():
    text = "contin: 1\nname: m\nstates: {x: 1}\nparameters: {a: {value: 5, range: [0, 2]}}\nequations: {x: a - x}\n"
    with pytest.warns(InputWarning, match=r"m\.yaml:4:25: parameters\.a\.value: 5 is outside its own range \[0, 2\]"):
        load_model_text(text, "m.yaml")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        load_model_text(text.replace("5", "2"), "m.yaml")


@pytest.mark.parametrize(
    "names",
    [
        {"states": ["x", "x"]}, {"states": ["x", "a"]}, {"states": ["x", "y.z"]}, {"states": ["x", "stable"]},
        {"states": ["x", "\x1b[31m"]}, {"states": ["x", 3]}, {"name": "a\x1b"}, {"title": "\x07"},
        {"symmetries": {"s\n": lambda u: u}},
    ],
)  # fmt: skip
def test_names_given_to_a_function_are_checked(names):
    with pytest.raises(InputError, match=r"name|must be another"):
        contin.FunctionProblem(lambda u, p: u - p["a"], np.zeros(2), {"a": 1.0}, **names)


STEERING = "\x1b[31m\x9b\u202e\x07\r"


@pytest.mark.parametrize(
    "words", [["@"], ["run", "f", "--q@"], ["simulate", "x", "--time", "@"], ["diagram", "m", "a", "@", "1"], ["--v@"]]
)
def test_what_is_said_of_an_argument_has_none_of_its_control_characters(words):
    answer = contin_command(*(word.replace("@", STEERING) for word in words))
    assert answer.code == 2
    assert not set(STEERING) - set("[31m") & set(answer.out + answer.err)
