"""Points of codimension two in coordinates whose derivatives have large rounding errors: stated errors hold them.

On these systems coefficients were off by up to 500 times what was stated (they were sums over derivatives that cancel),
and Chenciner points were missed without a word: their test is zero to its errors on rows beside them.
"""

from __future__ import annotations

import numpy as np
import pytest

from contin.continuation.location.through_zero import ThroughZero
from contin.continuation.segment import Row
from tests.truth import codim2_of_flows as flows
from tests.truth import codim2_of_maps as maps
from tests.truth.ledger import Ledger
from tests.truth.planted_curves import Hidden
from tests.truth.test_planted_codim2 import judge

KINDS = {"CH": (0, 3, 500.0), "ZH": (3, 3, 400.0), "HH": (4, 4, 800.0)}  # place in the draw, states, condition


def drawn(kind: str, seed: int) -> Hidden:
    random = np.random.default_rng(seed)
    cores = (
        maps.chenciner(random, 0.1), maps.chenciner(random, 1e-3), maps.generalised_flip(random, 1e-3),
        flows._ZeroHopf(random).folds(), flows.double_hopf(random),
    )  # fmt: skip
    place, n, condition = KINDS[kind]
    return Hidden(cores[place], n, condition, seed)


@pytest.mark.parametrize(
    ("kind", "seed"),
    [("CH", 32), ("ZH", 22), ("HH", 15)],  # the long version takes 120 of each
)
@pytest.mark.seldom
def test_points_are_found_within_their_errors(kind, seed):
    ledger = Ledger()
    judge(ledger, drawn(kind, seed))
    ledger.assert_clean()


@pytest.mark.long
@pytest.mark.parametrize("kind", list(KINDS))
def test_many_points_are_found_within_their_errors(kind):
    ledger = Ledger()
    for seed in range(120):
        judge(ledger, drawn(kind, seed))
    ledger.assert_clean()


class _Problem:
    """Test 3 watches CH."""

    def test_of(self, type_: str) -> int | None:
        return {"CH": 3}.get(type_)


def _chunk(*tests: tuple[float, float]) -> object:
    """Rows with tests 2 and 3."""

    class Rows:
        pass

    rows = Rows()
    rows.tests = np.array([(0.0, 1.0, *row) for row in tests])
    return rows


@pytest.mark.parametrize(
    ("tests", "rows"),
    [
        ([(1, 2), (1, 0), (1, -2)], [2]),
        ([(1, 2), (1, 0), (1, 0), (1, 2)], [3]),
        ([(1, 0), (1, 0), (1, 2)], []),  # never had a sign
        ([(1, 2), (-1, 0), (1, -2)], []),  # the curve is of another kind meanwhile: beyond a BT
        ([(1, 2), (1, 1), (1, -1)], []),  # seen as any event
    ],
)
def test_tests_that_are_zero_on_rows_between_others_are_told(tests, rows):
    assert ThroughZero(_Problem()).passed(_chunk(*tests), []) == rows


def test_tests_that_are_zero_across_chunks_are_told():
    looking = ThroughZero(_Problem())
    assert looking.passed(_chunk((1, 2), (1, 0)), []) == []
    assert looking.passed(_chunk((1, 0), (1, -2)), []) == [1]


def test_a_label_explains_a_test_that_is_zero():
    class Point:
        type = "CH"

    looking = ThroughZero(_Problem())
    label = Row(1, 0.0, Point(), np.zeros(1))
    assert looking.passed(_chunk((1, 2), (1, 0), (1, -2)), [label]) == []
