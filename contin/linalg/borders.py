"""Rows below a matrix that has columns beside it."""

from __future__ import annotations

import numpy as np

from contin.abi import Array


def below(columns: Array, rows: Array) -> Array:
    """[rows^T 0] below M and `columns` beside it."""
    return np.hstack([rows.T, np.zeros((rows.shape[1], columns.shape[1]))])
