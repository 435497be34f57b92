"""Eigenvalues along a branch as columns, for pictures: real parts, or moduli of multipliers, in falling order."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array

if TYPE_CHECKING:
    from contin.continuation.branch import Branch

NAMES: Final = ("eigenvalues", "multipliers")
MOST: Final = 12  # curves in a picture: the largest


def spectral_columns(branch: Branch) -> dict[str, Array]:
    """`eigenvalues.1` .. (real parts) or `multipliers.1` .. (moduli) at the rows, the largest first, and the largest
    alone under the bare name; nothing for branches without stability."""
    values = np.asarray(branch.eigenvalues)
    if not values.size or "stable" not in branch.columns:
        return {}
    name = NAMES[1] if branch.multiplier_kind else NAMES[0]
    sizes = np.abs(values) if branch.multiplier_kind else values.real
    ordered = -np.sort(-np.where(np.isfinite(sizes), sizes, -np.inf), axis=1)
    ordered = np.where(np.isfinite(ordered), ordered, np.nan)[:, :MOST]
    return {name: ordered[:, 0], **{f"{name}.{k + 1}": ordered[:, k] for k in range(ordered.shape[1])}}


def asked(names: object) -> bool:
    """Whether one of these columns is among what a picture shows."""
    listed = [names] if isinstance(names, str) else list(names) if isinstance(names, list | tuple) else []
    return any(str(name).partition(".")[0] in NAMES for name in listed)
