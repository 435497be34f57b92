"""`contin run` writes the same bytes, times apart, whatever a machine's environment chooses."""

from __future__ import annotations

import shutil
import subprocess
import sys

import pytest

from tests.digits.comparing import CHOICES, ROOT, RUNS, first_difference, results, unfixed
from tests.digits.digest import digest

EMULATOR = shutil.which("qemu-x86_64")


def assert_same(run, choices, tmp_path):
    expected = results(run, {}, tmp_path)
    for name in choices:
        found = results(run, CHOICES[name], tmp_path)
        assert found == expected, f"{name}: {first_difference(expected, found)}"


@pytest.mark.parametrize("run", RUNS[:2], ids=lambda run: run.stem)  # the long version takes all
def test_digits_do_not_depend_on_the_environment(run, tmp_path):
    assert_same(run, ["everything"], tmp_path)


@pytest.mark.long
@pytest.mark.parametrize("run", RUNS, ids=lambda run: run.stem)
def test_digits_do_not_depend_on_any_one_choice(run, tmp_path):
    assert_same(run, CHOICES, tmp_path)


@pytest.mark.long
@pytest.mark.skipif(EMULATOR is None, reason="needs qemu-x86_64 (Debian: qemu-user)")
@pytest.mark.parametrize("processor", ["Haswell", "EPYC"])
@pytest.mark.parametrize("run", RUNS, ids=lambda run: run.stem)
def test_digits_are_those_of_another_makers_processor(run, processor, tmp_path):
    """The first run makes the kernels, where they are not there yet: emulated, that would take an hour."""
    expected = results(run, {}, tmp_path)
    found = results(run, {}, tmp_path, [str(EMULATOR), "-cpu", processor, sys.executable])
    assert found == expected, first_difference(expected, found)


@pytest.mark.skipif(EMULATOR is None, reason="needs qemu-x86_64 (Debian: qemu-user)")
@pytest.mark.long
@pytest.mark.parametrize("processor", ["Haswell", "EPYC", "Nehalem"])
def test_elementary_functions_are_those_of_another_makers_processor(processor):
    command = [str(EMULATOR), "-cpu", processor, sys.executable, str(ROOT / "tests" / "digits" / "digest.py")]
    environment = {**unfixed(), "PYTHONPATH": str(ROOT)}
    ended = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert ended.stdout.split()[1] == digest()
