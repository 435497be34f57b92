"""Ended at random moments: a signal keeps what was computed; kill -9 loses no earlier result and no whole branch."""

import json
import os
import random
import signal
import time

import pytest

from contin.store.digest import LeftOutWarning
from contin.store.places import beside
from contin.store.results import read_results
from contin.store.scan_store import read_scan
from contin.store.verify import verify
from tests.cli.calls import FOLD, run_file
from tests.faults.processes import finished, kept, needs_fork, short_chunks, started, wait_for
from tests.warm import warm_up

pytestmark = needs_fork
SHORT = {"name": "short", "parameter": "p"}
ENDLESS = {"name": "endless", "parameter": "p", "settings": {"max_step": 1e-9, "step": 1e-9, "steps": 1_000_000_000}}
DAMPED = {"contin": 1, "name": "damped", "states": {"x": 1, "y": 0}, "parameters": {"d": 1},
          "equations": {"x": "y", "y": "-x - 0.05*d*y"}}  # fmt: skip
SCAN = {"axes": {"d": {"from": 0.5, "to": 2, "points": 4000}}, "settle": {"window": 30}}
STORES = {"save": "r.contin", "json": "r.json"}


@pytest.fixture(scope="module", autouse=True)
def _warm():
    warm_up()


def rows(branch):
    return len(branch["columns"]["p"])


@pytest.mark.parametrize("trials", [2, pytest.param(60, marks=pytest.mark.long)])
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGINT])
def test_a_signal_at_a_random_moment_keeps_what_was_computed(tmp_path, number, trials):
    generator = random.Random(number)
    run_file(tmp_path, FOLD, SHORT, ENDLESS, outputs=STORES)
    for trial in range(trials):
        for name in STORES.values():
            (tmp_path / name).unlink(missing_ok=True)
        process = started(tmp_path, "run", "case.yaml", "-q", before=short_chunks)
        assert wait_for(lambda: kept(tmp_path / "r.contin") > 100_000, process)
        time.sleep(generator.uniform(0.0, 0.1))
        for _ in range(1 if number == signal.SIGINT else generator.randint(1, 3)):  # `timeout` sends it twice
            os.kill(process.pid, number)
        assert finished(process) == 1, (trial, (tmp_path / "err").read_text())
        for name in STORES.values():
            verify(tmp_path / name)
            short, *rest = read_results(tmp_path / name)["branches"]
            assert short["name"] == "short"
            assert [end["reason"] for end in short["ends"]] == ["bound", "bound"]
            assert rest
            assert all("stopped" in [end["reason"] for end in branch["ends"]] for branch in rest)
        assert "stopped by the user" in (tmp_path / "r.json").read_text()
        assert not list(tmp_path.glob(".*"))


@pytest.mark.parametrize(
    "number", [signal.SIGTERM, *(pytest.param(s, marks=pytest.mark.long) for s in (signal.SIGHUP, signal.SIGINT))]
)  # told apart above
def test_a_signal_keeps_the_runs_of_a_scan_and_it_goes_on(tmp_path, number):
    outputs = {"save": "s.scan", "csv": "s.csv", "json": "s.json"}
    run_file(tmp_path, DAMPED, scan=SCAN, outputs=outputs)
    process = started(tmp_path, "run", "case.yaml", "-q")
    assert wait_for(lambda: kept(tmp_path / "s.scan") > 100_000, process)
    os.kill(process.pid, number)
    assert finished(process) == 1
    columns = read_scan(tmp_path / "s.scan")["columns"]
    assert 0 < len(columns["d"]) < 4000
    assert len((tmp_path / "s.csv").read_text().splitlines()) == 1 + len(columns["d"])
    document = json.loads((tmp_path / "s.json").read_text())
    assert document["notes"] == [f"stopped by the user: {len(columns['d'])} of 4000 runs were done"]


@pytest.mark.parametrize("trials", [2, pytest.param(40, marks=pytest.mark.long)])
def test_a_killed_run_leaves_the_earlier_result_and_every_whole_branch(tmp_path, trials):
    generator = random.Random(trials)
    run_file(tmp_path, FOLD, SHORT, outputs=STORES)
    assert finished(started(tmp_path, "run", "case.yaml", "-q")) == 0
    before = {name: (tmp_path / name).read_bytes() for name in STORES.values()}
    run_file(tmp_path, FOLD, {**SHORT, "name": "first"}, ENDLESS, outputs=STORES)
    for trial in range(trials):
        process = started(tmp_path, "run", "case.yaml", "-q", *(["--resume"] if trial % 2 else []), before=short_chunks)
        unfinished = beside(tmp_path / "r.contin")
        assert wait_for(lambda path=unfinished: kept(path) > 100_000, process)
        time.sleep(generator.uniform(0.0, 0.3))
        os.kill(process.pid, signal.SIGKILL)
        assert finished(process) == -signal.SIGKILL
        assert before == {name: (tmp_path / name).read_bytes() for name in STORES.values()}
        with pytest.warns(UserWarning, match="not finished"):
            assert [branch["name"] for branch in read_results(unfinished)["branches"]] == ["first"]
    run_file(tmp_path, FOLD, {**SHORT, "name": "first"}, outputs=STORES)
    assert finished(started(tmp_path, "run", "case.yaml", "-q")) == 0
    assert [branch["name"] for branch in read_results(tmp_path / "r.contin")["branches"]] == ["first"]
    assert sorted(path.name for path in tmp_path.glob("*r.*")) == ["r.contin", "r.json"]


def test_without_a_store_the_branches_that_are_whole_are_in_the_json(tmp_path):
    run_file(tmp_path, FOLD, SHORT, ENDLESS, outputs={"json": "r.json"})
    for place in (tmp_path / "r.json", beside(tmp_path / "r.json")):
        process = started(tmp_path, "run", "case.yaml", "-q")
        assert wait_for(place.exists, process)
        os.kill(process.pid, signal.SIGKILL)
        finished(process)
        assert [branch["name"] for branch in read_results(place)["branches"]] == ["short"]


def test_of_two_scans_with_one_store_the_second_is_refused(tmp_path):
    run_file(tmp_path, DAMPED, scan=SCAN, outputs={"save": "s.scan"})
    first = started(tmp_path, "run", "case.yaml", "-q")
    assert wait_for(lambda: kept(tmp_path / "s.scan") > 150_000, first)
    for more in ([], ["--resume"]):
        assert finished(started(tmp_path, "scan", "case.yaml", "-q", *more)) == 2
        assert "s.scan: in use by another process" in (tmp_path / "err").read_text()
    assert first.is_alive()
    os.kill(first.pid, signal.SIGKILL)
    finished(first)
    assert 0 < len(read_scan(tmp_path / "s.scan")["columns"]["d"]) < 4000


def test_a_log_gets_a_line_of_progress_every_few_seconds(tmp_path, monkeypatch):
    from contin.cli import ticker

    monkeypatch.setattr(ticker, "EVERY", 0.2)
    run_file(tmp_path, FOLD, ENDLESS)
    process = started(tmp_path, "run", "case.yaml")
    assert wait_for(lambda: (tmp_path / "err").exists() and (tmp_path / "err").read_text().count("\n") >= 3, process)
    os.kill(process.pid, signal.SIGTERM)
    assert finished(process) == 1
    assert "endless: p = " in (tmp_path / "err").read_text()


CUSP = {"contin": 1, "name": "cusp", "states": {"x": 0.5, "y": 0}, "equations": {"x": "a + b*x - x^3", "y": "x - y"},
        "parameters": {"a": {"value": 0.5, "range": [-1, 1]}, "b": {"value": 0.5, "range": [-1, 1]}}}  # fmt: skip


def test_a_killed_phase_diagram_keeps_its_curves_and_goes_on(tmp_path):
    """Killed at the first curve that is whole; `--resume` gives what an uninterrupted run gives."""
    phase = {"parameter": ["a", "b"], "orbits": False}
    run_file(tmp_path, CUSP, phase=phase, outputs=STORES)

    def end_at_a_curve():
        from contin.store.journal import SqliteJournal

        def ended(journal, branch, original=SqliteJournal.finished):
            original(journal, branch)
            os.kill(os.getpid(), signal.SIGKILL)

        SqliteJournal.finished = ended

    assert finished(started(tmp_path, "run", "case.yaml", "-q", before=end_at_a_curve)) == -signal.SIGKILL
    with pytest.warns(LeftOutWarning, match="the run was not finished; 1 of its branches are whole"):
        curves = [branch["name"] for branch in read_results(tmp_path / "r.contin")["branches"]]
    assert len(curves) == 1
    assert finished(started(tmp_path, "run", "case.yaml", "-q", "--resume")) == 0
    resumed = read_results(tmp_path / "r.json")
    (tmp_path / "r.contin").unlink()
    assert finished(started(tmp_path, "run", "case.yaml", "-q")) == 0
    whole = read_results(tmp_path / "r.json")
    assert curves[0] in [branch["name"] for branch in whole["branches"]]
    assert resumed["phase"] == whole["phase"]
    for one, other in zip(resumed["branches"], whole["branches"], strict=True):
        assert (one["name"], one["columns"], one["points"]) == (other["name"], other["columns"], other["points"])
