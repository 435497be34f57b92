"""What one chunk gave to a branch: its accepted rows, and the labelled points among them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.outcome import Verified
from contin.continuation.sample import Sample
from contin.continuation.sentence import Sentence


@dataclass(frozen=True, eq=False)
class Row:
    """A labelled point among the rows: it comes before row `before` of its chunk (row 0 is where that began)."""

    before: int
    length: float
    point: Verified
    tangent: Array  # scaled by the segment's scale


@dataclass(frozen=True, eq=False)
class Segment:
    """Accepted rows of one chunk (the row it began at not included) and the labelled points among them."""

    z: Array
    tangents: Array  # scaled
    unstable: NDArray[np.int64]
    eigenvalues: NDArray[np.complex128]
    scale: Array
    found: tuple[Row, ...] = ()
    notes: tuple[Sentence, ...] = ()
    jumps: tuple[int, ...] = ()  # numbers of rows, as of `Row.before`: unstable values change before them, see `Jump`
    hiding: int = 0  # notes that say that events may not have been told apart
    evaluations: int = 0

    @cached_property
    def extent(self) -> tuple[Array, Array]:
        """The least and the greatest of each unknown, (N,) each, of one row or more."""
        columns = np.ascontiguousarray(self.z.T)
        return columns.min(axis=1), columns.max(axis=1)

    @classmethod
    def single(cls, sample: Sample, scale: Array) -> Segment:
        """One row."""
        return cls(sample.z[None], sample.tangent[None], np.array([sample.unstable]), sample.eigenvalues[None], scale)

    @classmethod
    def labelled(cls, point: Verified, sample: Sample, scale: Array) -> Segment:
        """A labelled point with no other rows."""
        mark = Row(1, 0.0, point, sample.tangent)
        empty = np.empty((0, len(sample.z)))
        values = np.empty((0, len(sample.eigenvalues)), complex)
        return cls(empty, empty, np.empty(0, np.int64), values, scale, (mark,))

    def cut(self, rows: int, found: Sequence[Row] | None = None) -> Segment:
        """The first rows, with these labelled points (by default those among them)."""
        kept = tuple(mark for mark in self.found if mark.before <= rows) if found is None else tuple(found)
        return replace(
            self, z=self.z[:rows], tangents=self.tangents[:rows], unstable=self.unstable[:rows],
            eigenvalues=self.eigenvalues[:rows], found=kept, jumps=tuple(k for k in self.jumps if k <= rows),
        )  # fmt: skip

    def ending_in(self, last: Sample) -> Segment:
        """The same rows but for the last one (a bound that was passed, say, is met exactly)."""
        z, tangents, unstable = self.z.copy(), self.tangents.copy(), self.unstable.copy()
        z[-1], tangents[-1], unstable[-1] = last.z, last.tangent, last.unstable
        eigenvalues = _with_last(self.eigenvalues, last.eigenvalues)
        return replace(self, z=z, tangents=tangents, unstable=unstable, eigenvalues=eigenvalues)


def _with_last(eigenvalues: NDArray[np.complex128], last: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """The rows with another last one, padded with NaN where it has more values than they, or fewer."""
    width = max(eigenvalues.shape[1], len(last))
    rows = np.full((len(eigenvalues), width), np.nan, complex)
    rows[:-1, : eigenvalues.shape[1]] = eigenvalues[:-1]
    rows[-1, : len(last)] = last
    return rows
