"""The report on terminals of any width."""

import io

from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console

from contin.cli.report import print_report
from contin.cli.run import Status

STATES = [f"concentration_{k}" for k in range(6)]
POINT = {
    "label": "HB12", "type": "HB", "index": 0, "normal_form": {"l1": -1.2345678e-11, "criticality": "supercritical"},
    "values": {"mu": -9.7712345e-05, "beta": 0.12345678, **dict.fromkeys(STATES, -1.2345678e-05)},
}  # fmt: skip
BRANCH = {
    "name": "line", "kind": "equilibrium", "locus": None, "parameters": ["mu", "beta"], "parent": None,
    "image_of": None, "columns": {name: [0.0] for name in POINT["values"]}, "points": [POINT],
    "ends": [{"reason": "bound", "text": "mu reached 1"}] * 2, "steps": 1, "seconds": 0.0,
}  # fmt: skip
DOCUMENT = {
    "model": {"name": "m", "states": STATES}, "branches": [BRANCH], "notes": [],
    "timing": {"import": 0.0, "lower": 0.0, "kernels": 0.0, "total": 0.0},
}  # fmt: skip


def printed(width):
    console = Console(file=io.StringIO(), width=width, highlight=False, markup=False)
    print_report(DOCUMENT, console)
    return console.file.getvalue()


@given(width=st.integers(74, 300))
def test_labels_parameters_and_coefficients_are_whole_at_every_width(width):
    text = printed(width)
    assert "…" not in text
    for whole in ("HB12", "-9.7712345e-05", "0.12345678", "l1 = -1.235e-11"):
        assert whole in text


def test_states_go_as_the_terminal_gets_narrower():
    counts = [printed(width).count("concentration_") for width in (80, 120, 140, 200)]
    assert counts == sorted(counts)
    assert counts[0] == 0
    assert counts[-1] == 4


def test_progress_is_one_line_without_nan_and_without_labels_that_may_go():
    file = io.StringIO()
    status = Status(Console(file=file, width=40, force_terminal=True))
    here = {"parameter": "mu", "rows": 7, "labels": ["HB"]}
    status.say("a-run-with-a-long-name")
    status.watch(here | {"value": float("nan"), "fraction": float("nan")})
    assert "nan" not in status.shown.status.plain
    status.watch(here | {"value": 1.23456789e-5, "fraction": 0.25})
    assert len(status.shown.status.plain) <= 36
    assert "HB" not in status.shown.status.plain


def test_what_is_no_more_than_its_error_is_zero():
    """And what is no more than rounding of its column; a small value among small ones is one."""
    point = {
        "label": "LP1", "type": "LP", "index": 1, "normal_form": {}, "error": 1e-17,
        "values": {"p": 4e-45, "q": 3e-12, "x": -4e-34, "y": 7e-20},
    }  # fmt: skip
    branch = BRANCH | {
        "parameters": ["p", "q"], "points": [point],
        "columns": {"p": [0.0, 1.0], "q": [-2.0, 2.0], "x": [-1.0, 1.0], "y": [1e-19, 7e-20]},
    }  # fmt: skip
    console = Console(file=io.StringIO(), width=120, highlight=False, markup=False)
    print_report(DOCUMENT | {"branches": [branch], "model": {"name": "m", "states": ["x", "y"]}}, console)
    assert "fold  0  3e-12  0  7e-20" in console.file.getvalue()
