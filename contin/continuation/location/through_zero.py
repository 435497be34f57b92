"""Test functions that are zero to their rounding errors on rows of a march and are not before and after: what is there?

No sign changes between such rows, and an event between them is not seen.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.problem import Problem
from contin.continuation.sample import Chunk
from contin.continuation.segment import Row

OWN: Final = 2  # the first tests are those of turning and branching: the parameter may stand still along a curve


@dataclass(eq=False)
class ThroughZero:
    """Looks at the chunks of an arm, one after the other."""

    problem: Problem
    last: Array | None = None  # signs of the tests on the last row on which they had one
    zeros: dict[int, tuple[Array, Array]] = field(default_factory=dict)  # tests that are zero now: signs before, then

    def passed(self, chunk: Chunk, labelled: Sequence[Row]) -> list[int]:
        """Rows of the chunk at which tests are no longer zero, and which no label explains."""
        signs = np.sign(chunk.tests)
        signs[:, :OWN] = 1.0
        if self.last is None:
            self.last = signs[0].copy()
        if not self.zeros and signs.all():
            self.last = signs[-1].copy()
            return []
        told = {self._test_of(row.point.type) for row in labelled}
        rows = []
        for k, row in enumerate(signs):
            for test in np.flatnonzero((row == 0.0) & (self.last != 0.0)).tolist():
                self.zeros.setdefault(test, (self.last, row))
            for test in [test for test in self.zeros if row[test] != 0.0]:
                before, first = self.zeros.pop(test)
                if test not in told and not _is_elsewhere(first, before, row):
                    rows.append(k)
            self.last = np.where(row != 0.0, row, self.last)
        return sorted(set(rows))

    def _test_of(self, type_: str) -> int | None:
        try:
            return self.problem.test_of(type_)
        except (KeyError, ValueError):  # no point of a curve like this one, or a user value
            return None


def _is_elsewhere(zero: Array, before: Array, after: Array) -> bool:
    """True where another test has another sign meanwhile: there the one that is zero is not defined (beyond BT, R1)."""
    meanwhile: NDArray[np.bool_] = (zero * before < 0.0) & (zero * after < 0.0)
    return bool(meanwhile.any())
