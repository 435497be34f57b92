"""[dF/du dF/dp] of an analytic function by complex steps along all axes at once.

Of a function of few states what stands around its calls takes longer than they do: names of parameters, checks and
contexts of warnings are made once for all columns. Where anything is wrong with one of them, whoever asks goes from
column to column and says it in words.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Final

import numpy as np

from contin.abi import Array, Vector

COMPLEX_STEP: Final = 1e-30


def columns(
    residual: Callable[..., Any], u: Array, p: Array, names: Sequence[str], sizes: Array, first: int = 0
) -> Array | None:
    """The columns of [dF/du dF/dp] (n, n + m) from `first` on; None where a call fails or returns no numbers (n,).

    sizes : (n + m,) of u and p, which steps are relative to.
    """
    n, width = len(u), len(sizes)
    steps = COMPLEX_STEP * np.maximum(np.abs(np.concatenate([u, p])), sizes)
    lengths, others = steps.tolist(), dict(zip(names, p.astype(complex).tolist(), strict=True))
    states = np.empty((width - first, n), complex)  # a row for each call: a function may change what it is given
    states[:] = u
    found = []
    try:
        for j, row in enumerate(states, first):
            given = dict(others)
            if j < n:
                row[j] += 1j * lengths[j]
            else:
                given[names[j - n]] += 1j * lengths[j]
            found.append(np.array(residual(row, given)))
    except Exception:  # noqa: BLE001
        return None  # whoever asks calls it again, column by column, and says it in words
    if any(value.shape != (n,) or value.dtype.kind not in "biufc" for value in found):
        return None
    return slope(np.array(found), steps[first:, None]).T


def slope(values: Vector, steps: Array | float) -> Array:
    """The derivative that complex steps of these lengths show; NaN where there is no value: what failed is real, and
    without an imaginary part the slope would be 0."""
    return np.where(np.isfinite(values), np.imag(values) / steps, np.nan)
