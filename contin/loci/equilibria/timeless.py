"""Curves of special points of equations without time (kind: algebraic): eigenvalues mean nothing there.

They depend on the order and the signs in which the equations are written; cusps and degenerate branch points do not,
nor do kernels of two dimensions: where one is passed det [A p; q^T 0] changes its sign, q and p the null vectors of A.
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
ALIKE: Final = 0.5  # cosine of null vectors at neighbouring rows: below it their senses are not told
SINGULAR: Final = 1e-8  # the last but one of the singular values beside the largest: zero to rounding at a row
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


def where_two_vanish(matrices: Array) -> list[int]:
    """The rows up to which A (rows, n, n), singular along a curve, has passed a kernel of two dimensions."""
    if matrices.shape[-1] < 2:
        return []
    left, values, right = np.linalg.svd(matrices)
    p, q = left[:, :, -1], right[:, -1]
    found, last, known = [], -1, 0.0
    for k, row in enumerate(values):
        if not row[-2] > SINGULAR * row[0]:
            found.append(k)
            last, known = -1, 0.0  # what led there is told
            continue
        border = np.block([[matrices[k] / row[0], p[k][:, None]], [q[k][None], np.zeros((1, 1))]])
        sign = float(np.linalg.slogdet(border)[0])
        if last >= 0:
            cosines = float(p[k] @ p[last]), float(q[k] @ q[last])
            turned = float(np.sign(cosines[0] * cosines[1]))  # of the bordered determinant, where one is turned round
            if min(abs(c) for c in cosines) > ALIKE and sign * turned * known < 0.0:
                found.append(k)
        last, known = k, sign
    return found
