"""Where two numbers differ in sign, in units in which their product is no number, or zero."""

from __future__ import annotations

import warnings

import pytest

import contin
from contin.continuation.sample import opposite


@pytest.mark.parametrize("unit", [1e-300, 1e-170, 1.0, 1e200, 1e300])
def test_opposite_signs_are_seen_at_any_size(unit):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert opposite(-2.0 * unit, unit)
        assert not opposite(unit, 3.0 * unit)
        assert not opposite(-unit, 0.0)
        assert opposite([unit, -unit], [-unit, -unit]).tolist() == [True, False]


def test_the_fold_between_bounds_1e300_apart_is_told_and_nothing_overflows():
    """p = x^2: both bounds are reached or approached, and the change of stability between them is no secret."""
    model = contin.Model("fold", states={"x": 1}, parameters={"p": 1}, equations={"x": "p - x^2"})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        branch = contin.continuation(model, "p", (1e-300, 1e300), settings={"steps": 20})
    assert any("unstable changes from 1 to 0" in note for note in branch.notes)
