"""Which curves of orbits a phase diagram follows first, where it cannot follow all."""

import numpy as np
import pytest

from contin.continuation.branch import SpecialPoint
from contin.diagram.orbits import generation
from contin.diagram.phase.deferred import Deferred


def point(branch):
    zero = np.zeros(2)
    return SpecialPoint("LPC", "LPC1", 0, zero, zero, {}, 0.0, 0.0, zero.astype(complex), {}, branch=branch)


@pytest.mark.parametrize(
    ("born_at", "expected"), [("", 0), ("BP HB", 0), ("HB HOM", 0), ("HB PD", 1), ("HB BPC PD", 2)]
)
def test_generations_count_the_families_that_a_family_was_born_on(born_at, expected):
    assert generation(born_at.split()) == expected


def test_older_generations_come_first_and_in_the_order_found():
    names = {"a/PD1/PD1": 2, "b/PD1": 1, "c/PD1/PD1": 2, "d/PD2": 1}
    waiting = Deferred(most=10)
    for name, age in names.items():
        waiting.add(age, point(name))
    order = [waiting.next().branch for _ in names]
    assert order == ["b/PD1", "d/PD2", "a/PD1/PD1", "c/PD1/PD1"]
    assert waiting.next() is None


def test_a_budget_that_is_spent_leaves_the_rest_waiting():
    waiting = Deferred(most=10)
    for name in ("a/PD1", "b/PD1"):
        waiting.add(1, point(name))
    assert waiting.next().branch == "a/PD1"
    waiting.used += 10
    assert waiting.next() is None
    assert [p.branch for _, p in waiting.waiting] == ["b/PD1"]
