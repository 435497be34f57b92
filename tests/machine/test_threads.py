"""Work that is shared among threads: all of it is done once, and the digits are those of one thread."""

import os
import subprocess
import sys
from threading import Lock

import numpy as np
import pytest

from contin.machine import threads
from contin.machine.environment import THREADS

PROGRAM = """
import numpy as np
import scipy.sparse as sp
from contin.linalg.by_rows import ByRows
from contin.linalg.vectors import added_and_multiplied, inner, mixed, norm
from contin.machine.threads import PART, threads

n = 5 * PART + 3
generator = np.random.default_rng(1)
rows, w = generator.normal(size=(3, n)), generator.normal(size=n)
matrix = sp.diags(generator.normal(size=(3, n)), [-300, 0, 300], shape=(n, n)).tocsc()
product = ByRows().product(matrix)(w)
told = added_and_multiplied(np.ones(3), rows, w)
found = (*inner(rows, rows).ravel(), *told, norm(product), mixed(told[None, :3], rows).sum())
print(threads(), *(value.hex() for value in found))
"""


@pytest.mark.parametrize("count", [1, 2, 5])
def test_every_number_is_in_one_part(count, monkeypatch):
    monkeypatch.setattr(threads, "threads", lambda: count)
    seen, lock = np.zeros(7 * threads.PART + 5, int), Lock()

    def work(first, last):
        with lock:
            seen[first:last] += 1

    threads.in_parts(3, len(seen), work)
    assert not seen[:3].any()
    assert np.all(seen[3:] == 1)
    threads.in_parts(5, 5, work)


def test_an_error_in_a_part_is_raised(monkeypatch):
    monkeypatch.setattr(threads, "threads", lambda: 2)

    def work(first, last):
        raise ValueError(f"at {first}")

    with pytest.raises(ValueError, match="at "):
        threads.in_parts(0, 8 * threads.PART, work)


def test_digits_do_not_depend_on_the_number_of_threads():
    told = []
    for count in ("1", "3"):
        environment = {name: value for name, value in os.environ.items() if name not in THREADS}
        done = subprocess.run(
            [sys.executable, "-c", PROGRAM], env=environment | {"OMP_NUM_THREADS": count}, capture_output=True,
            text=True, check=True, timeout=120,
        )  # fmt: skip
        used, *digits = done.stdout.split()
        assert used == count
        told.append(digits)
    assert told[0] == told[1]
