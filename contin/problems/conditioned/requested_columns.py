"""Further columns of families of orbits, on request: formulas such as mean(x^2), integral(v*i), max(x) - min(y)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, TypeVar

from contin.errors import InputError
from contin.model.model import Model
from contin.model.relations import measure
from contin.problems.conditioned.orbits import ConditionedOrbits
from contin.problems.orbits.family import FamilyOfOrbits
from contin.problems.orbits.measured.functionals import OrbitConditions
from contin.problems.orbits.measured.measures import Measures

if TYPE_CHECKING:
    from contin.continuation.seed import Seed

Family = TypeVar("Family", bound=FamilyOfOrbits)


def with_columns(seed: Seed, columns: Sequence[str]) -> Seed:
    """A seed whose branch has these columns beside its own; those of a run before it are left behind.

    Branches that are no families of orbits are as they were. InputError for a formula that is none.
    """
    problem = seed.problem
    if isinstance(problem, ConditionedOrbits):
        return replace(seed, problem=replace(problem, inner=_measured(problem.inner, columns)))
    if isinstance(problem, FamilyOfOrbits):
        return replace(seed, problem=_measured(problem, columns))
    return seed


def _measured(problem: Family, columns: Sequence[str]) -> Family:
    plain: Family = replace(problem, measures=None)  # type: ignore[call-arg]
    own = plain.column_names()
    texts = tuple(text for text in dict.fromkeys(columns) if text not in own and not _is_bare(plain, text))
    if not texts:
        return plain
    model = problem.system.model
    if not isinstance(model, Model):
        raise InputError(f"columns: {texts[0]}: integrals of orbits are for models of formulas")
    numbers = OrbitConditions(model, tuple(measure(model, text) for text in texts))
    found: Family = replace(plain, measures=Measures(texts, numbers))  # type: ignore[call-arg]
    return found


def _is_bare(problem: FamilyOfOrbits, text: str) -> bool:
    """A state or parameter as it stands, of which an orbit has no single value."""
    return text in (*problem.system.state_names, *problem.system.observable_names, *problem.system.parameter_names)
