"""Jets from a compiled system (exact derivatives) and from any smooth function (differences)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import product
from math import prod
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contin.normalforms.jet import DerivativeJet, Kind, Real


class Compiled(Protocol):
    """The part of contin.lowering.CompiledSystem that a jet needs."""

    def jacobian(self, u: ArrayLike, p: ArrayLike) -> tuple[Real, Real]: ...

    def derivative(self, u: ArrayLike, p: ArrayLike, *directions: ArrayLike) -> NDArray[Any]: ...


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


def difference_jet(
    function: Callable[[Real], ArrayLike],
    z: Real,
    n: int,
    *,
    scale: ArrayLike = 1.0,
    kind: Kind = "flow",
    jacobian: Real | None = None,
) -> DerivativeJet:
    """The jet of F(z), z = (u, active parameters), at z by central differences with one Richardson step.

    `scale` is the length over which F changes in each entry of z (a typical size). A form of order k takes 2^(k+1)
    values of F (half of them for odd and even symmetry are not saved); its relative error is about eps^(4/(k + 4)):
    1e-10 for k = 2, 1e-9 for k = 3, 1e-7 for k = 5, if F is evaluated to eps. Coefficients that vanish by symmetry come
    out as that error, not as zero: pass a `state_error` of the same relative size.
    """
    lengths = np.broadcast_to(np.asarray(scale, dtype=float), z.shape)

    def at(directions: Sequence[Real], step: float) -> Real:
        k = len(directions)
        total = np.zeros(n)
        for signs in product((1.0, -1.0), repeat=k):
            shift = sum((s * d for s, d in zip(signs, directions, strict=True)), np.zeros(len(z)))
            total += prod(signs) * np.asarray(function(z + step * shift), dtype=float)
        return total / (2.0 * step) ** k

    def derivative(directions: tuple[Real, ...]) -> Real:
        sizes = [float(np.abs(d / lengths).max()) for d in directions]
        units = [d / size for d, size in zip(directions, sizes, strict=True)]
        k = len(directions)
        step = float(np.finfo(float).eps ** (1.0 / (k + 4))) / k
        fine, coarse = at(units, step), at(units, 2.0 * step)
        return np.asarray((4.0 * fine - coarse) / 3.0 * prod(sizes))

    if jacobian is None:
        eye = np.eye(len(z))
        jacobian = np.array([derivative((eye[j],)) for j in range(n)]).T
    return DerivativeJet(jacobian, derivative, len(z) - n, kind, np.array(lengths[:n]))
