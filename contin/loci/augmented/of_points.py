"""Curves of equilibria and fixed points: of codimension two in three parameters, of one under conditions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TypeGuard

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Parent
from contin.continuation.homotopy import without_offset
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.loci.augmented.augmented_curve import AugmentedCurve
from contin.loci.augmented.points import PointBase
from contin.loci.augmented.scalars import Conditions, Degeneracy, Unfolding
from contin.loci.equilibria.bordered import BorderedCurve
from contin.loci.equilibria.equilibrium_locus import LocusProblem
from contin.model.advice import place_of_parameter
from contin.model.model import Model
from contin.model.relations import Relation

RESTS_ON = {"CP": "LP", "BT": "LP", "GH": "HB", "ZH": "HB", "HH": "HB", "BP": "BP"}  # curves in three parameters


def places(names: Sequence[str], parameters: Sequence[str]) -> list[int]:
    """Of parameters among those of the model."""
    found = [place_of_parameter(name, names) for name in parameters]
    if len(set(parameters)) < len(parameters):
        raise InputError(f"a curve of special points needs different parameters; got {', '.join(parameters)}")
    return found


def bordered(locus: LocusProblem, type_: str, p: Array, parameters: Sequence[str]) -> LocusProblem:
    """A curve of points of a type by minimally augmented equations, with all these parameters varying."""
    first, second, *more = places(locus.system.parameter_names, parameters)
    curve = BorderedCurve(type_, locus.system, p.copy(), first, second, locus.curve.sizes.copy(), tuple(more))
    return replace(locus, curve=curve, memory={})


def of_codimension_two(
    locus: LocusProblem, type_: str, u: Array, p: Array, scalar: float, parameters: Sequence[str], parent: Parent
) -> Seed:
    """The curve of such points in three parameters through (u, p); scalar: kappa of a Hopf point."""
    base = PointBase(bordered(locus, RESTS_ON[type_], p, parameters), codimension=2)
    held = Unfolding(base.problem) if type_ == "BP" else Degeneracy(type_, base.problem)
    problem = AugmentedCurve(base, (held,), type_, tuple(parameters))
    return Seed(problem, base.problem.curve.place(u, p, scalar), parent=parent)


def of_codimension_two_alone(problem: object) -> TypeGuard[AugmentedCurve]:
    """True of a curve in three parameters that holds nothing but what makes its points ones of codimension two."""
    if not (isinstance(problem, AugmentedCurve) and isinstance(problem.base, PointBase)):
        return False
    return all(isinstance(one, Degeneracy | Unfolding) for one in problem.held)


def under_conditions(seed: Seed, relations: tuple[Relation, ...], free: Sequence[str]) -> Seed:
    """The seed's curve in two (three) parameters with conditions, for which the parameters `free` are solved."""
    old = seed.problem
    kept: tuple[Degeneracy | Unfolding, ...] = ()
    bounds: tuple[tuple[float, float], ...]
    if isinstance(old, LocusProblem):
        locus, codimension, type_ = old, 1, old.locus
        bounds = (old.first_bounds, old.second_bounds)
    else:
        assert isinstance(old, AugmentedCurve)
        assert isinstance(old.base, PointBase)
        locus, kept = old.base.problem, tuple(one for one in old.held if isinstance(one, Degeneracy | Unfolding))
        codimension, type_, bounds = old.base.codimension, old.type, old.bounds
    model = locus.system.model
    if not isinstance(model, Model):
        raise InputError("conditions need a model made of formulas")
    own = locus.curve
    u, p, z = seed.z[: own.n], own.full_parameters(seed.z), seed.z
    base = PointBase(bordered(locus, locus.locus, p, (*old.parameters, *free)), codimension)
    held = (*(replace(one, locus=base.problem) for one in kept), Conditions(model, relations, base.problem))
    problem = AugmentedCurve(base, held, type_, old.parameters, tuple(free), bounds)
    start = base.problem.curve.place(u, p, own.scalar(z) if own.has_scalar else 0.0)
    return replace(seed, problem=problem, z=onto(problem, start), direction=None, scale=None)


def onto(problem: AugmentedCurve, z: Array) -> Array:
    """From a point to one that meets the scalars held, with the first parameter fixed, else the second, ...

    By homotopy: what they are off by is taken away in steps as long as Newton's method can follow.
    """
    scale = problem.initial_scale(z, (-np.inf, np.inf))
    near = problem.near(z, scale)
    if near is not None:
        for fixed in range(len(problem.names)):
            index = -1 - fixed

            def solved(offset: Array, guess: Array, index: int = index) -> Array | None:
                shifted = replace(problem, offset=tuple(offset.tolist()))
                return shifted.at_unknown(index, guess, float(guess[index]), scale)

            found = without_offset(z, near.values(z), solved)
            if found is not None:
                return found
    raise InputError(
        f"no {problem.type} near the start meets the conditions ({', '.join(h.text for h in problem.held)}) for any "
        f"nearby {', '.join(problem.free)}; start nearer to them"
    )
