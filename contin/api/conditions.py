"""A seed under conditions: as many parameters become unknowns as there are conditions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.loci.augmented import of_orbits, of_points
from contin.loci.equilibria.equilibrium_locus import LocusProblem
from contin.loci.orbits.orbit_locus import OrbitLocusProblem
from contin.model.advice import place_of_parameter
from contin.model.model import Model
from contin.model.relations import relations
from contin.problems.conditioned.equilibria import ConditionedEquilibria
from contin.problems.conditioned.orbits import ConditionedOrbits
from contin.problems.equilibria.algebraic import AlgebraicProblem
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.problems.orbits.measured.functionals import OrbitConditions


def under_conditions(seed: Seed, conditions: Sequence[str], free: Sequence[str]) -> Seed:
    """The seed with these conditions, for which the parameters `free` are solved.

    Raises InputError for conditions that say nothing, a wrong number of them, or solutions that take none.
    """
    problem = seed.problem
    if len(conditions) != len(free):
        raise InputError(
            f"{len(conditions)} condition{'s' * (len(conditions) != 1)} and {len(free)} free parameters: each "
            "condition needs one parameter under `free` that is solved for"
        )
    model = getattr(getattr(problem, "system", None), "model", None)
    if isinstance(problem, OrbitLocusProblem):
        _check_free(free, list(problem.system.parameter_names), problem.parameters)
        return of_orbits.under_conditions(seed, conditions, free)
    if (isinstance(problem, LocusProblem) or of_points.of_codimension_two_alone(problem)) and isinstance(model, Model):
        _check_free(free, list(problem.system.parameter_names), problem.parameters)
        return of_points.under_conditions(seed, relations(model, conditions, False), free)
    if not isinstance(problem, OrbitProblem | EquilibriumProblem) or not isinstance(model, Model):
        raise InputError(
            "conditions are for equilibria, fixed points, orbits by collocation, and curves of LP, HB, BP, PD, NS of "
            "equilibria and fixed points and of CP, BT, GH, ZH, HH, BP of equilibria in three parameters, of models of "
            "formulas"
        )
    if isinstance(problem, AlgebraicProblem):
        raise InputError("kind: algebraic: write conditions as further equations")
    if seed.born:
        raise InputError(
            "conditions: at this start branches are born, and nothing on them meets the conditions yet; start from a "
            "solution: a user value of the branch, or `start:`"
        )
    names = list(problem.system.parameter_names)
    _check_free(free, names, problem.parameters)
    places = tuple(names.index(name) for name in free)
    values = np.array([problem.base[k] for k in places])
    on_orbits = isinstance(problem, OrbitProblem)
    found = relations(model, conditions, on_orbits)
    if isinstance(problem, OrbitProblem):
        conditioned: ConditionedOrbits | ConditionedEquilibria
        conditioned = ConditionedOrbits(problem, places, OrbitConditions(model, found))
    else:
        conditioned = ConditionedEquilibria(problem, places, found)
    return Seed(conditioned, conditioned.joined(seed.z, values), arms=seed.arms)


def _check_free(free: Sequence[str], names: Sequence[str], varying: Sequence[str]) -> None:
    for name in free:
        place_of_parameter(name, names, "free: ")
        if name in varying:
            raise InputError(f"free: {name} varies in this run already")
    if len(set(free)) < len(free):
        raise InputError(f"free: {free[0]} is named twice")
