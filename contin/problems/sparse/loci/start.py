"""Where the curves of a large system start: at its folds and Hopf points, and at points of codimension two."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.departure import Seed
from contin.continuation.vectors import norm
from contin.errors import InputError
from contin.machine import elementary
from contin.problems.loci.start import CURVES, indices
from contin.problems.sparse.loci.curve import LargeCurve
from contin.problems.sparse.loci.problem import LargeLocus
from contin.problems.sparse.problem import LargeProblem

SAME = 1e-6  # (relative) values of kappa nearer than this belong to one curve


def loci_of_point(problem: LargeProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """The curve in two parameters through a fold or a Hopf point of a branch of equilibria."""
    if point.type not in ("LP", "HB"):
        raise InputError(
            f"{point.branch}.{point.label}: of a large system folds and Hopf points have curves in two parameters; "
            f"this is {point.type}"
        )
    kappa = elementary.square(float(point.vectors["omega"])) if point.type == "HB" else 0.0
    q = np.asarray(point.vectors["q"]) if point.type == "HB" else (point.tangent * point.scale)[:-1]
    p = problem.full_parameters(point.z)
    return [_seed(problem, point.type, parameters, point.z[:-1], p, kappa, q, Parent(point.branch, point.label))]


def _seed(
    problem: LargeProblem, type_: str, parameters: Sequence[str], u: Array, p: Array, kappa: float, q: NDArray[Any],
    parent: Parent,
) -> Seed:  # fmt: skip
    first, second = indices(problem.system, parameters)
    curve = LargeCurve(type_, replace(problem, base=p.copy(), active=first), first, second)
    z = np.concatenate([u, [kappa] if type_ == "HB" else [], [p[second], p[first]]])
    curve.start(z, q)
    if type_ == "HB" and kappa == 0.0:  # q = q0 + i q1 with A q1 = q0: so fast is the motion beside a BT
        curve.memory.size = elementary.square(norm(np.real(q)) / norm(np.imag(q)))
    return Seed(LargeLocus(curve), z, parent=parent)


def loci_through(problem: LargeLocus, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """Curves through a point of a locus: those of other types first; its own only where there is no other."""
    curve, own = problem.curve, problem.locus
    parent = Parent(point.branch, point.label)
    u, p = point.z[: problem.n], curve.full_parameters(point.z)
    known = point.vectors
    found: list[tuple[str, float, NDArray[Any]]] = []
    for type_ in dict.fromkeys(CURVES.get(point.type, (own,))):
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
    return [_seed(origin, type_, parameters, u, p, kappa, q, parent) for type_, kappa, q in others or found[:1]]


def equilibria_through(problem: LargeLocus, point: SpecialPoint, parameter: str) -> list[Seed]:
    """The branch of equilibria through a point of a locus, with one parameter free."""
    names = list(problem.system.parameter_names)
    if parameter not in names:
        raise InputError(f"no parameter {parameter!r}; the problem has {', '.join(names)}")
    p = problem.curve.full_parameters(point.z)
    active = names.index(parameter)
    branch = replace(problem.curve.origin, base=p, active=active, work=type(problem.curve.origin.work)())
    z = np.append(point.z[: problem.n], p[active])
    return [Seed(branch, z, parent=Parent(point.branch, point.label))]
