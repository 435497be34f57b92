"""What functions that serve several problems need of one: less than the engine's contract (`continuation.problem`)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from contin.abi import Array

if TYPE_CHECKING:
    from contin.continuation.sample import Frame, Sample
    from contin.continuation.settings import Settings
    from contin.systems.protocol import System


class HasSystem(Protocol):
    """Solutions of a system."""

    @property
    def system(self) -> System: ...


class InOneParameter(HasSystem, Protocol):
    """Solutions of a system with parameter values `base`, of which entry `active` varies."""

    @property
    def base(self) -> Array: ...
    @property
    def active(self) -> int: ...
    @property
    def angle_periods(self) -> Array: ...
    def full_parameters(self, z: Array) -> Array:
        """All parameter values at z."""


class DenseInOneParameter(InOneParameter, Protocol):
    """Such solutions with a matrix whose eigenvalues decide stability."""

    @property
    def n(self) -> int: ...
    @property
    def is_map(self) -> bool: ...
    def linearise(self, z: Array) -> tuple[Array, Array]:
        """F (n,) and [F_u F_p] (n, n + 1)."""

    def linear_part(self, z: Array) -> Array:
        """(n, n)"""

    def linear_parts(self, z: Array) -> Array:
        """The same at rows z, (m, n, n)."""


class Probing(Protocol):
    """A curve of which single points can be asked for."""

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        """See `contin.continuation.problem.Problem`."""


class Dense(Protocol):
    """F(z) = 0 with a dense Jacobian; `linear_part` is the matrix whose eigenvalues decide stability."""

    @property
    def is_map(self) -> bool: ...
    @property
    def angle_periods(self) -> Array: ...
    def linearise(self, z: Array) -> tuple[Array, Array]:
        """F (n,) and [F_u F_p] (n, n + 1)."""

    def linear_part(self, z: Array) -> Array:
        """(n, n)"""
