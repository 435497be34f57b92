"""Programs that import numpy themselves: small matrices have one thread of BLAS while a branch is followed."""

import json
import os
import subprocess
import sys

import pytest
import threadpoolctl

from contin.machine import one_thread
from contin.machine.environment import THREADS

PROGRAM = """
import json
import numpy as np
import scipy.linalg
from threadpoolctl import threadpool_info, threadpool_limits
import contin

def threads():
    return sorted({library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"})

seen = []
def residual(u, p):
    seen.append(threads())
    return p["p"] - u * u

before = threads()
line = contin.continuation(contin.FunctionProblem(residual, np.ones(2), {"p": 1.0}), "p", (0.5, 1.5))
print(json.dumps([before, [list(one) for one in sorted({tuple(one) for one in seen})], threads()]))
"""


def threads_of(**chosen: str) -> list[list[int]]:
    """Before, inside the function (all that were seen there) and after."""
    environment = {name: value for name, value in os.environ.items() if name not in THREADS} | chosen
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM], env=environment, capture_output=True, text=True, check=True, timeout=120
    )
    before, inside, after = json.loads(done.stdout.splitlines()[-1])
    assert before == after
    return [before, *inside]


def test_inside_there_is_one_and_afterwards_what_there_was():
    before, *inside = threads_of()
    assert before == [len(os.sched_getaffinity(0))] or before == [1]
    assert inside == [[1]]


def test_who_has_chosen_keeps_the_choice():
    before, *inside = threads_of(OPENBLAS_NUM_THREADS="2")
    assert inside == [before]


def test_libraries_are_looked_for_again_only_where_something_was_imported(monkeypatch: pytest.MonkeyPatch) -> None:
    looks = []

    class Counted(threadpoolctl.ThreadpoolController):
        def __init__(self) -> None:
            looks.append(1)
            super().__init__()

    monkeypatch.setattr(threadpoolctl, "ThreadpoolController", Counted)
    monkeypatch.setattr(one_thread, "chosen", lambda: False)
    limit = one_thread.OneThread()
    for _ in range(3):
        with limit, limit:
            blas = [each["num_threads"] for each in threadpoolctl.threadpool_info() if each["user_api"] == "blas"]
            assert set(blas) <= {1}
    looks_of_info = 3
    assert len(looks) == 1 + looks_of_info
    monkeypatch.setitem(sys.modules, "a_module_that_was_not_there", sys)
    with limit:
        assert len(looks) == 2 + looks_of_info
