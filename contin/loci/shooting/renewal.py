"""After every chunk of a curve by shooting: is there still an orbit, do metric and phase still fit?"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.continuation.metric import measured_in
from contin.continuation.problem import Renewal
from contin.continuation.sample import Frame, Sample
from contin.problems.shooting.layout import Nodes, make_scale
from contin.problems.shooting.phase import quietest, rebased
from contin.problems.shooting.renewal import misplaced

if TYPE_CHECKING:
    from contin.loci.shooting.shot_curve_equations import ShotCurveEquations


def renew(problem: ShotCurveEquations, origin: Sample, before: Sample | None, frame: Frame) -> Renewal:
    """Metric and phase for the next chunk, or the end of the curve."""
    curve, scale = problem.curve, frame.scale
    end = problem.at_birth(origin, None, scale)
    if end is not None:
        return Renewal(scale, origin, before, None, end)
    orbits, orbit, metric = curve.at(origin.z), curve.orbit(origin.z), curve.orbit(scale)
    nodes, sizes = Nodes.of(orbit, orbits.n), orbits.sizes(orbit, metric)
    largest = np.abs(nodes.u).max(axis=0)
    angles = np.asarray(orbits.system.model.periods(orbits.constants()), dtype=float) > 0.0
    grown = np.where(~angles & (largest > 1.3 * sizes), 1.3 * largest, sizes)
    place = nodes.u.size
    period = 2.0 * nodes.period if nodes.period > float(scale[place]) else float(scale[place])
    moves = curve.movable and orbits.autonomous and misplaced(orbits, orbit, nodes, sizes)
    if not moves and np.array_equal(grown, sizes) and period == scale[place]:
        return Renewal(scale, origin, before, None)
    renewed = curve.join(make_scale(grown, nodes.count, period, float(scale[-1])), float(scale[-2]), 1.0)
    if not moves:
        kept = None if before is None else measured_in(before, scale, renewed)
        return Renewal(renewed, measured_in(origin, scale, renewed), kept, None)
    fraction = quietest(orbits, orbit)
    moved = rebased(orbits, orbit, fraction, grown)
    there = problem.with_gauge(problem.curve.shifted(fraction).gauge)
    z = curve.join(moved, float(origin.z[-2]), curve.further(origin.z))
    here = _at_new_phase(there, origin, z, scale, renewed)
    return Renewal(renewed, here, None, None, gauge=there.curve.gauge)


def _at_new_phase(problem: ShotCurveEquations, origin: Sample, z: Array, old: Array, scale: Array) -> Sample:
    """The sample there, with the sense of its tangent: the part that no change of phase touches."""
    (t,) = problem.tangents(z, scale)
    orbits, size = problem.curve.orbits, z.size
    guide = np.append(orbits.count * orbits.n, np.arange(size - 2 - problem.curve.extra, size))  # T, further, q, p
    sense = float(np.sum(t[guide] * origin.tangent[guide] * old[guide] / scale[guide]))
    return replace(origin, z=z, tangent=t * (np.sign(sense) or 1.0))
