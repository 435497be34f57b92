"""Curves and regions in two parameters, as data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from contin.abi import Array
from contin.continuation.branch import Branch
from contin.diagram.phase.checks import Check
from contin.diagram.phase.lines import Box
from contin.diagram.phase.states import State


@dataclass(frozen=True, eq=False)
class Region:
    """A part of the box in which the same states exist with the same stability.

    `point` maps the two parameters to a representative point, where `states` are all states that were found.
    Regions of one `name` have the same numbers of equilibria of every stability, and of stable periodic orbits, and
    their stable equilibria are each other's continuation along the straight way between their points.
    """

    name: str
    number: int
    point: Mapping[str, float]
    states: tuple[State, ...]
    area: float  # as a part of the box
    outline: Array  # (k, 2), in the parameters' units
    holes: tuple[Array, ...] = ()
    aperiodic: int = 0  # 1 where trajectories settle on something without a period: chaos, or a torus
    kind: str = "flow"  # or map

    @property
    def total(self) -> int:
        """How many equilibria there are, images under symmetries counted."""
        return sum(state.copies for state in self.states if not state.is_orbit)

    @property
    def stable(self) -> int:
        """How many of them are stable."""
        return sum(state.copies for state in self.states if not state.is_orbit and state.unstable == 0)

    @property
    def orbits(self) -> int:
        """How many periodic orbits were found, images under symmetries counted."""
        return sum(state.copies for state in self.states if state.is_orbit)

    @property
    def stable_orbits(self) -> int:
        """How many of them are stable."""
        return sum(state.copies for state in self.states if state.is_orbit and state.unstable == 0)

    @property
    def words(self) -> str:
        """Such as '2 of 3 equilibria stable, 1 stable orbit'.

        All stable states are meant; the second number counts the unstable equilibria that were found, too.
        """
        cycles = self.stable_orbits
        noun = "orbit" if self.kind == "flow" else "cycle"
        parts = [self._equilibria]
        parts += [f"{cycles} stable {noun}{'s' if cycles > 1 else ''}"] if cycles else []
        parts += ["an aperiodic attractor"] if self.aperiodic else []
        return ", ".join(parts)

    @property
    def _equilibria(self) -> str:
        one, many = ("equilibrium", "equilibria") if self.kind == "flow" else ("fixed point", "fixed points")
        if self.total == 0:
            return f"no {one} found"
        if self.total == 1:
            return f"1 {one}, {'stable' if self.stable else 'unstable'}"
        return f"{self.stable or 'none'} of {self.total} {many} stable"


@dataclass(frozen=True, eq=False, repr=False)
class PhaseData:
    """Curves, regions and their neighbourhood; `branches` are the one-parameter branches that led to the curves."""

    parameters: tuple[str, str]
    box: Box
    loci: tuple[Branch, ...]
    regions: tuple[Region, ...]
    borders: Mapping[tuple[int, int], frozenset[str]]
    branches: tuple[Branch, ...] = ()
    notes: tuple[str, ...] = field(default_factory=tuple)
    defects: tuple[str, ...] = ()  # those of the notes that tell of errors which contin did not foresee
    stopped: bool = False  # by the user: curves and regions may be missing
    check: Check = field(default_factory=Check)  # of the regions by a second method
