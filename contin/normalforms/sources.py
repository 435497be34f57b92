"""Jets of compiled systems, with any number of active parameters."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from contin.abi import Vector
from contin.normalforms.jet import DerivativeJet, Kind, Real


class Compiled(Protocol):
    """The part of contin.lowering.CompiledSystem that a jet needs."""

    def jacobian(self, u: ArrayLike, p: ArrayLike) -> tuple[Real, Real]: ...

    def derivative(self, u: ArrayLike, p: ArrayLike, *directions: ArrayLike) -> Vector: ...


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

    return DerivativeJet(np.array(system.jacobian(u, p)[1])[:, :n], derivative, len(active), kind, scale)
