"""The parts that solutions are kept of: which objects a file may hold, and what of them is not kept.

A name in a file is looked up here, and only here: no file names a module. Fields that are `made` anew are machine code
and memory of kernels, which make answers cheaper and not different.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Any, Final


@dataclass(frozen=True)
class Part:
    """Where a class is; its fields that are `made` anew; where `by` is given, the function that makes it from others.

    name : of the class, where it is not the part's own.
    """

    module: str
    made: tuple[str, ...] = ()
    by: str = ""
    of: tuple[str, ...] = ()
    name: str = ""


PARTS: Final[Mapping[str, Part]] = {
    # solutions at one parameter
    "EquilibriumProblem": Part("contin.problems.equilibrium"),
    "AlgebraicProblem": Part("contin.problems.algebraic"),
    "Sliding": Part("contin.problems.surfaces.sliding"),
    "Jump": Part("contin.problems.surfaces.jumps"),
    "Surface": Part("contin.lowering.sliding"),
    "CycleProblem": Part("contin.problems.maps.cycle"),
    "IteratedSystem": Part("contin.systems.iterate"),
    "OrbitProblem": Part("contin.problems.orbits.problem", made=("forcing",)),
    "ShootingProblem": Part("contin.problems.shooting.problem"),
    "FixedSpace": Part("contin.problems.shooting.fixed_space"),
    "BoundaryProblem": Part("contin.bvp.problem", made=("spaces",)),
    "ConnectionToCycle": Part("contin.bvp.connection_problem", made=("spaces",)),
    "CurveOfConnections": Part("contin.bvp.connection_problem", made=("spaces",)),
    "TwoPoint": Part("contin.bvp.two_point", by="two_point", of=("model", "free")),
    "HybridOrbits": Part("contin.problems.hybrid.problem"),
    "HybridLocus": Part("contin.problems.hybrid.locus"),
    "ReturnSystem": Part("contin.problems.hybrid.system"),
    "HybridFlow": Part("contin.problems.hybrid.flow"),
    "Arc": Part("contin.problems.hybrid.passage"),
    # under conditions
    "ConditionedEquilibria": Part("contin.problems.conditioned.equilibria"),
    "ConditionedOrbits": Part("contin.problems.conditioned.orbits"),
    "OrbitConditions": Part("contin.problems.orbits.functionals"),
    "Measures": Part("contin.problems.orbits.measures"),
    # curves of points of equilibria and maps
    "LocusProblem": Part("contin.problems.loci.problem"),
    "ExtendedCurve": Part("contin.problems.loci.extended"),
    "GaugeOfExtended": Part("contin.problems.loci.extended", name="_Gauge"),
    "BorderedCurve": Part("contin.problems.loci.bordered"),
    "MemoryOfBordered": Part("contin.problems.loci.bordered", name="_Memory"),
    "BordersOfBordered": Part("contin.problems.loci.bordered", name="_Borders"),
    # curves of orbits
    "OrbitLocusProblem": Part("contin.problems.orbits.loci.problem"),
    "OrbitCurve": Part("contin.problems.orbits.loci.curve", made=("_works",)),
    "HeldCurve": Part("contin.problems.orbits.loci.held", made=("_works",)),
    "SamePeriodProblem": Part("contin.problems.orbits.same_period"),
    "PeriodCurve": Part("contin.problems.orbits.same_period"),
    "ShotLocusProblem": Part("contin.problems.shooting.loci.problem"),
    "ShootingCurve": Part("contin.problems.shooting.loci.curve", made=("_memory",)),
    "GrazingCurve": Part("contin.problems.shooting.loci.grazing", made=("_memory",)),
    "Touch": Part("contin.problems.shooting.loci.touching"),
    "ShotPeriodProblem": Part("contin.problems.shooting.loci.same_period"),
    "ShotPeriodCurve": Part("contin.problems.shooting.loci.same_period"),
    "ConnectionProblem": Part("contin.problems.orbits.homoclinic.problem", made=("_last",)),
    "ConnectionCurve": Part("contin.problems.orbits.homoclinic.curve"),
    "Reversor": Part("contin.problems.orbits.homoclinic.reversor"),
    "Gauge": Part("contin.problems.orbits.homoclinic.curve"),
    # curves on any equations
    "AugmentedCurve": Part("contin.loci.problem"),
    "AdaptiveCurve": Part("contin.loci.adaptive"),
    "EquilibriumBase": Part("contin.loci.equilibria"),
    "PointBase": Part("contin.loci.points"),
    "BoundaryBase": Part("contin.loci.boundary"),
    "KeptOnBoundary": Part("contin.loci.boundary", name="_Kept"),
    "OrbitBase": Part("contin.loci.orbits"),
    "KeptOnOrbits": Part("contin.loci.orbits", name="_Kept"),
    "Borders": Part("contin.loci.singular"),
    "Conditions": Part("contin.loci.scalars", made=("_formulas",)),
    "Degeneracy": Part("contin.loci.scalars"),
    "OnOrbits": Part("contin.loci.of_orbits"),
    "Cusp": Part("contin.loci.of_boundary"),
}


_KNOWN: Final = {(part.module, part.name or key): key for key, part in PARTS.items()}


def name_of(kind: type[object]) -> str | None:
    """The name of a class in the table; None where it is no part."""
    return _KNOWN.get((kind.__module__, kind.__qualname__))


def made_of(name: str, fields: Mapping[str, object]) -> Any:
    """The part with these fields; KeyError for a name that is not in the table."""
    part = PARTS[name]
    module = import_module(part.module)
    if part.by:
        return getattr(module, part.by)(*[fields[key] for key in part.of])
    return getattr(module, part.name or name)(**fields)
