"""Computing time leaves out what kernels take to be compiled or loaded."""

import time
from types import SimpleNamespace

import pytest

from contin.kernels import clock as module
from contin.kernels.clock import CLOCK, Clock
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from tests.problems.follow import follow


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

    follow({"x": "p - x^2"}, {"x": 1.0}, {"p": 1.0}, (-1.0, 1.5))  # modules are imported by now
    monkeypatch.setattr(EquilibriumProblem, "march", slowly_loaded)
    stood = CLOCK.stood
    branch = follow({"x": "p - x^2"}, {"x": 1.0}, {"p": 1.0}, (-1.0, 1.5))
    assert CLOCK.stood - stood >= 0.5
    assert branch.seconds < 0.5
