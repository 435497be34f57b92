"""The stroboscopic map of a forced flow beside one of its orbits: states at t = 0 to those after the orbit's period."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.errors import NoSolutionError
from contin.linalg.newton import Rules, newton
from contin.linalg.vectors import norm
from contin.lowering.system import compile_system
from contin.model.expression import neg, substitute, symbol
from contin.model.parts import TIME
from contin.simulate.flight import DONE, Flight, fly

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem

RTOL: Final = 1e-12
ATOL: Final = 1e-13  # of the manifold's length
NEWTON: Final = Rules(settled=1e-10, stalled=1e-10, budget=10)  # of the length: for the fixed point


@dataclass(frozen=True, eq=False)
class Stroboscope:
    """P(u) = phi_T(u) - winding of a smooth forced `system` at p (m,), T being `period`, a multiple of the forcing's.

    winding (n,) : whole turns that angles gain over a period.  size : a length, to which tolerances are relative.
    """

    system: CompiledSystem
    p: Array
    period: float
    winding: Array
    size: float

    def image(self, u: Array) -> Array | None:
        end = self._flown(self.system, u)
        return None if end is None else end - self.winding

    def preimage(self, u: Array) -> Array | None:
        return self._flown(self._backwards, u + self.winding)

    def fixed_point(self, guess: Array) -> tuple[Array, Array]:
        """The fixed point u0 next to a guess, and the monodromy matrix there, by Newton's method."""
        n = len(guess)

        def correct(at: tuple[Array, Array]) -> tuple[float, tuple[Array, Array]]:
            flight = self._flight(self.system, at[0], np.eye(n)).finished()
            matrix = flight.variations
            step = np.linalg.solve(matrix - np.eye(n), at[0] + self.winding - flight.end[:n])
            return norm(step) / self.size, (at[0] + step, matrix)

        found = newton(correct, (guess, np.eye(n)), NEWTON)
        if found is None:
            raise NoSolutionError("manifold: the orbit's state at t = 0 is no fixed point of the stroboscopic map")
        return found.at

    @cached_property
    def _backwards(self) -> CompiledSystem:
        """u' = -f(u, -t), whose flow from t = 0 undoes a whole period."""
        model = self.system.model
        t = symbol(TIME)
        equations = substitute([neg(e) for e in model.equations], {t: neg(t)})
        return compile_system(
            model.replace(equations=tuple(equations), events=(), symmetries=(), rotation={}, observables={})
        )

    def _flown(self, system: CompiledSystem, u: Array) -> Array | None:
        flight = self._flight(system, u)
        return flight.end if flight.outcome == DONE and np.all(np.isfinite(flight.end)) else None

    def _flight(self, system: CompiledSystem, u: Array, variations: Array | None = None) -> Flight:
        return fly(system, u, self.p, self.period, rtol=RTOL, atol=ATOL * self.size, variations=variations)
