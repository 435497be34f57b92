"""Inner products and norms of long vectors without BLAS.

BLAS splits a dot product of more than 10,000 numbers over threads, which on a busy machine wait milliseconds for
each other.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray


def dot(a: NDArray[Any], b: NDArray[Any]) -> float:
    """sum a_i b_i of real vectors."""
    return float(np.einsum("i,i->", a, b))


def norm(a: NDArray[Any]) -> float:
    """Euclidean norm of a real or complex vector."""
    return math.sqrt(float(np.einsum("i,i->", a, a.conj()).real))
