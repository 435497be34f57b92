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


def accuracy_of_equations(system: System) -> float:
    """Relative error of approximations (averages by quadrature) and of slopes by differences; 0 of exact ones."""
    approximate = max((limit.accuracy for limit in system.limits), default=0.0)
    return max(approximate, system.error_of_slopes) if isinstance(system, WithSlopes) else approximate
