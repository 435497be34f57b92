"""Systems on several processes: same rows and labels as in one, and troubles of any process told in words."""

import os
import subprocess
import sys
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from shutil import which
from threading import Barrier, Thread

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import splu

import contin
from contin.errors import ContinError, InputError
from contin.systems.functions.processes import Distributed

N = 30
LINE = (sp.diags([1.0, -2.0, 1.0], [-1, 0, 1], shape=(N, N)) * (N + 1.0) * (N + 1.0)).tocsc()
HALVES = slice(0, 13), slice(13, N)
EXAMPLE = Path(__file__).parents[3] / "examples/petsc/bratu.py"


class Room:
    """Two threads that exchange values as the processes of an MPI program do."""

    def __init__(self):
        self.barrier, self.values = Barrier(2, timeout=30), [None, None]

    def exchange(self, rank, value):
        self.values[rank] = value
        self.barrier.wait()
        seen = list(self.values)
        self.barrier.wait()
        return seen


class Member:
    def __init__(self, room, rank):
        self.room, self.rank = room, rank

    def Get_rank(self):
        return self.rank

    def bcast(self, obj, root=0):
        return self.room.exchange(self.rank, obj)[root]

    def allgather(self, sendobj):
        return self.room.exchange(self.rank, sendobj)


class Half:
    """One half of Bratu's problem on an interval; it needs its neighbour's last value, and factors its own block."""

    def __init__(self, comm, failing_from=np.inf):
        self.comm, self.rows, self.failing_from = comm, HALVES[comm.rank], failing_from
        self.kept, self.made, self.released = {}, 0, 0

    def spread(self, whole):
        return self.comm.bcast(whole)[self.rows]

    def gathered(self, part):
        parts = self.comm.allgather(part)
        return np.concatenate(parts) if self.comm.rank == 0 else None

    def laplace(self, part):
        left, right = self.comm.allgather((part[0], part[-1]))
        made = LINE[self.rows, self.rows] @ part
        if self.comm.rank == 0:
            made[-1] += (N + 1.0) * (N + 1.0) * right[0]
        else:
            made[0] += (N + 1.0) * (N + 1.0) * left[1]
        return made

    def residual(self, u, p):
        part = self.spread(u)
        whole = self.gathered(self.laplace(part) + p["lam"] * np.exp(part))
        if self.comm.rank == 1 and p["lam"] > self.failing_from:
            raise LookupError("no such table")
        return whole

    def record(self, u, p):
        return {"top": max(self.comm.allgather(self.spread(u).max()))}

    def linearise(self, u, p, key):
        self.made += 1
        heat = p["lam"] * np.exp(self.spread(u))
        self.kept[key] = heat, splu((LINE[self.rows, self.rows] + sp.diags(heat)).tocsc())

    def multiply(self, v, key):
        part = self.spread(v)
        return self.gathered(self.laplace(part) + self.kept[key][0] * part)

    def solve(self, r, key):
        return self.gathered(self.kept[key][1].solve(self.spread(r)))

    def release(self, nothing, keys):
        self.released += len(keys)
        for key in keys:
            del self.kept[key]


def follow(problem):
    return contin.continuation(contin.equilibrium(problem), "lam", (0, 4), settings={"steps": 40})


def on_two(work, failing_from=np.inf):
    """What work(problem) gives on the first of two threads, the system, and the parts of both."""
    room = Room()
    parts = [Half(Member(room, rank), failing_from) for rank in range(2)]
    other = Distributed(parts[1].comm, parts[1], None, {"lam": 0.0}, True)
    thread = Thread(target=partial(other.run, work))
    thread.start()
    first = Distributed(parts[0].comm, parts[0], np.zeros(N), {"lam": 0.0}, True)
    try:
        return first.run(work), first, parts
    finally:
        thread.join(30)
        assert not thread.is_alive()


@pytest.mark.seldom
def test_two_processes_find_what_one_does():
    alone = follow(
        contin.FunctionProblem(
            lambda u, p: LINE @ u + p["lam"] * np.exp(u), np.zeros(N), {"lam": 0.0},
            lambda u, p: (LINE + sp.diags(p["lam"] * np.exp(u))).tocsc(), record=lambda u, p: {"top": u.max()},
        )
    )  # fmt: skip
    line, first, parts = on_two(follow)
    assert [point.label for point in line.points] == [point.label for point in alone.points] == ["LP1"]
    assert line["LP1"].values["lam"] == pytest.approx(alone["LP1"].values["lam"], rel=1e-10)
    assert line["LP1"].values["top"] == pytest.approx(alone["LP1"].values["top"], rel=1e-6)
    assert 0 < line.effort["factorisations"] < parts[0].made
    assert parts[1].released == parts[0].released > parts[0].made - 10  # operators that nobody holds are forgotten
    with pytest.raises(ContinError, match="inside `run`"):
        contin.equilibrium(first.problem)


@pytest.mark.seldom
def test_trouble_on_another_process_ends_the_branch_in_words():
    line, _, _ = on_two(follow, failing_from=2.0)
    assert "process 1 of 2: LookupError: no such table" in line.ends[1].text
    assert len(line) > 5


def test_an_error_on_the_first_lets_the_others_go():
    def stumble(problem):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        on_two(stumble)


def test_what_is_missing_is_said():
    if find_spec("petsc4py"):
        pytest.skip("petsc4py is installed")
    with pytest.raises(InputError, match=r"from_petsc needs petsc4py and mpi4py: .*python3-petsc4py"):
        contin.from_petsc(None, None, {}, None, None)


@pytest.mark.skipif(not (find_spec("petsc4py") and which("mpirun")), reason="petsc4py and mpirun are not installed")
def test_example_on_two_processes_prints_the_labels_of_one():
    root = ("ALLOW_RUN_AS_ROOT", "ALLOW_RUN_AS_ROOT_CONFIRM")
    allowed = {f"OMPI_{name}": "1" for name in (*root, "MCA_mpi_yield_when_idle", "MCA_rmaps_base_oversubscribe")}
    shown = [
        subprocess.run(
            [*start, sys.executable, str(EXAMPLE), "-n", "16"], capture_output=True, text=True, check=True, timeout=120,
            env={**os.environ, **allowed},
        ).stdout.splitlines()
        for start in ([], ["mpirun", "-n", "2"])
    ]  # fmt: skip
    assert shown[1][0].startswith("2 processes")
    words = [line[1].split() for line in shown]
    assert words[0][0] == words[1][0] == "LP1"
    for k in (3, 6):
        assert float(words[1][k]) == pytest.approx(float(words[0][k]), rel=1e-7)
