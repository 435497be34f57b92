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

    name : of the class, where it is not the part's own.  gone : fields of older files that nothing needs any more.
    """

    module: str
    made: tuple[str, ...] = ()
    by: str = ""
    of: tuple[str, ...] = ()
    name: str = ""
    gone: tuple[str, ...] = ()


class Gone:
    """A part of older files that nothing needs any more."""

    def __init__(self, **fields: object) -> None: ...


PARTS: Final[Mapping[str, Part]] = {
    # solutions at one parameter
    "EquilibriumProblem": Part("contin.problems.equilibria.equilibrium"),
    "AlgebraicProblem": Part("contin.problems.equilibria.algebraic"),
    "Sliding": Part("contin.problems.surfaces.sliding"),
    "Jump": Part("contin.problems.surfaces.jumps"),
    "Surface": Part("contin.lowering.sliding"),
    "CycleProblem": Part("contin.problems.maps.cycle"),
    "IteratedSystem": Part("contin.systems.iterate"),
    "OrbitProblem": Part("contin.problems.orbits.collocated_orbits", made=("forcing",)),
    "ShootingProblem": Part("contin.problems.shooting.shot_orbits"),
    "FixedSpace": Part("contin.problems.shooting.fixed_space"),
    "BoundaryProblem": Part("contin.bvp.boundary_problem", made=("spaces",)),
    "ConnectionToCycle": Part("contin.homoclinic.cycle_connection_problem", made=("spaces",)),
    "CurveOfConnections": Part("contin.homoclinic.cycle_connection_problem", made=("spaces",)),
    "TangencyBase": Part("contin.loci.augmented.tangencies", made=("chosen",)),
    "CurveOfTangencies": Part("contin.loci.augmented.tangencies"),
    "FoldsOfConnections": Part("contin.loci.augmented.connections", made=("chosen",)),
    "CurveOfFolds": Part("contin.loci.augmented.of_connections"),
    "TwoPoint": Part("contin.bvp.two_point", by="two_point", of=("model", "free")),
    "HybridOrbits": Part("contin.problems.hybrid.hybrid_orbits"),
    "HybridLocus": Part("contin.loci.hybrid_orbits"),
    "ReturnSystem": Part("contin.problems.hybrid.return_system"),
    "HybridFlow": Part("contin.problems.hybrid.flow"),
    "Arc": Part("contin.problems.hybrid.passage"),
    # under conditions
    "ConditionedEquilibria": Part("contin.problems.conditioned.equilibria"),
    "ConditionedOrbits": Part("contin.problems.conditioned.orbits"),
    "OrbitConditions": Part("contin.problems.orbits.measured.functionals"),
    "Measures": Part("contin.problems.orbits.measured.measures"),
    # curves of points of equilibria and maps
    "LocusProblem": Part("contin.loci.equilibria.equilibrium_locus"),
    "ExtendedCurve": Part("contin.loci.equilibria.extended", made=("gauge",), gone=("_gauge",)),
    "GaugeOfExtended": Part("contin.store.parts", name="Gone"),
    "BorderedCurve": Part("contin.loci.equilibria.bordered", made=("gauge",), gone=("_memory",)),
    "MemoryOfBordered": Part("contin.store.parts", name="Gone"),
    "BordersOfBordered": Part("contin.store.parts", name="Gone"),
    # curves of orbits
    "OrbitLocusProblem": Part("contin.loci.orbits.orbit_locus"),
    "OrbitCurve": Part("contin.problems.orbits.special_orbits.curve", made=("gauge", "_works")),
    "HeldCurve": Part("contin.problems.orbits.special_orbits.held_parameter", made=("gauge", "_works")),
    "SamePeriodProblem": Part("contin.loci.orbits.isoperiodic"),
    "PeriodCurve": Part("contin.loci.orbits.isoperiodic", made=("gauge",), gone=("memory",)),
    "ShotLocusProblem": Part("contin.loci.shooting.shot_locus"),
    "ShootingCurve": Part("contin.loci.shooting.curve", made=("gauge",)),
    "GrazingCurve": Part("contin.loci.shooting.grazing", made=("gauge", "_formulas")),
    "Touch": Part("contin.loci.shooting.contacts"),
    "ShotPeriodProblem": Part("contin.loci.shooting.isoperiodic"),
    "ShotPeriodCurve": Part("contin.loci.shooting.isoperiodic", made=("gauge",)),
    "ConnectionProblem": Part("contin.homoclinic.saddle_connections"),
    "ConnectionCurve": Part("contin.homoclinic.equations", made=("gauge",), gone=("gauge",)),
    "Reversor": Part("contin.homoclinic.reversor"),
    "Gauge": Part("contin.store.parts", name="Gone"),
    # curves on any equations
    "AugmentedCurve": Part("contin.loci.augmented.augmented_curve"),
    "AdaptiveCurve": Part("contin.loci.augmented.adaptive"),
    "EquilibriumBase": Part("contin.loci.augmented.equilibria"),
    "PointBase": Part("contin.loci.augmented.points"),
    "BoundaryBase": Part("contin.loci.augmented.boundary", made=("chosen",), gone=("_kept",)),
    "KeptOnBoundary": Part("contin.store.parts", name="Gone"),
    "OrbitBase": Part("contin.loci.augmented.orbits", made=("chosen",), gone=("_kept",)),
    "KeptOnOrbits": Part("contin.store.parts", name="Gone"),
    "Borders": Part("contin.store.parts", name="Gone"),
    "Conditions": Part("contin.loci.augmented.scalars", made=("_formulas",)),
    "Degeneracy": Part("contin.loci.augmented.scalars"),
    "OnOrbits": Part("contin.loci.augmented.of_orbits"),
    "Cusp": Part("contin.loci.augmented.of_boundary"),
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
    return getattr(module, part.name or name)(**{key: value for key, value in fields.items() if key not in part.gone})
