"""The curve of tori that starts at a zero-Hopf point."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contin.continuation.branch import SpecialPoint
from contin.continuation.seed import Seed
from contin.loci.equilibria.equilibrium_locus import LocusProblem
from contin.machine import elementary
from contin.normalforms.zero_hopf import torus_predictor
from contin.transitions.registry import Explored, born
from contin.transitions.small_cycles import Place, compiled, follows_cycles, seed_of_cycles


@born(LocusProblem, "ZH", "the curve of tori", parameters=2, order=1, explored=Explored(orbits=True))
def tori_at_zero_hopf(problem: LocusProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """The curve of tori (NS) at a zero-Hopf point; none where its cycles are neutral saddles, or it is degenerate."""
    if point.vectors.get("plane") or not follows_cycles(problem):
        return []
    if "s" not in point.normal_form:  # the coefficients that decide are zero to their errors
        return []
    place = Place.of(problem, point, parameters)
    omegas = [float(v.imag) for v in np.asarray(point.vectors["critical"]) if v.imag > 0.0]
    try:
        cycles, rate = torus_predictor(place.jet(compiled(problem)), omegas[0])
    except (IndexError, ZeroDivisionError, np.linalg.LinAlgError):
        return []  # without a normal form, which the point's own remark tells
    if rate == 0.0:
        return []
    bend = -(elementary.square(2.0 * np.pi * rate / cycles.omega))  # cos(2 pi rate rho / omega)
    return [seed_of_cycles("NS", compiled(problem), place, cycles, 1.0, point, bend)]
