"""A kernel that nobody calls: compiling it loads the parts of numba that most kernels need."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from contin.kernels.compile import allocating

NAME: Final = "building.warming.everything"


@allocating("i, f, f1, f2, i1 -> f")
def everything(n, x, v, a, k):
    """Numbers, arrays, minima and maxima."""
    total = 0.0
    w = np.empty(n + 1)
    b = np.empty((n, n))
    for i in range(n):
        k[i] = max(i, n) - min(i, n)
        w[i] = max(x, v[i]) + min(x, v[i])
        for j in range(v.size):
            b[i, j] = max(a[i, j], x, 1.0) * math.sqrt(abs(v[j]))
            if a[i, j] < 0.0 and not math.isfinite(b[i, j]):
                total -= b[i, j] / w[i]
    return total
