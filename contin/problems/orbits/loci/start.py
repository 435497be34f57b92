"""Where curves of special orbits start: at a labelled LPC, PD or NS of a family."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.departure import Seed
from contin.errors import InputError
from contin.problems.loci.start import indices
from contin.problems.orbits.loci.curve import OrbitCurve
from contin.problems.orbits.loci.problem import OrbitLocusProblem

CURVES = ("LPC", "PD", "NS", "BPC")


def loci_of_orbit(problem: Any, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """The curve in two parameters through a fold, period doubling or torus bifurcation of a family of orbits."""
    if point.type == "HOM":
        from contin.problems.orbits.homoclinic.start import connections_of_family

        return connections_of_family(problem, point, parameters)
    if point.type not in CURVES:
        raise InputError(
            f"{point.branch}.{point.label}: {point.type} has no curve in two parameters; LPC, PD, NS, BPC and HOM have"
        )
    first, second = indices(problem.system, parameters)
    names = problem.system.parameter_names
    orbit = point.z.copy()
    if names[first] != problem.parameters[0]:
        orbits = problem.with_active(names[first], orbit)
        orbit[-1] = orbits.base[first]
    else:
        orbits = problem
    curve = OrbitCurve(point.type, orbits, second)
    q = orbits.base[second]
    further = float(np.cos(point.vectors["theta"])) if point.type == "NS" else 0.0
    z = curve.join(orbit, float(q), further)
    return [Seed(OrbitLocusProblem(curve), z, parent=Parent(point.branch, point.label))]
