"""Joining the segments of a branch into arrays, with labelled points as rows among them."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.outcome import Verified
from contin.continuation.segment import Segment

REPEATED: Final = 1e-13  # scaled: a row this close to a labelled point beside it is that point

Block = tuple[Array, Array, NDArray[np.int64], NDArray[np.complex128]]


class Rows:
    """Blocks of rows (z, raw tangents, unstable counts, eigenvalues) in order, and which rows are labelled points."""

    def __init__(self) -> None:
        self._blocks: list[Block] = []
        self._length = 0
        self.labelled: list[tuple[int, Verified, Array]] = []  # row, point, the metric it was found in
        self.jumps: list[int] = []  # rows before which unstable values change for want of smoothness

    def __len__(self) -> int:
        return self._length

    def add_block(
        self, z: Array, tangents: Array, unstable: NDArray[np.int64], eigenvalues: NDArray[np.complex128]
    ) -> None:
        if len(z):
            self._blocks.append((z, tangents, unstable, eigenvalues))
            self._length += len(z)

    def add_point(self, point: Verified, tangent: Array, scale: Array) -> None:
        self.label(self._length, point, scale)
        self.add_block(point.z[None], tangent[None], np.array([point.unstable]), point.eigenvalues[None])

    def label(self, row: int, point: Verified, scale: Array) -> None:
        self.labelled.append((row, point, scale))

    def add_segment(self, segment: Segment, sense: float = 1.0) -> None:
        """sense : -1 where the order will be turned round."""
        raw = segment.tangents * (sense * segment.scale)
        done = 0
        self.jumps += [self._length + sum(m.before <= k for m in segment.found) + k - 1 for k in segment.jumps]
        for mark in segment.found:
            k = min(max(mark.before - 1, done), len(segment.z))
            self.add_block(segment.z[done:k], raw[done:k], segment.unstable[done:k], segment.eigenvalues[done:k])
            self.add_point(mark.point, mark.tangent * (sense * segment.scale), segment.scale)
            done = k
        self.add_block(segment.z[done:], raw[done:], segment.unstable[done:], segment.eigenvalues[done:])

    def reverse(self) -> None:
        """Turn the order round; the tangents are those of the new one already."""
        self._blocks = [(z[::-1], t[::-1], u[::-1], e[::-1]) for z, t, u, e in reversed(self._blocks)]
        self.labelled = [(self._length - 1 - row, point, scale) for row, point, scale in reversed(self.labelled)]
        self.jumps = [self._length - row for row in reversed(self.jumps)]

    def joined(self, start_row: int) -> tuple[Block, int]:
        """All rows as four arrays, each point once, and the row of the start among them."""
        block = self._stacked_blocks()
        self._blocks = [block]  # those of segments are let go: together they are as large
        same = self._repeated(block[0])
        if not same:
            return block, start_row
        stands_for = np.arange(self._length)
        stands_for[list(same)] = list(same.values())
        stands_for = stands_for[stands_for]
        kept = np.flatnonzero(stands_for == np.arange(len(stands_for)))
        moved = np.searchsorted(kept, stands_for)
        self.labelled = [(int(moved[row]), point, scale) for row, point, scale in self.labelled]
        self.jumps = [int(moved[min(row, len(moved) - 1)]) for row in self.jumps]
        z, tangents, unstable, eigenvalues = block
        return (z[kept], tangents[kept], unstable[kept], eigenvalues[kept]), int(moved[start_row])

    def _repeated(self, z: Array) -> dict[int, int]:
        """The rows that are others once more, and which: a bound, a start or a label may lie on a labelled point."""
        stands_for = {}
        labelled = {row for row, _, _ in self.labelled}
        for row, _, scale in self.labelled:
            for beside in (row - 1, row + 1):
                if 0 <= beside < len(z) and (np.abs(z[beside] - z[row])[-len(scale) :] <= REPEATED * scale).all():
                    stands_for[beside] = min(beside, row) if beside in labelled else row
        return stands_for

    def _stacked_blocks(self) -> Block:
        """All rows as four arrays, padded with NaN where blocks differ: eigenvalues at the end, unknowns in front."""
        width = max(block[3].shape[1] for block in self._blocks)
        padded = []
        for block in self._blocks:
            values = block[3]
            if values.shape[1] < width:
                values = np.hstack([values, np.full((len(values), width - values.shape[1]), np.nan + 0j)])
            padded.append(values)
        z, tangents = _stacked([block[0] for block in self._blocks]), _stacked([block[1] for block in self._blocks])
        unstable = np.concatenate([block[2] for block in self._blocks])
        return z, tangents, unstable.astype(int), np.concatenate(padded)


def _stacked(blocks: list[Array]) -> Array:
    """Blocks of rows below each other, NaN in front of shorter ones (the parameter stays last)."""
    width = max(block.shape[1] for block in blocks)
    if all(block.shape[1] == width for block in blocks):
        return np.concatenate(blocks)
    whole = np.empty((sum(len(block) for block in blocks), width))
    row = 0
    for block in blocks:
        own = whole[row : row + len(block)]
        own[:, : width - block.shape[1]] = np.nan
        own[:, width - block.shape[1] :] = block
        row += len(block)
    return whole
