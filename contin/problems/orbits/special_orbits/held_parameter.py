"""Special orbits of a family in one parameter: a curve in two whose second one is held.

The equations of `contin.kernels.special_orbits` with the family's parameter in both places, and s alone in the borders:
the direction r, along which curves go on, is left out, and Newton's step is a combination of the other solutions.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from contin.abi import Array
from contin.continuation.outcome import Failure
from contin.problems.orbits.special_orbits import borders
from contin.problems.orbits.special_orbits.curve import OrbitCurve

if TYPE_CHECKING:
    from contin.problems.orbits.orbit_equations import OrbitEquations


@dataclass(frozen=True, eq=False)
class HeldStep:
    """Newton's step (scaled), how far the bordered scalars are from zero, and the kernel's null vectors."""

    step: Array
    off: float
    v: Array
    y: Array


@dataclass(frozen=True, eq=False)
class HeldCurve(OrbitCurve):
    """`second` is the first parameter. z is that of a curve: (u, T, h, [further unknown], p, p)."""

    @classmethod
    def of(cls, type_: str, orbits: OrbitEquations) -> HeldCurve:
        """The special orbits of a type in a family."""
        return cls(type_, orbits, orbits.active)

    def settled(self, z: Array, scale: Array) -> Self:
        """Borders that fit at z; s stays the parameter."""
        work = self._begun(z, scale)
        for _ in range(2):
            self._corrected(work, z, np.ones_like(z), 0.0, z, scale, np.inf)
            with suppress(np.linalg.LinAlgError):  # the borders before serve; the step tells where they do not
                borders.set_borders(self.type, work, self._units(z, scale), self.further(z))
        return replace(self, gauge=work.gauge())

    def step(self, z: Array, scale: Array) -> HeldStep | None:
        """Newton's step from z; None where it is not defined.

        Cost: one condensation of the intervals, and second derivatives at every Gauss point.
        """
        work = self._work(z, scale)
        if isinstance(self._corrected(work, z, np.ones_like(z), 0.0, z, scale, np.inf), Failure):
            return None
        memory, size = work.memory, 1 + self.extra
        kept = slice(2, 2 + size)
        try:
            parts = np.linalg.solve(memory.dG[:size, kept], -(memory.G[:size] + memory.dG[:size, 0]))
        except np.linalg.LinAlgError:  # no step: Newton ends, in words
            return None
        step = memory.changes[0] + parts @ memory.changes[kept]
        step[-2] = step[-1]
        return HeldStep(step, float(np.max(np.abs(memory.G[:size]))), memory.v.copy(), memory.y.copy())

    def null_vectors(self, at: HeldStep, z: Array, scale: Array) -> Any:
        """(nu, 1) of PD, (nu + 1, 1) of LPC, (nu + 2, 2) of BPC: what is singular at z, where the step was found,
        sends to zero; in scaled (u, T, p). None of NS, whose functions are those of the flow across the orbit."""
        nodes = self.nodes(z)
        units = np.append(scale[: nodes + 1], 1.0)
        if self.type == "PD":
            return (at.v[:1, :nodes] / units[:nodes]).T
        if self.type == "NS":
            return np.empty((nodes, 0))
        count = nodes + (1 if self.type == "LPC" else 2)
        return (at.y[2 : 3 + self.extra, :count] / units[:count]).T
