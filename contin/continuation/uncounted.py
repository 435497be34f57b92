"""Rows of a branch whose eigenvalues or multipliers could not be computed: their `unstable` is no count."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array


def uncounted(eigenvalues: NDArray[np.complex128], excused: Collection[int]) -> list[int]:
    """Rows none of whose eigenvalues (rows, k) is a number, but for those that are `excused` (births, labels)."""
    if not eigenvalues.shape[1]:
        return []
    unknown = np.flatnonzero(np.isnan(eigenvalues).all(axis=1))
    return [int(row) for row in unknown if row not in excused]


def uncounted_note(rows: Sequence[int], columns: dict[str, Array], parameter: str, count: int) -> list[str]:
    """A note that says where, for rows found by `uncounted`."""
    if not rows:
        return []
    where = f", first at {parameter} = {columns[parameter][rows[0]]:.6g}" if parameter in columns else ""
    return [
        f"eigenvalues or multipliers could not be computed in {len(rows)} of {count} rows{where}: they are not called "
        "stable, their `unstable` is not known, and special points between them may be missing"
    ]
