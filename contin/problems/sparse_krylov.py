"""Preconditioned GMRES, for matrix-free Jacobians and for large matrices whose latest factors are a few points old."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[Any]
Operator = Callable[[Vector], Vector]

TOLERANCE = 1e-11  # of the residual, relative to the right-hand side
RESTART = 60
RESTARTS = 8


def gmres(
    apply: Operator, precondition: Operator, right: Vector, start: Vector | None = None
) -> tuple[Vector, int, float]:
    """x with apply(x) = right (right preconditioning, Saad and Schultz 1986); returns x, iterations, relative residual.

    The search stops at `TOLERANCE`, or where the residual does not fall any more.
    """
    size = float(np.linalg.norm(right))
    x = np.zeros_like(right) if start is None else start
    if size == 0.0:
        return np.zeros_like(right), 0, 0.0
    used = 0
    before = np.inf
    for _ in range(RESTARTS):
        residual = right - apply(x) if used or start is not None else right
        beta = float(np.linalg.norm(residual))
        if not np.isfinite(beta):
            return x, used, np.inf
        if beta <= TOLERANCE * size or beta > 0.5 * before:
            return x, used, beta / size
        before = beta
        update, steps = _cycle(apply, precondition, residual / beta, beta, TOLERANCE * size)
        x = x + update
        used += steps
    return x, used, float(np.linalg.norm(right - apply(x))) / size


def _cycle(apply: Operator, precondition: Operator, v: Vector, beta: float, goal: float) -> tuple[Vector, int]:
    """One cycle of at most RESTART steps; the update of x and the number of steps."""
    basis = [v]
    hessenberg = np.zeros((RESTART + 1, RESTART), dtype=complex if np.iscomplexobj(v) else float)
    steps = 0
    y: Vector = np.zeros(0)
    for k in range(RESTART):
        w = apply(precondition(basis[k]))
        if np.iscomplexobj(w) and not np.iscomplexobj(hessenberg):
            hessenberg = hessenberg.astype(complex)
        block = np.array(basis)
        for _ in range(2):  # orthogonalised twice
            h = block.conj() @ w
            w = w - h @ block
            hessenberg[: k + 1, k] += h
        norm = float(np.linalg.norm(w))
        hessenberg[k + 1, k] = norm
        steps = k + 1
        e = np.zeros(k + 2)
        e[0] = beta
        y, *_ = np.linalg.lstsq(hessenberg[: k + 2, : k + 1], e, rcond=None)
        left = float(np.linalg.norm(e - hessenberg[: k + 2, : k + 1] @ y))
        if left <= goal or norm <= 1e-14 * beta:
            break
        basis.append(w / norm)
    combination = y @ np.array(basis[:steps])
    return precondition(combination), steps
