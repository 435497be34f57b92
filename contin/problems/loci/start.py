"""Where curves in two parameters start: at folds, Hopf and branch points, and at points of codimension two on them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np

from contin.abi import NO_FUNCTION, Array
from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.departure import Seed
from contin.errors import InputError
from contin.machine import elementary
from contin.problems import newton_fixed
from contin.problems.loci.bordered import BorderedCurve
from contin.problems.loci.extended import ExtendedCurve
from contin.problems.loci.problem import LocusProblem

CURVES: Final = {  # the curves that pass through a point
    "CP": ("LP",), "BT": ("LP", "HB"), "ZH": ("LP", "HB"), "GH": ("HB",), "HH": ("HB", "HB"), "DP": ("LP", "BP"),
    "R1": ("LP", "NS"), "R2": ("PD", "NS"), "LPPD": ("LP", "PD"), "LPNS": ("LP", "NS"), "PDNS": ("PD", "NS"),
    "GPD": ("PD",), "CH": ("NS",), "NSNS": ("NS", "NS"),
}  # fmt: skip
SAME = 1e-6  # (of its typical size) values of kappa nearer than this belong to one curve
BESIDE = (1e-3, 1e-4, 1e-2)  # scaled distances from a DP at which the curve of folds is solved for
LARGE = 50  # states beyond which minimally augmented systems take the place of extended ones


def loci_of_point(problem: Any, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """The curve in two parameters through a fold, Hopf or branch point (maps: also PD.

    NS) of a branch of equilibria.
    """
    if point.type not in ("LP", "HB", "BP", "PD", "NS"):
        raise InputError(
            f"{point.branch}.{point.label}: {point.type} has no curve in two parameters; LP, BP, HB, PD and NS have"
        )
    if point.normal_form.get("kind") == "nonsmooth":
        raise InputError(f"{point.branch}.{point.label} is a corner of piecewise equations; its curve is not followed")
    if int(point.vectors.get("kernel", 1)) > 1:
        raise InputError(
            f"{point.branch}.{point.label} has a kernel of dimension {point.vectors['kernel']}: "
            "its curve is not followed"
        )
    p = problem.full_parameters(point.z)
    sizes = point.scale[:-1] if point.scale.size else np.maximum(np.abs(point.z[:-1]), 1e-3)
    scalar = 0.0
    if point.type == "HB":
        scalar = elementary.square(float(point.vectors["omega"]))
    elif point.type == "NS":
        scalar = float(elementary.cos(point.vectors["omega"]))
    parent = Parent(point.branch, point.label)
    return [
        seed_of(problem.system, point.type, parameters, point.z[:-1], p, sizes, problem.angle_periods, scalar, parent)
    ]


def seed_of(
    system: Any, type_: str, parameters: Sequence[str], u: Array, p: Array, sizes: Array, periods: Array, scalar: float,
    parent: Parent | None,
) -> Seed:  # fmt: skip
    first, second = indices(system, parameters)
    extended = system.kind != "map" and system.n <= LARGE and system.jacobian_address != NO_FUNCTION
    make = ExtendedCurve if extended else BorderedCurve
    curve = make(type_, system, p.copy(), first, second, sizes.copy())
    return Seed(LocusProblem(curve, periods), curve.place(u, p, scalar), parent=parent)


def indices(system: Any, parameters: Sequence[str]) -> tuple[int, int]:
    """Places of two parameters among those of the system."""
    known = list(system.parameter_names)
    names = list(parameters)
    if len(names) != 2 or names[0] == names[1]:
        raise InputError(f"a curve of special points needs two parameters; got {', '.join(names)}")
    for name in names:
        if name not in known:
            raise InputError(f"no parameter {name!r}; the model has {', '.join(known)}")
    return known.index(names[0]), known.index(names[1])


def loci_through(problem: LocusProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """Curves through a point of a locus: those of other types first; its own only where there is no other."""
    own = problem.locus
    curve = problem.curve
    u, p = point.z[: problem.n], curve.full_parameters(point.z)
    parent = Parent(point.branch, point.label)
    with_orbits = problem.system.kind != "map" and problem.system.jacobian_address != NO_FUNCTION
    if point.type == "GH" and with_orbits:
        from contin.problems.orbits.loci.born import folds_at_generalised_hopf

        return [folds_at_generalised_hopf(problem, point, parameters)]
    if point.vectors.get("plane"):
        return _across_plane(problem, point, parameters)
    types = CURVES.get(point.type, (own,))
    found: list[tuple[str, float]] = []
    for type_ in dict.fromkeys(types):
        for scalar in _scalars(point, type_):
            found.append((type_, scalar))
    tangential = curve.scalar(point.z) if own in ("HB", "NS") else 0.0
    same = SAME * (float(point.scale[-3]) if own in ("HB", "NS") and point.scale.size else 1.0)
    others = [f for f in found if f[0] != own or abs(f[1] - tangential) > same]
    chosen = others or [(own, tangential)]
    seeds = [
        seed_of(problem.system, type_, parameters, u, p, curve.sizes, problem.state_periods, scalar, parent)
        for type_, scalar in chosen
    ]
    if point.type in ("HH", "ZH") and with_orbits:
        from contin.problems.orbits.loci.born import tori_at_double_hopf, tori_at_zero_hopf

        born = tori_at_double_hopf if point.type == "HH" else tori_at_zero_hopf
        seeds += born(problem, point, parameters)
    if point.type == "BT" and with_orbits:
        from contin.problems.orbits.homoclinic.born import homoclinic_at_bogdanov_takens

        seeds += homoclinic_at_bogdanov_takens(problem, point, parameters)
    if point.type == "DP":
        kind = str(problem.memory.get("kind", ""))
        return [_beside_branch_points(seed, point, kind) if seed.problem.locus == "LP" else seed for seed in seeds]
    return seeds


def _across_plane(problem: LocusProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """Curves through a zero-Hopf point on an invariant plane: the other Hopf curve, then the branch points.

    From the branch points both Hopf curves.
    """
    from contin.problems.loci.crossing import hopf_curves

    own, curve = problem.locus, problem.curve
    u, p, parent = point.z[: problem.n], curve.full_parameters(point.z), Parent(point.branch, point.label)

    def seed(type_: str) -> Seed:
        scalar = _scalars(point, type_)[0]
        periods = problem.state_periods
        return seed_of(problem.system, type_, parameters, u, p, curve.sizes, periods, scalar, parent)

    same_order = tuple(parameters) == problem.parameters
    found = hopf_curves(seed("HB"), point, own == "HB" and same_order)
    return found if own == "BP" else [*found, seed("BP")]


def _beside_branch_points(seed: Seed, point: SpecialPoint, kind: str) -> Seed:
    """The curve of folds at a DP, where it crosses that of branch points (which are solutions of its system, too).

    A point of it has a state that left the branch: the equations are solved with the state that moves most held beside.
    """
    curve = seed.problem.curve  # type: ignore[attr-defined]
    widths = (float(point.scale[-1]), float(point.scale[-2]))
    scale = curve.scales(seed.z, widths)
    v = curve.vector(seed.z) / curve.sizes
    index = int(np.argmax(np.abs(v)))
    for step in BESIDE:
        guess = seed.z.copy()
        guess[: curve.n] += step * curve.sizes * v
        z = newton_fixed.solve(curve.linearise, index, guess, float(guess[index]), scale)
        if z is not None:
            direction = (z - seed.z) / scale
            arms = (1,) if kind == "pitchfork" else (-1, 1)  # the other half of the folds is its mirror image
            return replace(seed, direction=direction / np.linalg.norm(direction), scale=scale, arms=arms)
    raise InputError(f"{point.branch}.{point.label}: the curve of folds that ends here could not be found")


def _scalars(point: SpecialPoint, type_: str) -> list[float]:
    """kappa of the curves of a type through the point: omega^2 of each critical pair (NS: cos theta), 0 at BT."""
    if type_ not in ("HB", "NS"):
        return [0.0]
    if point.type == "BT":
        return [0.0]
    if point.type in ("R1", "R2"):
        return [1.0 if point.type == "R1" else -1.0]
    pairs = [v for v in np.asarray(point.vectors["critical"]) if v.imag > 0.0]
    if type_ == "HB":
        return [elementary.square(float(v.imag)) for v in pairs]
    return [elementary.cos(elementary.angle(v)) for v in pairs]


def equilibria_through(problem: LocusProblem, point: SpecialPoint, parameter: str) -> list[Seed]:
    """The branch of equilibria (fixed points) through a point of a locus, with one parameter free."""
    from contin.problems.equilibrium import EquilibriumProblem

    names = list(problem.system.parameter_names)
    if parameter not in names:
        raise InputError(f"no parameter {parameter!r}; the model has {', '.join(names)}")
    p = problem.curve.full_parameters(point.z)
    active = names.index(parameter)
    branch = EquilibriumProblem(problem.system, p, active, problem.state_periods)
    scale = None
    if point.scale.size:  # at a singular point the branch itself does not tell typical sizes
        widths = dict(zip(problem.parameters, point.scale[[-1, -2]], strict=True))
        scale = np.append(point.scale[: problem.n], widths.get(parameter, max(1.0, abs(float(p[active])))))
    z = np.append(point.z[: problem.n], p[active])
    return [Seed(branch, z, scale=scale, parent=Parent(point.branch, point.label))]
