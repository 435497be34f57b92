"""How well the equations and their slopes are known beside rounding: special points count it in their errors."""

from __future__ import annotations

from typing import Protocol, runtime_checkable

from contin.systems.protocol import System


@runtime_checkable
class WithSlopes(Protocol):
    """A system whose first derivatives may be differences."""

    @property
    def error_of_slopes(self) -> float:
        """Relative, of an entry; 0 where they are exact to rounding."""


@runtime_checkable
class WithGrain(Protocol):
    """A system whose values may be rounded to some digits, or noisy."""

    @property
    def error_of_grain(self) -> float:
        """Relative, of an entry of the Jacobian; 0 where values are known to rounding."""


def error_of_grain(system: System) -> float:
    """That of a system; 0 of formulas."""
    return system.error_of_grain if isinstance(system, WithGrain) else 0.0


def accuracy_of_equations(system: System, grained: bool = True) -> float:
    """Relative error of approximations (averages by quadrature) and of slopes by differences; 0 of exact ones.

    grained : with that of values that are rounded to some digits; without it where these are looked at themselves.
    """
    approximate = max((limit.accuracy for limit in system.limits), default=0.0)
    approximate = max(approximate, error_of_grain(system)) if grained else approximate
    return max(approximate, system.error_of_slopes) if isinstance(system, WithSlopes) else approximate
