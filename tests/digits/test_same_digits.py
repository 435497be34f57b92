"""`contin run` writes the same bytes, times apart, whatever a machine's environment chooses."""

from __future__ import annotations

import pytest

from tests.digits.comparing import CHOICES, RUNS, first_difference, results


def assert_same(run, choices, tmp_path):
    expected = results(run, {}, tmp_path)
    for name in choices:
        found = results(run, CHOICES[name], tmp_path)
        assert found == expected, f"{name}: {first_difference(expected, found)}"


@pytest.mark.parametrize("run", RUNS, ids=lambda run: run.stem)
def test_digits_do_not_depend_on_the_environment(run, tmp_path):
    assert_same(run, ["everything"], tmp_path)


@pytest.mark.long
@pytest.mark.parametrize("run", RUNS, ids=lambda run: run.stem)
def test_digits_do_not_depend_on_any_one_choice(run, tmp_path):
    assert_same(run, CHOICES, tmp_path)
