"""Curves of special orbits under conditions on the orbits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Parent
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.loci.augmented.adaptive import AdaptiveCurve
from contin.loci.augmented.elimination import Scalars
from contin.loci.augmented.meshed import MeshedUnfolding
from contin.loci.augmented.of_points import onto, places
from contin.loci.augmented.orbits import CRITICAL, OrbitBase
from contin.loci.orbits.orbit_locus import OrbitLocusProblem
from contin.model.model import Model
from contin.model.relations import relations
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.problems.orbits.measured.functionals import OrbitConditions


@dataclass(frozen=True)
class OnOrbits:
    """The user's equations in the period, parameters and functionals."""

    conditions: OrbitConditions
    base: OrbitBase

    @property
    def text(self) -> str:
        return ", ".join(r.text for r in self.conditions.relations)

    def near(self, problem: object, z: Array, scale: Array) -> Scalars:
        base = self.base
        return lambda at: self.conditions.values(
            base.profile(at), np.asarray(base.at(at).full_parameters(base.inner(at)))
        )


def under_conditions(seed: Seed, conditions: Sequence[str], free: Sequence[str]) -> Seed:
    """The seed's curve of LPC, BPC or PD with conditions, for which the parameters `free` are solved."""
    curve_problem = seed.problem
    assert isinstance(curve_problem, OrbitLocusProblem)
    curve, model = curve_problem.curve, curve_problem.system.model
    if curve.type not in CRITICAL or not isinstance(model, Model):
        known = ", ".join(CRITICAL)
        raise InputError(f"conditions are for curves of {known} of models of formulas, not of {curve.type}")
    orbits, names = curve.at(seed.z), (*curve_problem.parameters, *free)
    found = tuple(places(curve_problem.system.parameter_names, names))
    base = OrbitBase(replace(orbits, active=found[0]), found, curve.type)
    held = OnOrbits(OrbitConditions(model, relations(model, conditions, True)), base)
    values = orbits.base.copy()
    values[found[0]] = seed.z[-1]
    start = np.concatenate([curve.orbit(seed.z)[:-1], np.zeros(base.extra), values[list(found)][::-1]])
    bounds = (curve_problem.first_bounds, curve_problem.second_bounds)
    made = AdaptiveCurve(base, (held,), curve.type, curve_problem.parameters, tuple(free), bounds)
    return replace(seed, problem=made, z=onto(made, start), direction=None, scale=None)


def branch_points(problem: OrbitProblem, z: Array, parameters: Sequence[str], parent: Parent) -> Seed:
    """The curve of branch points in the first parameter, where the other two are those of the curve."""
    values = problem.base.copy()
    values[problem.active] = z[-1]
    found = tuple(places(problem.system.parameter_names, parameters))
    base = OrbitBase(replace(problem, base=values, active=found[0]), found, "BPC")
    start = np.concatenate([z[:-1], np.zeros(1), values[list(found)][::-1]])
    return Seed(AdaptiveCurve(base, (MeshedUnfolding(base),), "BPC", tuple(parameters)), start, parent=parent)
