"""Unstable eigenvalues of a symmetric operator that have grown away from zero since the last point.

They come through zero, where they are seen, but beside a peak of a solution grow by half of themselves from one point
to the next, and many stable ones lie nearer to zero: what is nearest to zero holds them no more.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.linalg.eigen import SOLVED, Inverse, Spectrum
from contin.linalg.far_from_zero import SAME
from contin.linalg.followed import estimates, followed
from contin.linalg.linear import Linear

FAR: Final = 0.5  # part that the inverse leaves of an error of an eigenvector to an eigenvalue far from zero


def with_grown_ones(
    found: Spectrum, linear: Linear, inverse: Inverse, vectors: NDArray[np.complex128],
    before: NDArray[np.complex128] | None,
) -> tuple[Spectrum | None, float]:  # fmt: skip
    """Those nearest to zero with all unstable ones, followed from the last point, and how far the largest is.

    vectors : (n, k) eigenvectors at the last point, the unstable ones among them, `before` (n, j) at the one before it.
    None where they are not found.  Cost: k products, and where some have grown a few times k solves.
    """
    reach = float(np.max(estimates(linear, vectors), initial=0.0))
    edge = (1.0 - SAME) * float(np.abs(found.values).max(initial=0.0))  # up to which both ways have the same ones
    if not reach > edge:
        return found, reach

    def solved(columns: Array) -> Array:
        return np.column_stack([np.real(inverse.solve(c, SOLVED)) for c in columns.T])

    more = followed(linear, solved, FAR, vectors, before, symmetric=True)
    if more is None:
        return None, reach
    apart = np.abs(found.values[:, None] - more.values[None]) > SAME * np.abs(found.values)[:, None]
    near = (found.values.real <= edge) | apart.all(axis=1)  # and those that the last point's vectors know nothing of
    far = more.values.real > edge
    both = np.concatenate([found.values[near], more.values[far]])
    return replace(found, values=both, vectors=np.hstack([found.vectors[:, near], more.vectors[:, far]])), reach
