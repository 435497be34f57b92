"""Curves through a point of codimension two of a large system, and its branch of equilibria there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from contin.abi import Vector
from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.seed import Seed
from contin.loci.sparse.large_locus import LargeLocus
from contin.machine import elementary
from contin.model.advice import place_of_parameter
from contin.special.table import curves_of_points
from contin.transitions.equilibrium_of_large_to_locus import seed_of_large
from contin.transitions.registry import born

SAME = 1e-6  # (relative) values of kappa nearer than this belong to one curve


@born(LargeLocus, "", "the other curves through it", parameters=2)
def loci_through(problem: LargeLocus, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """Curves through a point of a locus: those of other types first; its own only where there is no other."""
    curve, own = problem.curve, problem.locus
    parent = Parent.of(point)
    u, p = point.z[: problem.n], curve.full_parameters(point.z)
    known = point.vectors
    found: list[tuple[str, float, Vector]] = []
    for type_ in dict.fromkeys(curves_of_points(point.type, own)):
        if type_ == "LP":
            found.append(("LP", 0.0, np.real(known["null"])))
        elif point.type == "BT":
            found.append(("HB", 0.0, known["null"] + 1j * known["generalised"]))
        else:
            pairs = zip(known["omegas"], known["pairs"], strict=True)
            found += [("HB", elementary.square(float(w)), q) for w, q in pairs]
    here = curve.kappa(point.z)
    others = [f for f in found if f[0] != own or abs(f[1] - here) > SAME * max(abs(here), abs(f[1]))]
    origin = problem.curve.origin
    return [seed_of_large(origin, type_, parameters, u, p, kappa, q, parent) for type_, kappa, q in others or found[:1]]


@born(LargeLocus, "", "the branch of equilibria")
def equilibria_through(problem: LargeLocus, point: SpecialPoint, parameter: str) -> list[Seed]:
    """The branch of equilibria through a point of a locus, with one parameter free."""
    active = place_of_parameter(parameter, problem.system.parameter_names)
    p = problem.curve.full_parameters(point.z)
    branch = replace(problem.curve.origin, base=p, active=active, work=type(problem.curve.origin.work)())
    z = np.append(point.z[: problem.n], p[active])
    return [Seed(branch, z, parent=Parent.of(point))]
