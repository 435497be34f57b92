"""Between neighbouring rows the change of `unstable` is explained by the labels between them."""

import numpy as np
import pytest

from contin.continuation.accounting import unexplained
from contin.continuation.problem import Verified


def label(type_: str, **vectors: object) -> Verified:
    return Verified(type_, np.zeros(2), 0.0, 0.0, np.zeros(1, complex), 0, vectors=vectors)


@pytest.mark.parametrize(
    ("unstable", "labels", "expected"),
    [
        ([0, 0, 0], [], []),
        ([0, 0, 1], [], [2]),
        ([0, 0, 1], [(1, label("LP"))], []),
        ([0, 0, 2], [(1, label("LP"))], [2]),
        ([0, 0, 2], [(1, label("HB"))], []),
        ([0, 0, 4], [(1, label("HB"))], [2]),
        ([0, 0, 4], [(1, label("HB", kernel=2))], []),
        ([0, 0, 0, 4], [(1, label("HB")), (2, label("HB"))], []),
        ([0, 2, 0, 1, 1], [(3, label("BP"))], [1, 2]),
        ([1, 0, 3], [], [1, 2]),
    ],
)
def test_every_change_needs_a_label(unstable, labels, expected):
    assert unexplained(np.array(unstable), labels) == expected


def test_the_critical_values_of_a_birth_are_not_counted():
    assert unexplained(np.array([1, 0, 1]), [], [1]) == []
