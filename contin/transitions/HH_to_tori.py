"""The curves of tori that start at a double Hopf point."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contin.continuation.branch import SpecialPoint
from contin.continuation.seed import Seed
from contin.loci.equilibria.equilibrium_locus import LocusProblem
from contin.machine import elementary
from contin.normalforms.hopf_hopf import torus_predictors
from contin.transitions.registry import Explored, born
from contin.transitions.small_cycles import Place, compiled, follows_cycles, seed_of_cycles


@born(LocusProblem, "HH", "the curves of tori", parameters=2, order=1, explored=Explored(orbits=True))
def tori_at_double_hopf(problem: LocusProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """The two curves of tori (NS) at a double Hopf point: of the cycles of one pair, the other being critical."""
    if not follows_cycles(problem):
        return []
    place = Place.of(problem, point, parameters)
    try:
        omegas = float(point.normal_form["omega1"]), float(point.normal_form["omega2"])
        found = torus_predictors(place.jet(compiled(problem)), omegas)
    except (KeyError, ZeroDivisionError, np.linalg.LinAlgError):
        return []  # without a normal form, which the point's own remark tells
    return [
        seed_of_cycles("NS", compiled(problem), place, cycles, float(elementary.cos(angle)), point)
        for cycles, angle in found
    ]
