"""Periodic orbits of large systems as a base of curves in two parameters.

z = (states, T, second parameter, first parameter), as in `contin.problems.large_orbits`. The large solves are those of
a family: from interval to interval, with the monodromy matrix inside GMRES, and one column more.

On curves of branch points the equations alone are singular. They are unfolded: the orbit closes up to a multiple of a
fixed jump, an unknown behind T that is zero where a symmetry, or an invariant family, forces the branch points.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.loci.augmented.base import Base
from contin.loci.augmented.tests_of_large_orbits import measured_at
from contin.problems.large_orbits.closing import across_closing
from contin.problems.large_orbits.large_orbit import LargeOrbitProblem
from contin.problems.large_orbits.linearised import Jump, OrbitLinearisation
from contin.problems.scales import parameter_width

BEHIND: Final = 3  # unknowns behind the states: period and two parameters


@dataclass(eq=False)
class Latest:
    """The family at the second parameter's last value."""

    second: float = np.nan
    problem: LargeOrbitProblem | None = None


@dataclass(frozen=True, eq=False)
class LargeOrbitBase(Base):
    """problem : of the family, the first parameter active.  second : place of the other among the system's.

    unfolded : with a jump's length among the unknowns.  jump : its direction (n,), chosen for a stretch of a curve.
    """

    problem: LargeOrbitProblem
    second: int
    unfolded: bool = False
    jump: Array | None = None
    _latest: Latest = field(default_factory=Latest)

    @property
    def _count(self) -> int:
        """Unknowns."""
        return self._states + BEHIND + self.unfolded

    @property
    def angle_periods(self) -> Array:
        return np.zeros(self._count - 1)

    @property
    def _states(self) -> int:
        return self.problem.states

    @property
    def identifying(self) -> NDArray[np.bool_]:
        return ~self.growing

    @property
    def growing(self) -> NDArray[np.bool_]:
        return np.arange(self._count) < self._states

    @property
    def names(self) -> tuple[str, ...]:
        known = self.system.parameter_names
        return known[self.problem.active], known[self.second]

    @property
    def conditions(self) -> int:
        return -int(self.unfolded)  # a jump is one more unknown to meet them with

    @property
    def gauge(self) -> Array | None:
        return self.jump

    @property
    def is_settled(self) -> bool:
        return self.jump is not None or not self.unfolded

    def gauged(self, gauge: Array | None) -> LargeOrbitBase:
        return self if gauge is None else replace(self, jump=gauge)

    def settled(self, z: Array, scale: Array) -> LargeOrbitBase:
        if not self.unfolded:
            return self
        jump = across_closing(self.at(z), self.inner(z))
        return self if jump is None else replace(self, jump=jump)

    @property
    def folded(self) -> LargeOrbitBase:
        """Of orbits that close."""
        return replace(self, unfolded=False, jump=None) if self.unfolded else self

    def closed(self, z: Array) -> Array:
        """z without the jump."""
        return np.delete(z, -BEHIND) if self.unfolded else z

    def inner(self, z: Array) -> Array:
        """(U, T, first parameter), also of a metric or tangent."""
        return np.append(z[: -2 - self.unfolded], z[-1])

    def joined(self, inner: Array, z: Array) -> Array:
        """The rest of z behind (U, T)."""
        return np.concatenate([inner[:-1], z[-2 - self.unfolded : -1], inner[-1:]])

    def at(self, z: Array) -> LargeOrbitProblem:
        """The family through z."""
        latest = self._latest
        if latest.problem is None or latest.second != z[-2]:
            base = self.problem.base.copy()
            base[self.second] = latest.second = float(z[-2])
            latest.problem = self.problem.at_constants(base)
            self.problem.memory.leave()
        return latest.problem

    def scales(self, z: Array, ranges: Sequence[tuple[float, float]]) -> Array:
        inner = self.at(z).initial_scale(self.inner(z), ranges[0])
        second = parameter_width(self.system.model, self.names[1], float(z[-2]), ranges[1])
        size = float(inner[0]) * np.sqrt(self.problem.n / self._states)  # of a state's change, as a vector
        return self.joined(inner, np.array([*[size] * self.unfolded, second, np.nan]))

    def settle(self, z: Array) -> None:
        """The phase is that of z."""
        inner = self.inner(z)
        self.problem.settle(inner, np.zeros(inner.size), np.ones(inner.size))

    def linearise(self, z: Array, scale: Array, rows: Array) -> OrbitLinearisation | None:
        if self.problem.memory.direction is None:
            self.settle(z)
        problem, jump = self.at(z), None
        if self.unfolded:
            if self.jump is None:  # none was found
                return None
            jump = Jump(self.jump, float(z[-BEHIND]))
        return problem.bordered(self.inner(z), (self.second, problem.active), rows, scale, jump=jump)

    def stability(self, type_: str, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        return measured_at(self.at(z), self.inner(z), type_, self.second)

    def finer(self, z: Array) -> tuple[LargeOrbitBase, Callable[[Array], Array], Callable[[Array], Array]]:
        """The same on intervals of half the length; what becomes of orbits (and changes of them) and of metrics."""
        finer, moved, metric = self.at(z).finer()

        def outer(change: Callable[[Array], Array]) -> Callable[[Array], Array]:
            def changed(row: Array) -> Array:
                return self.joined(change(self.inner(row)), row)

            return changed

        return replace(self, problem=finer, _latest=Latest()), outer(moved), outer(metric)

    def columns(self, z: Array) -> dict[str, Array]:
        found: dict[str, list[float]] = {}
        for row in z:
            own = {name: float(c[0]) for name, c in self.at(row).columns(self.inner(row)[None]).items()}
            for name, value in ({self.names[0]: float(row[-1]), self.names[1]: float(row[-2])} | own).items():
                found.setdefault(name, []).append(value)
        return {name: np.array(values) for name, values in found.items()}

    def column_names(self) -> tuple[str, ...]:
        return (*self.names, *self.problem.column_names()[1:])

    def describe_failure(self, z: Array) -> str:
        return self.at(z).describe_failure(self.inner(z))
