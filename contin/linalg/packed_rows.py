"""A sparse matrix in half of its memory, for preconditioners: nine digits of an entry and its column, in one number."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array, Vector
from contin.kernels import multigrid as kernels
from contin.machine.threads import in_parts

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

DIGITS: Final = 2.0**31 - 1.0  # of an entry, in units of its matrix


@dataclass(frozen=True, eq=False)
class Packed:
    """Rows of a sparse matrix as `contin.kernels.multigrid` reads them, in units of `unit`; none of them is empty."""

    starts: Vector
    entries: Vector
    unit: float

    @classmethod
    def of(cls, matrix: csr_matrix, unit: float = 0.0) -> Packed:
        """unit : 0: such that the largest entry has all digits."""
        unit = unit or (float(np.abs(matrix.data).max(initial=0.0)) or 1.0) / DIGITS
        lengths = np.diff(matrix.indptr)
        starts = np.concatenate([[0], np.cumsum(np.maximum(lengths, 1))])
        entries = np.zeros(starts[-1], np.int64)
        filled = np.ones(len(entries), bool)
        filled[starts[:-1][lengths == 0]] = False
        entries[filled] = np.rint(matrix.data / unit).astype(np.int64) << 32 | matrix.indices
        entries[starts[1:] - 1] |= kernels.END
        return cls(starts, entries, unit)

    def times(self, x: Array, out: Array, add: bool = False) -> Array:
        """out = A x, or out + A x, in place; the first rows where `out` is longer."""
        product = kernels.add_product_rows if add else kernels.product_rows
        in_parts(0, len(self.starts) - 1, lambda a, b: product(self.starts, self.entries, self.unit, x, out, a, b))
        return out
