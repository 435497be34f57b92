"""Computing time leaves out what kernels take to be compiled or loaded."""

import ast
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import pytest

from contin import kernels
from contin.kernels import clock as module
from contin.kernels.clock import CLOCK, Clock
from contin.problems.equilibrium import EquilibriumProblem
from tests.problems.follow import follow

SOURCES = Path(kernels.__file__).parent


def test_the_clock_stands_still_from_the_first_to_the_last_of_nested_blocks(monkeypatch):
    wall = SimpleNamespace(now=10.0)
    monkeypatch.setattr(module, "time", SimpleNamespace(perf_counter=lambda: wall.now))
    clock = Clock()
    start = clock.now()
    wall.now += 1.0
    with clock.standing():
        wall.now += 5.0
        with clock.standing():
            wall.now += 7.0
            assert clock.now() - start == 1.0
        wall.now += 9.0
    wall.now += 2.0
    assert clock.now() - start == 3.0
    assert clock.stood == 21.0


def test_the_clock_goes_on_after_an_error():
    clock = Clock()
    with pytest.raises(ZeroDivisionError), clock.standing():
        _ = 1 / 0
    assert clock.depth == 0


def test_seconds_of_a_branch_leave_out_what_its_kernels_take_to_load(monkeypatch):
    march = EquilibriumProblem.march

    def slowly_loaded(*args):
        with CLOCK.standing():
            time.sleep(0.5)
        return march(*args)

    monkeypatch.setattr(EquilibriumProblem, "march", slowly_loaded)
    stood = CLOCK.stood
    branch = follow({"x": "p - x^2"}, {"x": 1.0}, {"p": 1.0}, (-1.0, 1.5))
    assert CLOCK.stood - stood >= 0.5
    assert branch.seconds < 0.5


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
import time
from contin.kernels.clock import CLOCK
from contin.kernels.compile import telling
from contin.kernels.sample import outer

told = []
with telling(told.append):
    began, wall, stood = CLOCK.now(), time.perf_counter(), CLOCK.stood
    assert [outer(3.0), outer(4.0)] == [8.0, 10.0]
    print([told, CLOCK.now() - began, CLOCK.stood - stood, time.perf_counter() - wall])
"""


def test_compiling_is_told_once_and_loading_not_and_neither_is_computing_time(tmp_path):
    package = tmp_path / "contin" / "kernels"
    package.mkdir(parents=True)
    (tmp_path / "contin" / "__init__.py").touch()
    for name in ("__init__.py", "compile.py", "clock.py", "turns.py"):
        shutil.copy(SOURCES / name, package / name)
    (package / "sample.py").write_text(KERNELS)
    environment = os.environ | {"CONTIN_CACHE_DIR": str(tmp_path / "cache"), "PYTHONPATH": str(tmp_path)}
    for wanted in (["contin.kernels.sample"], []):
        text = subprocess.check_output([sys.executable, "-c", USE], env=environment, cwd=tmp_path, text=True)
        told, computing, stood, wall = ast.literal_eval(text)
        assert told == wanted
        assert stood > 0.0
        assert computing + stood == pytest.approx(wall, abs=1e-3)
        assert computing < 0.2 * wall
