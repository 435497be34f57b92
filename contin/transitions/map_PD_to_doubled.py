"""From a period doubling of a cycle of period k to the cycles of period 2k that are born there."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.location.halting import HALF_PERIOD
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.machine import elementary
from contin.normalforms.maps import flip_predictor
from contin.problems.equilibria.branching.outset import Outset
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.problems.equilibria.normal_forms import jet_at
from contin.problems.equilibria.scaled import ScaledSystem
from contin.problems.maps.cycle import lifted
from contin.systems.iterate import iterate
from contin.transitions.equilibrium_BP_to_branches import crossing_branches, renewed_metric
from contin.transitions.registry import Explored, born

DOUBLED: Final = Explored(cascade=True)


@born(EquilibriumProblem, "PD", "the cycles of twice the period", explored=DOUBLED)
def doubled(problem: EquilibriumProblem, point: SpecialPoint, parameter: str) -> list[Seed]:
    """The seed of the doubled cycles at a PD point of `problem`, with `parameter` free.

    Its two halves are the two points of one cycle (each the image of the other under the map), so one arm is followed.
    Direction and curvature come from the predictor of the flip's normal form; where the multiplier -1 is double with
    one eigenvector (area-preserving maps), from the branch point of the map applied twice. Where several multipliers
    pass -1 together, that branch point has all their cycles.
    """
    if parameter != problem.parameters[0]:
        problem = problem.with_active(parameter, point.z)
    born = replace(problem, system=iterate(problem.system, 2))
    local = ScaledSystem(born, point.scale)
    kernel = int(point.vectors.get("kernel", 1))
    if kernel > 1:
        y, own = point.z / point.scale, point.tangent / point.scale
        outsets = crossing_branches(local.rated(y), y, own / np.linalg.norm(own), kernel)
        return [_seed(born, point, outset) for outset in outsets]
    try:
        predictor = flip_predictor(jet_at(problem, point.z))
    except ZeroDivisionError:
        own = point.tangent / point.scale
        crossing = crossing_branches(local, point.z / point.scale, own / np.linalg.norm(own), 1)
        if not crossing:
            raise InputError(f"{point.branch}.{point.label}: no doubled cycles were found here") from None
        d, k = crossing[0].direction, crossing[0].curvature
    else:
        direction = np.append(predictor.q, 0.0)
        bend = 2.0 * np.append(predictor.h2 + predictor.p2 * predictor.hp, predictor.p2)
        d, k = direction / point.scale, bend / point.scale
        norm = float(np.linalg.norm(d))
        d, k = d / norm, k / elementary.square(norm)
    return [_seed(born, point, Outset(d, k))]


def _seed(born: EquilibriumProblem, point: SpecialPoint, outset: Outset) -> Seed:
    """The cycles z + s d + s^2 k / 2, in the point's metric, or through a point of theirs."""
    scale, d, k = point.scale, outset.direction, outset.curvature
    beside = {1: outset.beside[1] * scale} if 1 in outset.beside else {}
    if not beside:  # a point is known only as well as the metric resolves it that it was found in
        scale, d, k = renewed_metric(ScaledSystem(born, scale), point.z, d, k)
    multipliers = elementary.square(np.asarray(point.eigenvalues))
    measured = int(point.values["unstable"]), multipliers
    parent = Parent.of(point)
    seed = Seed(born, point.z, d, k, scale, (1,), parent, beside=beside, measured=measured)
    return lifted(seed, (HALF_PERIOD,))
