"""Curves of special points of equations without time (kind: algebraic): eigenvalues mean nothing there.

They depend on the order and the signs in which the equations are written; cusps and degenerate branch points do not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.outcome import Outcome, Verified
from contin.continuation.sample import Chunk, Sample

CONSIDERED: Final = 3  # tests: of the curve itself, and that of CP (of folds) or DP (of branch points)
NONE: Final = np.zeros(0, complex)


def without(tests: Array) -> Array:
    """Tests of eigenvalues set aside, along the last axis."""
    found = tests.copy()
    found[..., CONSIDERED:] = 1.0
    return found


def chunk_without(chunk: Chunk) -> Chunk:
    """A chunk without eigenvalues."""
    count = len(chunk)
    still, none = np.zeros(count, np.int64), np.zeros((count, 0), complex)
    return replace(chunk, tests=without(chunk.tests), unstable=still, eigenvalues=none)


def sample_without(sample: Sample | None) -> Sample | None:
    return sample and replace(sample, tests=without(sample.tests), unstable=0, eigenvalues=NONE)


def point_without(found: Outcome) -> Outcome:
    return replace(found, eigenvalues=NONE, unstable=0) if isinstance(found, Verified) else found


def points_without(found: Sequence[Outcome]) -> list[Outcome]:
    return [point_without(one) for one in found]
