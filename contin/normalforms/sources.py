"""Jets of compiled systems, with any number of active parameters."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol, cast

import numpy as np
from numpy.typing import ArrayLike

from contin.abi import Vector
from contin.normalforms.jet import DerivativeJet, Kind, Real
from contin.offers import offers


class Compiled(Protocol):
    """The part of contin.lowering.CompiledSystem that a jet needs."""

    def jacobian(self, u: ArrayLike, p: ArrayLike) -> tuple[Real, Real]: ...

    def derivative(self, u: ArrayLike, p: ArrayLike, *directions: ArrayLike) -> Vector: ...

    def derivatives(self, u: Real, p: Real, *directions: Vector) -> Vector: ...


class Differenced(Protocol):
    """A system whose derivatives of second and higher order may be differences."""

    def with_other_differences(self) -> tuple[Compiled, ...]:
        """The same with other ones; () where they are exact to rounding."""


class Amplifying(Protocol):
    """A system that amplifies rounding errors inside, as iterates of a map."""

    def otherwise_rounded(self, sizes: Real | None) -> Sequence[Compiled]:
        """The same with other rounding errors; sizes (n,) of the states, where they are known."""


def compiled_jet(
    system: Compiled, u: Real, p: Real, active: Sequence[int] = (), kind: Kind = "flow", scale: Real | None = None
) -> DerivativeJet:
    """The jet of a compiled system at (u, p); `active` are the positions of the active parameters in p.

    `scale` (n,): typical sizes of the states, where they are known.
    """
    matrix = np.array(system.jacobian(u, p)[1])[:, : len(u)]
    return jet_of(matrix, system, u, p, active, kind, scale)


def jet_of(
    matrix: Real, system: Compiled, u: Real, p: Real, active: Sequence[int] = (), kind: Kind = "flow",
    scale: Real | None = None,
) -> DerivativeJet:  # fmt: skip
    """The same where F_u is known, (n, n)."""
    n, m = len(u), len(p)

    def derivative(directions: tuple[Real, ...]) -> Real:
        full = np.zeros((len(directions), n + m))
        for row, direction in zip(full, directions, strict=True):
            row[:n] = direction[:n]
            for k, place in enumerate(active, n):
                row[n + place] = direction[k]
        return np.asarray(system.derivative(u, p, *full), dtype=float)

    differenced = offers(type(system), "with_other_differences")
    others = cast(Differenced, system).with_other_differences() if differenced else ()
    otherwise = tuple(jet_of(matrix, other, u, p, active, kind, scale) for other in others)

    def rounded() -> Sequence[DerivativeJet]:
        others = cast(Amplifying, system).otherwise_rounded(scale)
        return [compiled_jet(other, u, p, active, kind, scale) for other in others]

    return DerivativeJet(
        matrix, derivative, len(active), kind, scale, at_once(system, u, p, active), otherwise=otherwise,
        rounded=rounded if offers(type(system), "otherwise_rounded") else None,
    )  # fmt: skip


def at_once(
    system: Compiled, u: Real, p: Real, active: Sequence[int]
) -> Callable[[Sequence[tuple[Real, ...]]], Sequence[Real]]:
    """`DerivativeJet.several` of a system at (u, p)."""
    n, m = len(u), len(p)

    def several(wanted: Sequence[tuple[Real, ...]]) -> Sequence[Real]:
        count, order = len(wanted), len(wanted[0])
        given = np.concatenate([tuples[k] for k in range(order) for tuples in wanted]).reshape(order, count, -1)
        full = np.zeros((order, count, n + m))
        full[:, :, :n] = given[:, :, :n]
        for k, place in enumerate(active, n):
            full[:, :, n + place] = given[:, :, k]
        states, parameters = np.empty((count, n)), np.empty((count, m))
        states[:], parameters[:] = u, p
        return list(system.derivatives(states, parameters, *full).real)

    return several

