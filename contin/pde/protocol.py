"""What the problem of a partial differential equation asks of its equations on a grid."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final, Protocol

from scipy.sparse import csc_matrix

from contin.abi import Array, Vector
from contin.errors import InputError
from contin.pde.grid import Grid
from contin.pde.local_formula import Values
from contin.pde.slots import Slots
from contin.pde.unknowns import Unknowns

LARGEST_FULL: Final = 3000  # unknowns, where the Jacobian has full rows: 72 MB


class Equations(Protocol):
    """u' = F(u, p) on the unknowns of a grid."""

    n: int
    unknowns: Unknowns
    grid: Grid
    slots: Slots

    def value(self, u: Vector, p: Values) -> Vector:
        """F, of one state (n,) or of K (n, K)."""
        ...

    def jacobian(self, u: Array, p: Values) -> csc_matrix:
        """dF/du."""
        ...

    def jacobians(self, u: Array, p: Values) -> list[csc_matrix]:
        """dF/du at K states u (n, K)."""
        ...

    def forms(self, u: Array, p: Values, directions: Sequence[tuple[Array, Mapping[str, float]]]) -> Array:
        """D^k F[d_1, ..., d_k], directions as (states, {parameter: rate})."""
        ...

    def fields(self, u: Array, p: Values) -> dict[str, Array]:
        """Each field at all nodes."""
        ...


def check_full(equations: Equations, key: str) -> None:
    """Full rows take room: more unknowns than that are refused."""
    if equations.n > LARGEST_FULL:
        raise InputError(
            f"`{key}` makes the Jacobian full, and {equations.n} unknowns are more than {LARGEST_FULL}, its largest: "
            "take fewer points, or method: fourier"
        )
