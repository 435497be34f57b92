"""Critical normal forms of special orbits."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from contin.abi import Array
from contin.continuation.problem import Verified


def normal_form(problem: Any, point: Verified, scale: Array) -> Mapping[str, Any]:
    """Coefficients of the periodic normal form on the critical centre manifold."""
    return {}
