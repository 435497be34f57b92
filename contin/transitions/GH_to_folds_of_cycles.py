"""The curve of folds of cycles that ends at a generalised Hopf (Bautin) point."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from contin.continuation.branch import SpecialPoint
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.loci.equilibria.equilibrium_locus import LocusProblem
from contin.normalforms.hopf import lpc_predictor
from contin.transitions.locus_to_loci import loci_through
from contin.transitions.registry import Explored, born
from contin.transitions.small_cycles import Place, compiled, follows_cycles, seed_of_cycles

# Scaled distance at which folds are told from other cycles. The condition of a fold is 4 l2 rho^4 + 2 b rho^2 = 0: what
# rounding leaves of b, itself of order rho^2, is rounding / rho^4.
TOLD: Final = 0.1


@born(LocusProblem, "GH", "the curve of folds of cycles", parameters=2, explored=Explored(orbits=True))
def folds_at_generalised_hopf(problem: LocusProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """The curve of folds of cycles (LPC) that ends at a generalised Hopf (Bautin) point."""
    if not follows_cycles(problem):
        return loci_through(problem, point, parameters)
    place = Place.of(problem, point, parameters)
    try:
        cycles = lpc_predictor(place.jet(compiled(problem)), float(point.normal_form["omega"]))
    except (KeyError, ZeroDivisionError, np.linalg.LinAlgError):
        raise InputError(
            f"{point.branch}.{point.label}: the curve of folds that ends here could not be predicted; the two "
            "parameters do not unfold the point"
        ) from None
    seed = seed_of_cycles("LPC", compiled(problem), place, cycles, 0.0, point)
    return [replace(seed, reach=TOLD)]
