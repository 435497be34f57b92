"""The executor with a double in the engine's place: order, skipping, and what makes a result incomplete."""

from pathlib import Path

import pytest

from contin.continuation.branch import End
from contin.errors import InputError, NoSolutionError, NotFiniteError
from contin.model.source import CallSource
from contin.runs.execute import execute
from contin.runs.load import read_run
from contin.runs.plan import make_plan
from tests.cli.calls import FOLD
from tests.plot.sample import branch, special


class Double:
    """Records the calls; every branch has one point LP1, and ends as `endings` says."""

    def __init__(self, failures=None, endings=None):
        self.failures, self.endings, self.calls = failures or {}, endings or {}, []

    def prepare(self, model):
        self.calls.append(("prepare", model.name))

    def start(self, model, run, parameters):
        self.calls.append(("start", run.name, run.start, dict(parameters)))
        if run.name in self.failures:
            raise self.failures[run.name]
        return run.name

    def start_at_point(self, branch, label, run):
        self.calls.append(("point", run.name, branch.name, label))
        if run.name in self.failures:
            raise self.failures[run.name]
        return run.name

    def continuation(self, start, run):
        bounds = run.range[run.parameters[0]]
        self.calls.append(("continuation", run.name, bounds, run.direction, dict(run.values), dict(run.settings)))
        reason = self.endings.get(run.name, "bound")
        ends = (End("start", "start"), End(reason, reason))
        yield branch(run.name, {"p": [0.0, 1.0], "x": [0.0, 1.0]}, [special("LP", "LP1", 0, {})], ends=ends)

    def diagram(self, model, diagram, parameters):
        self.calls.append(("diagram", diagram.parameter, diagram.range, list(diagram.starts), dict(diagram.budget)))

        class Found:
            branches = [branch("low/BP1", {"p": [0.0, 1.0], "x": [0.0, 1.0]}, [special("HB", "HB1", 0, {})])]  # noqa: RUF012
            notes = ["a note of the explorer"]  # noqa: RUF012
            stopped, failed = False, ()

            def as_data(self):
                return {"parameter": "p", "range": [0.0, 1.0], "branches": ["low/BP1"]}

        return Found()


def carried_out(double, *continuations, **more):
    entry = read_run({"contin": 1, "model": FOLD, "continuations": list(continuations), **more}, CallSource("test"))
    return execute(make_plan(entry, CallSource("test"), Path("case.yaml")), double)


A = {"name": "a", "parameter": "p"}
B = {"name": "b", "from": "a.LP1", "parameter": "p"}
C = {"name": "c", "from": "b.LP1", "parameter": ["p", "q"], "range": {"p": [0, 1], "q": [0, 1]}}


def test_the_diagram_runs_first_and_continuations_may_start_from_its_branches():
    double = Double()
    explorer = {"parameter": "p", "range": [-1, 1], "start": ["low", {"x": 1}], "budget": {"branches": 3}}
    result = carried_out(double, {"name": "a", "from": "low/BP1.HB1", "parameter": "p"}, diagram=explorer)
    assert [call[0] for call in double.calls] == ["diagram", "point", "continuation"]
    assert double.calls[0] == ("diagram", "p", (-1.0, 1.0), ["low", {"x": 1}], {"branches": 3})
    assert double.calls[1] == ("point", "a", "low/BP1", "HB1")
    assert list(result.branches) == ["low/BP1", "a"]
    assert result.notes == ["a note of the explorer"]
    assert result.complete


def test_what_a_run_says_reaches_the_engine():
    double = Double()
    options = {"direction": "up", "values": {"p": 1}, "settings": {"max_step": 0.1}, "start": "low", "range": [0, 2]}
    carried_out(double, {**A, **options}, parameters={"q": "2*p"})
    assert double.calls == [
        ("start", "a", "low", {"q": "2*p"}),
        ("continuation", "a", (0.0, 2.0), "up", {"p": [1.0]}, {"max_step": 0.1}),
    ]


def test_the_range_of_the_model_is_the_default():
    double = Double()
    carried_out(double, A)
    assert double.calls[1][2] == (-1.0, 2.0)
    with pytest.raises(InputError, match=r"the range of q is missing; add `range: \[low, high\]`"):
        carried_out(Double(), {"parameter": "q"})


@pytest.mark.parametrize("error", [NoSolutionError("none"), NotFiniteError("nan"), InputError("a fold has no branch")])
def test_a_point_that_cannot_be_left_skips_that_run_and_what_needs_it(error):
    result = carried_out(Double({"b": error}), A, B, C, {**A, "name": "d"})
    assert list(result.branches) == ["a", "d"]
    assert result.notes[0] == f"b skipped: {error}"
    assert "c skipped" in result.notes[1]
    assert not result.complete


def test_a_defect_in_one_run_does_not_lose_the_others_and_is_named_with_its_place():
    result = carried_out(Double({"a": ZeroDivisionError("division by zero")}), A, B, {**A, "name": "d"})
    assert list(result.branches) == ["d"]
    assert result.notes[0].startswith("a skipped: an error inside contin at contin/runs/execute.py:")
    assert result.notes[0].endswith("please report it: ZeroDivisionError: division by zero")
    assert not result.complete


def test_bad_input_at_a_start_is_an_error_not_a_note():
    with pytest.raises(InputError, match="outside"):
        carried_out(Double({"a": InputError("outside")}), A)


def test_stopping_one_run_stops_those_after_it():
    double = Double(endings={"a": "stopped"})
    result = carried_out(double, A, {**A, "name": "d"})
    assert list(result.branches) == ["a"]
    assert result.notes == ["d skipped: stopped by the user"]


def test_stopping_where_no_branch_is_followed_keeps_the_branches_before():
    double = Double({"b": KeyboardInterrupt()})
    result = carried_out(double, A, B, {**A, "name": "d"})
    assert list(result.branches) == ["a"]
    assert result.notes == ["b: stopped by the user", "d skipped: stopped by the user"]
    assert (result.stopped, result.complete) == (True, False)


@pytest.mark.parametrize(
    ("reason", "complete"),
    [
        ("bound", True),
        ("closed", True),
        ("homoclinic", True),
        ("corrector", False),
        ("steps", False),
        ("stopped", False),
    ],
)
def test_only_a_branch_cut_short_makes_a_result_incomplete(reason, complete):
    assert carried_out(Double(endings={"a": reason}), A).complete is complete
