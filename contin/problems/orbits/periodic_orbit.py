"""An orbit at fixed parameters, where a family of periodic orbits may start."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from contin.abi import Array
from contin.continuation.seed import Seed
from contin.continuation.told import Told
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.problems.orbits.mesh.layout import Profile
from contin.problems.symmetry import symmetry_names
from contin.systems.described import states_in_words

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem


@dataclass(frozen=True, eq=False, repr=False)
class PeriodicOrbit(Told):
    """An orbit at fixed parameters p: the start of a continuation."""

    system: CompiledSystem
    profile: Profile
    p: Array
    winding: Array
    multiple: int = 1
    remarks: tuple[str, ...] = ()  # about where it comes from: notes of branches that start here

    @property
    def period(self) -> float:
        return self.profile.period

    def problem(self, parameter: str, intervals: int | None = None) -> OrbitProblem:
        """The continuation problem with this parameter free."""
        active = list(self.system.parameter_names).index(parameter)
        return OrbitProblem(self.system, self.p, active, self.winding, self.profile.m, intervals, self.multiple)

    def seed(self, parameter: str) -> Seed:
        problem = self.problem(parameter)
        z = replace(self.profile, parameter=float(self.p[problem.active])).vector()
        return Seed(problem, z, symmetries=symmetry_names(problem), remarks=self.remarks)

    def __str__(self) -> str:
        low, high = self.profile.u.min(axis=0), self.profile.u.max(axis=0)
        states = states_in_words(
            self.system.state_names, self.profile.u, lambda k: f"in [{low[k]:.6g}, {high[k]:.6g}]"
        )
        return f"periodic orbit of period {self.period:.10g}, {states}"
