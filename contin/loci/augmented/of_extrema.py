"""Curves of extrema: from one on a branch, on a curve of special points, or on a curve of extrema."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from contin.bvp.boundary_problem import BoundaryProblem
from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.loci.augmented.adaptive import AdaptiveCurve
from contin.loci.augmented.augmented_curve import AugmentedCurve
from contin.loci.augmented.boundary import BoundaryBase
from contin.loci.augmented.equilibria import EquilibriumBase
from contin.loci.augmented.extremal import Extremal
from contin.loci.augmented.of_boundary import boundary_base, start
from contin.loci.augmented.of_points import bordered, places
from contin.loci.augmented.orbits import OrbitBase
from contin.loci.augmented.points import PointBase
from contin.loci.equilibria.equilibrium_locus import LocusProblem
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.problems.orbits.collocated_orbits import OrbitProblem

TYPE = "EX"


def newest(point: SpecialPoint, own: Sequence[str], parameters: Sequence[str]) -> str:
    """The one parameter more than the curve's own; InputError where there is not just one."""
    new = [name for name in parameters if name not in own]
    if len(new) != 1 or set(own) - set(parameters):
        raise InputError(
            f"{point.branch}.{point.label}: an extremum along {', '.join(own)} is followed in {', '.join(own)} and one "
            f"more parameter; got {', '.join(parameters)}"
        )
    return new[0]


def of_solutions(
    problem: EquilibriumProblem | BoundaryProblem | OrbitProblem, point: SpecialPoint, parameters: Sequence[str]
) -> Seed:
    """From an extremum on a branch."""
    names, new = tuple(parameters), newest(point, problem.parameters, parameters)
    parent, held = Parent.of(point), (Extremal(str(point.normal_form["of"]), new),)
    if isinstance(problem, BoundaryProblem):
        base = boundary_base(problem, point.z, "", names)
        curve: AugmentedCurve = AdaptiveCurve(base, held, TYPE, names, problem.two.free)
        return Seed(curve, start(base, point.z), parent=parent)
    own = problem.base.copy()
    own[problem.active] = point.z[-1]
    found = tuple(places(problem.system.parameter_names, names))
    if isinstance(problem, OrbitProblem):
        orbits = OrbitBase(replace(problem, base=own, active=found[0]), found, "")
        z = np.append(point.z[:-1], own[list(found)][::-1])
        return Seed(AdaptiveCurve(orbits, held, TYPE, names), z, parent=parent)
    sizes = point.scale[:-1] if point.scale.size else np.maximum(np.abs(point.z[:-1]), 1e-3)
    points = EquilibriumBase(replace(problem, base=own), found, sizes.copy())
    curve = AugmentedCurve(points, held, TYPE, names)
    return Seed(curve, np.concatenate([point.z[:-1], own[list(found)][::-1]]), parent=parent)


def of_locus(problem: LocusProblem, point: SpecialPoint, parameters: Sequence[str]) -> Seed:
    """From an extremum on a curve of special points: of a parameter on folds, an isola centre or a simple crossing."""
    names, new = tuple(parameters), newest(point, problem.parameters, parameters)
    curve = problem.curve
    p = curve.full_parameters(point.z)
    base = PointBase(bordered(problem, problem.locus, p, names), codimension=2)
    scalar = curve.scalar(point.z) if curve.has_scalar else 0.0
    made = AugmentedCurve(base, (Extremal(str(point.normal_form["of"]), new),), TYPE, names)
    z = base.problem.curve.place(point.z[: problem.n], p, scalar)
    return Seed(made, z, parent=Parent.of(point))


def of_extrema(problem: AugmentedCurve, point: SpecialPoint, parameters: Sequence[str]) -> Seed:
    """From an extremum of the same column on a curve of extrema; also from one on a curve of a boundary problem."""
    names, added = tuple(parameters), newest(point, problem.parameters, parameters)
    column, base = str(point.normal_form["of"]), problem.base
    held = next((one for one in problem.held if isinstance(one, Extremal)), None)
    if held is not None and held.column != column:
        raise InputError(
            f"{point.branch}.{point.label}: extrema of {column} on a curve of extrema of {held.column} are not "
            f"followed; ask for extrema: [{held.column}]"
        )
    if held is None and problem.held:
        raise InputError(f"{point.branch}.{point.label}: extrema on a curve of {problem.type} are not followed further")
    wider = _wider(base, names)
    new = list(base.names)
    values = dict(zip(new, point.z[: -1 - len(new) : -1], strict=True)) | {added: problem.constants()[added]}
    rest = np.array([values[name] for name in names[::-1]])
    z = np.concatenate([point.z[: -len(new)], rest])
    made = replace(problem, base=wider, held=(Extremal(column, added),), type=TYPE, names=names, bounds=())
    return Seed(made, z, parent=Parent.of(point))


def _wider(base: object, names: Sequence[str]) -> PointBase | EquilibriumBase | BoundaryBase | OrbitBase:
    """The same equations with one more varying parameter."""
    if isinstance(base, EquilibriumBase):
        return replace(base, places=tuple(places(base.system.parameter_names, names)))
    if isinstance(base, BoundaryBase):
        found = tuple(places(base.problem.two.parameters, names))
        return BoundaryBase(replace(base.problem, active=found[0], spaces={}), found, base.type)
    if isinstance(base, OrbitBase):
        found = tuple(places(base.system.parameter_names, names))
        return OrbitBase(replace(base.problem, active=found[0]), found, base.type)
    assert isinstance(base, PointBase)
    locus = base.problem
    return replace(base, problem=bordered(locus, locus.locus, locus.base.copy(), names))
