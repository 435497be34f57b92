"""What is born at cycles of maps: what is born at fixed points of the iterate, as cycles."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from contin.continuation.branch import SpecialPoint
from contin.continuation.seed import Seed
from contin.problems.maps.cycle import LONGEST, CycleProblem, lifted
from contin.transitions import births
from contin.transitions.registry import Explored, born

SHORT: Final = Explored(cascade=True, when=lambda problem: 2 * problem.period <= LONGEST)


def _switched(problem: CycleProblem, point: SpecialPoint, parameter: str) -> list[Seed]:
    seeds = births.switch(problem.inner, problem.at_first(point), parameter)
    return [s if isinstance(s.problem, CycleProblem) else lifted(s) for s in seeds]


@born(CycleProblem, "BP", "the branches that cross", explored=Explored())
def crossing_cycles(problem: CycleProblem, point: SpecialPoint, parameter: str) -> list[Seed]:
    """Seeds of cycles of the same period."""
    return _switched(problem, point, parameter)


@born(CycleProblem, "PD", "the cycles of twice the period", explored=SHORT)
def doubled_cycles(problem: CycleProblem, point: SpecialPoint, parameter: str) -> list[Seed]:
    """Seed of the doubled cycles; the explorer stops at a longest one."""
    return _switched(problem, point, parameter)


@born(CycleProblem, "", "the curve of such cycles", parameters=2)
def loci_of_cycles(problem: CycleProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """The curve of fixed points of the iterate."""
    return births.loci(problem.inner, problem.at_first(point), parameters)
