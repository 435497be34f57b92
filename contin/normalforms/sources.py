"""Jets of compiled systems, with any number of active parameters."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from contin.abi import Vector
from contin.normalforms.jet import DerivativeJet, Kind, Real


class Compiled(Protocol):
    """The part of contin.lowering.CompiledSystem that a jet needs."""

    def jacobian(self, u: ArrayLike, p: ArrayLike) -> tuple[Real, Real]: ...

    def derivative(self, u: ArrayLike, p: ArrayLike, *directions: ArrayLike) -> Vector: ...

    def derivatives(self, u: Real, p: Real, *directions: Vector) -> Vector: ...


def compiled_jet(
    system: Compiled, u: Real, p: Real, active: Sequence[int] = (), kind: Kind = "flow", scale: Real | None = None
) -> DerivativeJet:
    """The jet of a compiled system at (u, p); `active` are the positions of the active parameters in p.

    `scale` (n,): typical sizes of the states, where they are known.
    """
    n, m = len(u), len(p)
    columns = [*range(n), *(n + i for i in active)]

    def derivative(directions: tuple[Real, ...]) -> Real:
        full = np.zeros((len(directions), n + m))
        full[:, columns] = directions
        return np.asarray(system.derivative(u, p, *full), dtype=float)

    matrix = np.array(system.jacobian(u, p)[1])[:, :n]
    return DerivativeJet(matrix, derivative, len(active), kind, scale, at_once(system, u, p, active))


def at_once(
    system: Compiled, u: Real, p: Real, active: Sequence[int]
) -> Callable[[Sequence[tuple[Real, ...]]], Sequence[Real]]:
    """`DerivativeJet.several` of a system at (u, p)."""
    n, m = len(u), len(p)
    columns = [*range(n), *(n + i for i in active)]

    def several(wanted: Sequence[tuple[Real, ...]]) -> Sequence[Real]:
        count, order = len(wanted), len(wanted[0])
        full = np.zeros((order, count, n + m))
        full[:, :, columns] = np.array(wanted).swapaxes(0, 1)
        states, parameters = np.empty((count, n)), np.empty((count, m))
        states[:], parameters[:] = u, p
        return list(system.derivatives(states, parameters, *full).real)

    return several

