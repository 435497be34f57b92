"""A killed run goes on where it was: chunks come back bit for bit, and the resumed result is the uninterrupted one."""

import json
import os
import random
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from contin.api import continuation, equilibrium
from contin.continuation.problem import Chunk, Stop
from contin.errors import InputError
from contin.model.model import Model
from contin.store.journal import SqliteJournal, packed, unpacked


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
    assert journal.replay("arm", 0) is not None
    journal.close()


RUN = """
contin: 1
model: metronomes/pair-averaged
continuations:
  - {name: a, start: in-phase, parameter: mu, range: [1, 8], settings: {max_step: 2.0e-5, step: 2.0e-5, steps: 99999}}
  - {name: b, from: a.BP1, parameter: mu, range: [0.05, 8], settings: {max_step: 2.0e-4, step: 2.0e-4}}
outputs: {save: out.contin}
"""


def _result(path):
    document = json.loads(path.read_text())
    del document["timing"]
    for branch in document["branches"]:
        del branch["seconds"]
    return document


@pytest.mark.long
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs kill -9")
def test_fifty_kills_at_random_moments_lose_nothing(tmp_path):
    (tmp_path / "run.yaml").write_text(RUN)
    command = [sys.executable, "-m", "contin", "run", "run.yaml", "-q", "--json"]
    environment = {**os.environ}
    subprocess.run([*command, "whole.json"], cwd=tmp_path, check=True, env=environment)
    expected = _result(tmp_path / "whole.json")
    generator = random.Random(1)
    for trial in range(50):
        resume: list[str] = []
        for _ in range(generator.randint(1, 3)):
            process = subprocess.Popen([*command, f"{trial}.json", *resume], cwd=tmp_path, env=environment)
            time.sleep(generator.uniform(0.3, 3.0))
            process.kill()
            process.wait()
            resume = ["--resume"]
        subprocess.run([*command, f"{trial}.json", "--resume"], cwd=tmp_path, check=True, env=environment)
        assert _result(tmp_path / f"{trial}.json") == expected
