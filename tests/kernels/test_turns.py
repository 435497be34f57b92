"""Of processes that need a kernel at the same time, one compiles it; the others say that they wait, and load it."""

import ast
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from contin import kernels

SOURCES = Path(kernels.__file__).parent

KERNELS = """
from contin.kernels.compile import kernel


@kernel
def inner(x):
    return x + 1.0


@kernel
def outer(x):
    return 2.0 * inner(x)
"""
USE = """
import sys
from contin.kernels.compile import telling
from contin.kernels.sample import inner, outer

told = []


def tell(module):
    told.append(module)
    if sys.argv[1] == "first":  # in the middle of compiling: until the other one waits
        print("begun", flush=True)
        sys.stdin.readline()
    else:
        print("waiting", flush=True)


with telling(tell):
    assert outer(3.0) == 8.0
print([told, sum(outer.stats.cache_misses.values()), sum(inner.stats.cache_misses.values())])
"""


@pytest.fixture
def start(tmp_path):
    package = tmp_path / "contin" / "kernels"
    package.mkdir(parents=True)
    (tmp_path / "contin" / "__init__.py").touch()
    for name in ("__init__.py", "compile.py", "clock.py", "turns.py"):
        shutil.copy(SOURCES / name, package / name)
    (package / "sample.py").write_text(KERNELS)
    environment = os.environ | {"CONTIN_CACHE_DIR": str(tmp_path / "cache"), "PYTHONPATH": str(tmp_path)}
    processes = []

    def start(which):
        command = [sys.executable, "-c", USE, which]
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
        processes.append(subprocess.Popen(command, env=environment, cwd=tmp_path, text=True, **pipes))
        return processes[-1]

    yield start
    for process in processes:
        process.kill()
        process.communicate()


@pytest.mark.skipif(sys.platform == "win32", reason="needs fcntl")
def test_a_second_process_waits_for_the_first_and_compiles_nothing(start):
    first = start("first")
    assert first.stdout.readline() == "begun\n"
    second = start("second")
    assert second.stdout.readline() == "waiting\n"
    text = first.communicate("go on\n")[0]
    assert ast.literal_eval(text) == [["contin.kernels.sample"], 1, 1]
    assert ast.literal_eval(second.communicate()[0]) == [["contin.kernels.sample"], 0, 0]


@pytest.mark.skipif(sys.platform == "win32", reason="needs fcntl")
def test_who_is_killed_while_compiling_leaves_his_turn_to_the_next(start):
    first = start("first")
    assert first.stdout.readline() == "begun\n"
    second = start("second")
    assert second.stdout.readline() == "waiting\n"
    first.kill()
    assert ast.literal_eval(second.stdout.read().splitlines()[-1])[1:] == [1, 1]
