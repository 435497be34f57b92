"""From a non-central homoclinic orbit to a saddle-node to the other curve through it.

Two curves of homoclinic orbits end there, tangent to each other: that of central orbits to a saddle-node, which is part
of the curve of folds, and that of orbits to a saddle (Schecter 1987). The orbit is the same; only the equations change.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation import corrector
from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.outcome import Failure
from contin.continuation.sample import Frame, Sample
from contin.continuation.seed import Seed
from contin.continuation.settings import Settings
from contin.errors import InputError
from contin.homoclinic.equations import ConnectionCurve
from contin.homoclinic.saddle_connections import ConnectionProblem
from contin.problems.orbits.ends.saddle_node import critical_direction
from contin.problems.two_parameters import indices
from contin.transitions.registry import born

BESIDE: Final = (1e-4, 1e-5, 1e-3)  # arclengths at which the side of the new curve is looked for
NEWTON: Final = 1e-10
NCH: Final = 3  # place of its test among those of a sample


@born(ConnectionProblem, "NCH", "the other curve of homoclinic orbits", parameters=2)
def through_non_central(problem: ConnectionProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """The curve of saddle-node loops that begins at the end of one of loops of a saddle, and the other way round."""
    source = f"{point.branch}.{point.label}"
    if set(parameters) != set(problem.parameters):
        raise InputError(f"{source}: the other curve varies the same two parameters, {', '.join(problem.parameters)}")
    curve = _other(problem.curve, point.z, parameters)
    other = ConnectionProblem(curve)
    profile = replace(problem.curve.profile(point.z), parameter=curve.orbits.base[curve.first])
    z = curve.join(profile, problem.curve.equilibria(point.z), float(curve.orbits.base[curve.second]))
    sizes = problem.sizes(point.z, point.scale)
    widths = dict(zip(problem.parameters, point.scale[[-1, -2]], strict=True))
    scale = other.scale_for(profile.h, sizes, *(float(widths[name]) for name in parameters))
    tangent = np.asarray(other.tangents(z, scale)[0])
    found = corrector.correct(other.settled(z, scale), z, tangent, 0.0, np.zeros(z.size), scale, NEWTON)
    if isinstance(found, Failure):
        raise InputError(f"{source}: Newton for the other curve of homoclinic orbits did not converge")
    z = found.z
    tangent = np.asarray(other.tangents(z, scale)[0])
    sense = _side(other, Sample(z, tangent, np.empty(0), 0, np.empty(0, complex)), Frame(scale))
    if sense == 0.0:
        raise InputError(f"{source}: the other curve of homoclinic orbits could not be followed from here")
    return [Seed(other, z, sense * tangent, scale=scale, arms=(1,), parent=Parent.of(point))]


def _other(curve: ConnectionCurve, z: Array, parameters: Sequence[str]) -> ConnectionCurve:
    """The equations of the other curve at a point of this one."""
    first, second = indices(curve.system, parameters)
    orbits = replace(curve.orbits, base=curve.full_parameters(z), active=first)
    stable, unstable = curve.stable_count, curve.unstable_count
    matrix = curve.matrix(curve.equilibria(z)[0], z)
    if curve.node:  # the end without a part along the zero eigenvalue's direction projects it out now
        p, _ = critical_direction(matrix)
        leaving, arriving = (abs(float(p @ offset)) for offset in curve.offsets(z, np.ones(curve.n)))
        stable, unstable = stable + int(arriving >= leaving), unstable + int(arriving < leaving)
    else:
        order = np.sort(np.linalg.eigvals(matrix).real)
        fades = abs(order[stable - 1]) < abs(order[stable])  # the slowest stable eigenvalue is the one that vanishes
        stable, unstable = stable - int(fades), unstable - int(not fades)
    return replace(
        curve, orbits=orbits, second=second, stable_count=stable, unstable_count=unstable, node=not curve.node,
        gauge=None,
    )  # fmt: skip


def _side(problem: ConnectionProblem, base: Sample, frame: Frame) -> float:
    """The sense of the tangent in which the orbits are those of the curve: its NCH test is positive there."""
    settings = Settings()
    for length in BESIDE:
        values = []
        for sense in (1.0, -1.0):
            guess = base.z + sense * length * frame.scale * base.tangent
            sample = problem.probe(base, sense * length, guess, frame, settings)
            values.append(np.nan if sample is None else float(sample.tests[NCH]))
        if values[0] > 0.0 > values[1] or (values[0] > 0.0 and np.isnan(values[1])):
            return 1.0
        if values[1] > 0.0 > values[0] or (values[1] > 0.0 and np.isnan(values[0])):
            return -1.0
    return 0.0
