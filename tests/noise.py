"""Rounding noise, to find tests and code that sit on rounding: `CONTIN_TEST_NOISE=1 pytest ...`, with any number.

Matrices that numpy, scipy and LAPACK get are changed by two units in the last place, entry by entry (zeros stay), and
the first step of every curve by a part in 1e9, reproducibly: a test that another processor may turn over is turned over
by one of a few numbers.
"""

from __future__ import annotations

import functools
import zlib
from typing import Any

import numpy as np
import scipy.linalg
import scipy.sparse.linalg
from scipy.linalg import lapack

ULPS = 2.0
STEP = 1e-9
NUMPY = "solve eig eigvals svd qr inv lstsq eigh eigvalsh pinv slogdet det".split()
SCIPY = "solve eig eigvals svd qr inv lstsq schur null_space lu_factor expm".split()


def add_noise(seed: int) -> None:
    """From now on, in this process."""
    for module, names in ((np.linalg, NUMPY), (scipy.linalg, SCIPY), (lapack, ["dgetrf"])):
        for name in names:
            setattr(module, name, _with_noise(getattr(module, name), seed))
    splu = scipy.sparse.linalg.splu

    def noisy_splu(matrix: Any, *arguments: Any, **options: Any) -> Any:
        matrix = matrix.copy()
        matrix.data = noisy(matrix.data, seed)
        return splu(matrix, *arguments, **options)

    scipy.sparse.linalg.splu = noisy_splu
    _shift_first_steps(1.0 + STEP * np.random.default_rng(seed).uniform(-1.0, 1.0))


def noisy(matrix: Any, seed: int) -> Any:
    """The matrix with noise that is the same for the same matrix."""
    matrix = np.asarray(matrix)
    if matrix.dtype.kind not in "fc" or matrix.size == 0:
        return matrix
    chance = np.random.default_rng([seed, zlib.crc32(np.ascontiguousarray(matrix).tobytes())])
    return matrix * (1.0 + ULPS * np.finfo(float).eps * chance.uniform(-1.0, 1.0, matrix.shape))


def _with_noise(function: Any, seed: int) -> Any:
    @functools.wraps(function)
    def wrapped(matrix: Any, *arguments: Any, **options: Any) -> Any:
        return function(noisy(matrix, seed), *arguments, **options)

    return wrapped


def _shift_first_steps(factor: float) -> None:
    from contin.continuation.settings import Settings

    original = Settings.first_step.fget  # type: ignore[attr-defined]
    Settings.first_step = property(lambda self: min(original(self) * factor, self.max_step))  # type: ignore
