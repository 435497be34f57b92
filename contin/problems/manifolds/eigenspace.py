"""The linear part of a manifold: the stable or unstable eigenspace, from which it is grown."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from contin.abi import Array
from contin.errors import InputError
from contin.machine import elementary

Side = Literal["stable", "unstable"]
NEUTRAL: Final = 1e-9  # rates this small beside the largest are neither stable nor unstable


@dataclass(frozen=True, eq=False)
class Eigenspace:
    """Orthonormal real `basis` (n, k) of the eigenspace and its eigenvalues, the one nearest to neutral last."""

    basis: Array
    values: Array  # (k,) complex

    @property
    def dimension(self) -> int:
        return int(self.basis.shape[1])


def eigenspace(matrix: Array, side: Side, dimension: int | None, by_multipliers: bool) -> Eigenspace:
    """Of the stable or unstable eigenvalues, or of the `dimension` strongest of them (a strong manifold)."""
    values, vectors = np.linalg.eig(matrix)
    rates = elementary.log(np.maximum(np.abs(values), np.finfo(float).tiny)) if by_multipliers else values.real
    rates = rates if side == "unstable" else -rates
    level = NEUTRAL * float(np.max(np.abs(rates), initial=0.0))
    order = [int(k) for k in np.argsort(-rates) if rates[k] > level]
    wanted = len(order) if dimension is None else dimension
    if not order:
        raise InputError(f"manifold: there is no {side} direction; eigenvalues {_listed(values)}")
    if wanted > len(order):
        raise InputError(f"manifold: {len(order)} {side} directions, not {wanted}; eigenvalues {_listed(values)}")
    chosen = order[:wanted]
    if wanted < len(order) and np.isclose(values[chosen[-1]], np.conj(values[order[wanted]])):
        raise InputError(f"manifold: a pair of complex eigenvalues cannot be parted: `dimension: {wanted + 1}`")
    if by_multipliers and side == "stable" and not np.all(np.abs(values[chosen]) > 0.0):
        raise InputError("manifold: a zero multiplier has no inverse, along which a stable manifold is grown")
    columns = [vectors[:, k].imag if values[k].imag < 0.0 else vectors[:, k].real for k in chosen]
    basis = np.column_stack(columns)
    if wanted > 1:
        basis = np.linalg.qr(basis)[0]
    basis = basis / np.linalg.norm(basis, axis=0)
    signs = np.sign(basis[np.argmax(np.abs(basis), axis=0), np.arange(wanted)])
    return Eigenspace(basis * signs, values[chosen])


def _listed(values: Array) -> str:
    return ", ".join(f"{value:.4g}" for value in values)
