"""Memory that a computation has freed goes back to the system, also from below what lives on."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from contin.machine import freed

MEGABYTE = 2**17  # numbers

pytestmark = pytest.mark.skipif(freed._trimming() is None, reason="needs the GNU C library on Linux")


@pytest.fixture(autouse=True)
def nothing_is_free():
    """What earlier tests have freed is no memory that these get without growing."""
    freed._trimming()(0)
    freed.keep_freed()


def fragments(megabytes):
    """Small blocks that were made between large ones, which are free again."""
    large, small = [], []
    for _ in range(megabytes):
        large.append(np.ones(MEGABYTE))
        small.append(np.ones(1000))
    return small


def test_free_memory_between_blocks_that_are_in_use_is_given_back():
    """In a process of its own: what other tests hold may lie anywhere."""
    code = (
        "from tests.machine.test_freed import fragments, freed; freed.keep_freed(); before = freed.resident(); "
        "kept = fragments(200); held = freed.resident(); freed.give_back(); "
        "print(len(kept), held - before, freed.resident() - before)"
    )
    root = Path(__file__).parents[2]
    told = subprocess.run([sys.executable, "-c", code], cwd=root, capture_output=True, text=True, check=True)
    blocks, held, left = map(int, told.stdout.split())
    assert blocks == 200
    assert held > 150 * 2**20
    assert left < 30 * 2**20


def test_what_is_small_is_kept():
    kept = fragments(20)
    held = freed.resident()
    freed.give_back()
    assert len(kept) == 20
    assert freed.resident() == pytest.approx(held, abs=2**20)


def test_another_system_is_left_alone(monkeypatch):
    monkeypatch.setattr(sys, "platform", "darwin")
    freed._trimming.cache_clear()
    try:
        assert freed._trimming() is None
        freed.give_back()
    finally:
        freed._trimming.cache_clear()
