"""Where the equations of Hopf points and tori are singular though no other curve crosses theirs."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from contin.continuation.sample import Chunk

CLOSE: Final = 0.1  # 1 - |cos(theta)|, or part of omega^2 elsewhere, up to which one step may lead through 0


def with_told_crossings(locus: str, chunk: Chunk) -> Chunk:
    """Without crossings where the vector of the equations is an eigenvector, too.

    So it may be where the pair is real (neutral saddles), and is where it touches the real axis as a multiple of the
    identity: there omega^2 or |cos(theta)| is extremal.
    """
    if locus not in ("HB", "NS") or not chunk.crossed:
        return chunk
    scalar, slopes = chunk.z[:, -3], chunk.tangents[:, -3]
    left = scalar if locus == "HB" else 1.0 - np.abs(scalar)  # negative where the pair is real
    close = left < CLOSE * (left.max() if locus == "HB" else 1.0)

    def tells(row: int) -> bool:
        touches = close[row] and slopes[row - 1] * slopes[row] < 0.0
        return not ((left[row - 1 : row + 1] < 0.0).any() or touches)

    return replace(chunk, crossed=tuple(row for row in chunk.crossed if row < len(chunk) and tells(row)))
