"""A killed run goes on where it was: chunks come back bit for bit, and the resumed result is the uninterrupted one."""

import json
import multiprocessing
import os
import random
import shutil
import sqlite3
import time
from pathlib import Path

import numpy as np
import pytest

from contin.api import continuation, equilibrium
from contin.cli.main import main
from contin.continuation.sample import Chunk, Stop
from contin.errors import InputError
from contin.model.model import Model
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.store.journal import SqliteJournal, packed, unpacked
from tests.warm import warm_up


def chunk(rows: int = 3) -> Chunk:
    generator = np.random.default_rng(rows)
    return Chunk(
        generator.normal(size=(rows, 4)), generator.normal(size=(rows, 4)), generator.normal(size=(rows, 4)),
        np.arange(rows), generator.normal(size=(rows, 3)) + 1j * generator.normal(size=(rows, 3)),
        generator.normal(size=rows), Stop.DIP, 0.1, -3.25, 2, 17, "in words",
    )  # fmt: skip


def test_a_chunk_comes_back_bit_for_bit():
    original = chunk()
    header, data = packed(original)
    copy = unpacked(json.loads(json.dumps(header)), data)
    for name in ("z", "tangents", "tests", "unstable", "eigenvalues", "lengths"):
        assert getattr(copy, name).tobytes() == getattr(original, name).tobytes()
    assert (copy.stop, copy.next_step, copy.reference, copy.dipped, copy.evaluations, copy.detail) == (
        Stop.DIP, 0.1, -3.25, 2, 17, "in words",
    )  # fmt: skip


FOLD = Model("fold", states={"x": -1.0}, parameters={"p": 1.0}, equations={"x": "p - x^2"})


class Killed(Exception):
    """Stands for the end of the process."""


def test_a_resumed_run_replays_what_was_kept_and_equals_the_uninterrupted_one(tmp_path, monkeypatch):
    settings = {"max_step": 0.001, "step": 0.001}
    whole = continuation(equilibrium(FOLD), "p", (-1, 2), settings=settings)

    def killed_after_two_chunks(progress):
        if progress["rows"] > 600:
            raise Killed

    path = tmp_path / "fold.contin"
    first = SqliteJournal(path, "same run", resume=False)
    problem = type(whole.problem)
    monkeypatch.setattr(problem, "maximum_chunk", 300)
    with pytest.raises(Killed):
        continuation(equilibrium(FOLD), "p", (-1, 2), settings=settings, watch=killed_after_two_chunks, journal=first)
    first.close()
    second = SqliteJournal(path, "same run", resume=True)
    resumed = continuation(equilibrium(FOLD), "p", (-1, 2), settings=settings, journal=second)
    assert second.replayed >= 2
    second.close()
    assert [p.label for p in resumed.points] == ["LP1"]
    assert resumed.points[0].z.tobytes() == whole.points[0].z.tobytes()
    assert resumed.ends[0].reason == resumed.ends[1].reason == "bound"


def test_another_run_is_not_resumed(tmp_path):
    path = tmp_path / "run.contin"
    SqliteJournal(path, "one", resume=False).close()
    with pytest.raises(InputError, match="another one"):
        SqliteJournal(path, "two", resume=True)


def test_a_file_in_use_is_named(tmp_path):
    path = tmp_path / "run.contin"
    first = SqliteJournal(path, "one", resume=False)
    with pytest.raises(InputError, match="in use by another process"):
        SqliteJournal(path, "one", resume=True)
    first.close()


def test_a_folder_that_does_not_exist_is_named(tmp_path):
    with pytest.raises(InputError, match="cannot be written"):
        SqliteJournal(tmp_path / "missing" / "run.contin", "one", resume=False)


def test_a_full_disk_stops_the_journal_and_not_the_run(tmp_path):
    journal = SqliteJournal(tmp_path / "run.contin", "one", resume=False)
    journal._connection.execute("PRAGMA max_page_count = 60")
    for number in range(50):
        journal.record("arm", number, chunk(200))
    assert "the disk is full" in journal.trouble
    kept = [number for number in range(50) if journal.replay("arm", number) is not None]
    assert kept == list(range(len(kept)))  # all up to the one that did not fit
    assert 0 < len(kept) < 50
    assert all(journal.replay("arm", number).z.tobytes() == chunk(200).z.tobytes() for number in kept)
    journal.close()


RUN = """
contin: 1
model: metronomes/pair-averaged
continuations:
  - {name: a, start: in-phase, parameter: mu, range: [1, 8], settings: {max_step: 1.0e-3, step: 1.0e-3}}
  - {name: b, from: a.BP1, parameter: mu, range: [0.05, 8], settings: {max_step: 1.0e-2, step: 1.0e-2}}
outputs: {save: out.contin}
"""


def _result(path):
    document = json.loads(path.read_text())
    del document["timing"], document["sha256"]
    for branch in document["branches"]:
        del branch["seconds"]
    return document


def _run(folder, out, *more):
    """Carry out the run in this (forked) process, from whose memory the kernels are at hand."""
    os.chdir(folder)
    main(["run", "run.yaml", "--quiet", "--json", out, *more])


def _start(folder, out, *more):
    process = multiprocessing.get_context("fork").Process(target=_run, args=(folder, out, *more))
    process.start()
    return process


def _kept(path):
    """Chunks in the file of a run, looked at in a copy; 0 where the copy was taken in the middle of a write."""
    if not path.exists():
        return 0
    for suffix in ("", "-wal"):
        Path(f"{path}.copy{suffix}").unlink(missing_ok=True)
        if Path(f"{path}{suffix}").exists():
            shutil.copy(f"{path}{suffix}", f"{path}.copy{suffix}")
    connection = sqlite3.connect(f"{path}.copy")
    try:
        tables = connection.execute("SELECT name FROM sqlite_master WHERE name = 'chunk'").fetchall()
        return connection.execute("SELECT count(*) FROM chunk").fetchone()[0] if tables else 0
    except sqlite3.DatabaseError:
        return 0
    finally:
        connection.close()


@pytest.mark.parametrize("trials", [2, pytest.param(50, marks=pytest.mark.long)])
@pytest.mark.skipif("fork" not in multiprocessing.get_all_start_methods(), reason="needs fork and kill -9")
@pytest.mark.seldom
def test_runs_killed_at_random_moments_and_resumed_give_the_uninterrupted_result(tmp_path, monkeypatch, trials):
    (tmp_path / "run.yaml").write_text(RUN)
    warm_up()
    monkeypatch.setattr(EquilibriumProblem, "maximum_chunk", 40)  # in the forked processes too
    began = time.monotonic()
    whole = _start(tmp_path, "whole.json")
    whole.join()
    assert whole.exitcode == 0
    expected, duration = _result(tmp_path / "whole.json"), time.monotonic() - began
    generator = random.Random(trials)
    in_flight = 0
    for trial in range(trials):
        resume: list[str] = []
        (tmp_path / "out.contin").unlink(missing_ok=True)
        for _ in range(generator.randint(1, 3)):
            process = _start(tmp_path, f"{trial}.json", *resume)
            wanted = generator.randint(0, 2)  # chunks on the disk: on a busy machine a clock tells too little
            while process.is_alive() and _kept(tmp_path / "out.contin") < wanted:
                time.sleep(0.01)
            time.sleep(generator.uniform(0.0, min(0.2 * duration, 1.0)))
            process.kill()  # SIGKILL: nothing of it can be caught
            process.join()
            resume = ["--resume"]
        in_flight += _kept(tmp_path / "out.contin") > 0
        last = _start(tmp_path, f"{trial}.json", "--resume")
        last.join()
        assert last.exitcode == 0
        assert _result(tmp_path / f"{trial}.json") == expected
    assert in_flight >= trials // 4  # most were killed while they computed, not before or after
