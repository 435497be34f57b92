"""Which libraries' code a process runs is fixed before numpy is imported, and not after."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from contin.errors import InputError
from contin.machine import environment, target

LOOK = """
import json, os, sys
{before}
from contin.machine import environment
environment.fix()
import numpy._core._multiarray_umath as loops
chosen = [f for f in loops.__cpu_dispatch__ if loops.__cpu_features__[f]]
names = {{name: os.environ.get(name) for name in ("OPENBLAS_CORETYPE", "OMP_NUM_THREADS")}}
print(json.dumps([environment.fixed(), chosen, names]))
"""


def look(before: str = "", **variables: str) -> list:
    root = str(Path(__file__).parents[2])
    ended = subprocess.run(
        [sys.executable, "-c", LOOK.format(before=before)],
        env={**os.environ, "PYTHONPATH": root, **variables}, capture_output=True, text=True, check=True,
    )  # fmt: skip
    return json.loads(ended.stdout)


def test_the_environment_is_fixed_whatever_it_was():
    pytest.importorskip("numpy", minversion="2.0")
    fixed, chosen, names = look(OPENBLAS_CORETYPE="SkylakeX", OMP_NUM_THREADS="8", NPY_DISABLE_CPU_FEATURES="")
    assert fixed
    assert not [feature for feature in chosen if "512" in feature or feature == "X86_V4"]
    assert names["OMP_NUM_THREADS"] == "1"
    if target.name() in environment.LIBRARIES and sys.platform != "darwin":
        assert names["OPENBLAS_CORETYPE"] == environment.LIBRARIES[target.name()][0]


def test_where_numpy_was_first_nothing_is_said_to_be_fixed():
    fixed, _, names = look("import numpy", OMP_NUM_THREADS="3")
    assert not fixed
    assert names["OMP_NUM_THREADS"] == "3"


def test_a_lower_level_may_be_asked_for_and_a_higher_one_not(monkeypatch):
    levels = list(target.LEVELS)
    if target.name() not in levels:
        pytest.skip("one level only")
    target.name.cache_clear()
    monkeypatch.setenv("CONTIN_TARGET", "x86-64")
    assert target.name() == "x86-64"
    target.name.cache_clear()
    monkeypatch.setenv("CONTIN_TARGET", "x86-64-v9")
    with pytest.raises(InputError, match=r"this machine runs code for .* got 'x86-64-v9'"):
        target.name()
    monkeypatch.delenv("CONTIN_TARGET")
    target.name.cache_clear()
