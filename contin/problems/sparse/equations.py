"""What bordered solves need of equations F(z) = 0 with a sparse Jacobian, whichever problem they belong to."""

from __future__ import annotations

from typing import Protocol

from contin.abi import Array, Vector
from contin.continuation.corrector import Correctable
from contin.linalg.linear import Linear


class SparseEquations(Protocol):
    """F(z) (n,), z = (u, parameter) (n + 1,)."""

    @property
    def n(self) -> int:
        """Number of equations."""

    def residual(self, z: Array) -> Array:
        """F, unscaled; not finite where F is not."""

    def linear(self, z: Array) -> Linear | None:
        """F_u at z; None where it is not finite."""

    def parameter_slope(self, z: Array) -> Array:
        """F_p (n,)."""

    def form(self, z: Array, *directions: Vector) -> Vector:
        """D^k F(z)[d1, ..., dk], k >= 2, directions (n + 1,)."""


class CorrectedEquations(Correctable, Protocol):
    """Equations whose curve can be followed."""

    def residual(self, z: Array) -> Array:
        """F, unscaled."""
