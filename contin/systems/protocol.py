"""The contract of a system: u' = f(u, p), u -> f(u, p) or 0 = f(u, p), with everything the numerics ask of it.

Compiled models (`contin.lowering.system`), Python functions (`contin.systems.functions.function_system`) and iterates
of maps (`contin.systems.iterate`) keep it. Rules for implementers:

1.  u is (n,), p (m,) (with the time appended where `is_forced`), both in the order of the names; nothing is checked.
2.  Nothing is raised where the equations have no value: results are NaN there; `why_not_finite` says why.
3.  `jacobian` gives the value too, and the derivatives in states and parameters, (n, n + m).
4.  `derivative` takes directions (n + m,), real or complex, and is linear in each of them.
5.  `observables` and `symmetry` take rows of points; everything else one point.
6.  `switches` has `n_switches` components, whose changes of sign are where the equations change formula; none: smooth.
7.  `jacobian_address` is the machine code of `jacobian` (layout in `contin.abi`), or `NO_FUNCTION`; an address is valid
    while the system lives, so whoever keeps an address keeps the system.
8.  A system has no memory that changes its values: two calls with the same arguments give the same digits.
9.  Methods may be called from several threads.
10. A copy or a pickle carries the model, and compiles again.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from contin.abi import Address, Array, Vector


class Named(Protocol):
    """Something with a name."""

    @property
    def name(self) -> str: ...


class Limit(Protocol):
    """What must hold where equations are an approximation."""

    @property
    def beyond(self) -> str:
        """What to say where it does not."""

    @property
    def accuracy(self) -> float:
        """Relative error of the equations that it lets pass, where they hold quadratures."""


class Described(Protocol):
    """What a system's model says beside its equations."""

    @property
    def name(self) -> str: ...
    @property
    def symmetries(self) -> Sequence[Named]: ...
    def periods(self, overrides: Mapping[str, float] | None = None) -> Array:
        """(n,), 0 for states that are not angles."""

    def parameter_range(self, name: str, overrides: Mapping[str, float] | None = None) -> tuple[float, float] | None:
        """The declared range of a parameter."""

    def default_parameters(self, overrides: Mapping[str, float] | None = None) -> dict[str, float]:
        """Every parameter's value."""


class System(Protocol):
    """What the numerics need of equations; see the rules at the head of this file."""

    @property
    def model(self) -> Described: ...
    @property
    def kind(self) -> str:
        """flow, map, bvp or algebraic"""

    @property
    def n(self) -> int: ...
    @property
    def m(self) -> int: ...
    @property
    def p_size(self) -> int:
        """m, or m + 1 where the time is appended."""

    @property
    def state_names(self) -> tuple[str, ...]: ...
    @property
    def parameter_names(self) -> tuple[str, ...]: ...
    @property
    def observable_names(self) -> tuple[str, ...]: ...
    @property
    def is_forced(self) -> bool: ...
    @property
    def n_switches(self) -> int: ...
    @property
    def jacobian_address(self) -> Address: ...
    @property
    def limits(self) -> Sequence[Limit]:
        """Where the equations are an approximation: what must not be negative; `margins` gives the values."""

    def value(self, u: ArrayLike, p: ArrayLike) -> Array:
        """f(u, p), (n,)."""

    def jacobian(self, u: ArrayLike, p: ArrayLike) -> tuple[Array, Array]:
        """f (n,) and df/d(u, p), (n, n + m)."""

    def jacobians(self, u: Array, p: Array) -> tuple[Array, Array]:
        """`jacobian` at N points, u (N, n) and p (N, m): (N, n) and (N, n, n + m)."""

    def derivative(self, u: ArrayLike, p: ArrayLike, *directions: ArrayLike) -> Vector:
        """D^k f[v_1, ..., v_k], (n,)."""

    def derivatives(self, u: Array, p: Array, *directions: Vector) -> Vector:
        """`derivative` at N points, (N, n): u (N, n), p (N, m), directions (N, n + m)."""

    def gradient(self, u: ArrayLike, p: ArrayLike, v: ArrayLike) -> Vector:
        """The matrix D^2 f[v, .], (n, n + m)."""

    def observables(self, u: ArrayLike, p: ArrayLike) -> Array:
        """(N, k) at N points."""

    def symmetry(self, name: str, u: ArrayLike, p: ArrayLike) -> Array:
        """Images of N states, (N, n)."""

    def switches(self, u: ArrayLike, p: ArrayLike) -> Array:
        """(n_switches,)"""

    def margins(self, u: ArrayLike, p: ArrayLike) -> Array:
        """Of the `limits` at N points, (N, number of limits): the equations hold where none is negative."""

    def why_not_finite(self, u: ArrayLike, p: ArrayLike) -> str | None:
        """What is not finite at this point, and why."""

    def why_observables_not_finite(self, u: ArrayLike, p: ArrayLike) -> str | None:
        """Which observable is not finite at this point, and why."""

    def trouble_near(self, u: Array, p: Array) -> str | None:
        """Why the equations may fail near this point, where that was seen."""


@runtime_checkable
class HasSlopes(Protocol):
    """A system that may have its Jacobian sparse."""

    def slopes(self, u: Array, p: Array) -> Any:
        """df/du, (n, n), an array or a scipy.sparse matrix."""


def is_timeless(system: System) -> bool:
    """True for equations that vanish, without a time: the unit of each says nothing about its state's."""
    return system.kind == "algebraic"


def one_by_one(jacobian: Callable[[Array, Array], tuple[Array, Array]], u: Array, p: Array) -> tuple[Array, Array]:
    """`System.jacobians` of a system that has no faster way."""
    parts = [jacobian(*place) for place in zip(u, p, strict=True)]
    return np.array([f for f, _ in parts]), np.array([matrix for _, matrix in parts])


def form_by_form(derivative: Callable[..., Vector], u: Array, p: Array, directions: Sequence[Vector]) -> Vector:
    """`System.derivatives` of a system that has no faster way."""
    return np.array([derivative(*place) for place in zip(u, p, *directions, strict=True)])
