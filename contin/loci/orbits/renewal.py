"""After every chunk of a curve of special orbits: do metric and mesh still fit?"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from contin.abi import Array
from contin.continuation.problem import Renewal
from contin.continuation.sample import Frame, Sample
from contin.continuation.settings import Settings
from contin.problems.orbits.mesh.layout import make_scale
from contin.problems.orbits.mesh.move import Move
from contin.problems.orbits.renewal import refitted

if TYPE_CHECKING:
    from contin.problems.orbits.collocated_orbits import OrbitProblem
    from contin.problems.orbits.two_parameters import CurveOfPeriodicOrbits, OrbitCurveProblem

JUMPED = 0.05  # scaled distance beyond which the corrected point on the new mesh is not the same orbit


def renew(
    problem: OrbitCurveProblem, origin: Sample, before: Sample | None, frame: Frame, settings: Settings
) -> Renewal:
    """Mesh and metric for the next chunk."""
    curve, scale = problem.curve, frame.scale
    orbits, profile = curve.at(origin.z), curve.profile(origin.z)
    sizes = orbits.sizes(curve.orbit(origin.z), curve.orbit(scale))
    fit = refitted(orbits, profile, sizes, float(scale[profile.u.size]))
    if fit is None:
        return Renewal(scale, origin, before, None)
    metric = make_scale(fit.h, profile.m, fit.sizes, fit.period, float(scale[-1]))
    renewed = curve.join(metric, float(scale[-2]), 1.0)
    moved = CurveMove(curve, orbits, scale, renewed, fit.h)
    here = moved(origin)
    gauge = curve.gauged(frame.gauge).settled(here.z, renewed).gauge
    corrected = problem.probe(here, 0.0, here.z, Frame(renewed, gauge=gauge), settings)
    if corrected is not None and _distance(corrected.z, here.z, renewed) < JUMPED:
        sign = np.sign(float(corrected.tangent @ here.tangent)) or 1.0
        here = replace(here, z=corrected.z, tangent=sign * corrected.tangent)
    return Renewal(renewed, here, None if before is None else moved(before), None, gauge=gauge)


class CurveMove:
    """Takes samples of a curve to another mesh h and another metric, by interpolation."""

    def __init__(
        self, curve: CurveOfPeriodicOrbits, orbits: OrbitProblem, scale: Array, renewed: Array, h: Array
    ) -> None:
        self.curve = curve
        self.move = Move(orbits, curve.orbit(scale), curve.orbit(renewed), h)

    def __call__(self, sample: Sample) -> Sample:
        curve = self.curve
        inner = replace(sample, z=curve.orbit(sample.z), tangent=curve.orbit(sample.tangent))
        share = float(np.linalg.norm(inner.tangent))  # the orbit's part of the unit tangent
        if share == 0.0:  # only the second parameter moves: there is no direction to take along
            inner.tangent[-1] = 1.0
        there = self.move(inner)
        rest = [float(sample.tangent[-3])] if curve.extra else [0.0]
        t = curve.join(share * there.tangent, float(sample.tangent[-2]), *rest)
        z = curve.join(there.z, float(sample.z[-2]), curve.further(sample.z))
        return replace(sample, z=z, tangent=t / np.linalg.norm(t))


def on_finer_mesh(problem: OrbitCurveProblem, sample: Sample, frame: Frame) -> tuple[Any, Sample, Frame]:
    """The curve's problem, a sample of it and the metric, on a mesh of half the lengths; its own stays as it is."""
    curve = replace(problem.curve, _works={}, gauge=None, critical=dict(problem.curve.critical))
    return replace(problem, curve=curve), *on_half_lengths(curve, sample, frame)


def on_half_lengths(curve: CurveOfPeriodicOrbits, sample: Sample, frame: Frame) -> tuple[Sample, Frame]:
    """A sample of a curve and its metric on a mesh of half the lengths, by interpolation."""
    scale = frame.scale
    orbits, profile = curve.at(sample.z), curve.profile(sample.z)
    sizes, period = orbits.sizes(curve.orbit(sample.z), curve.orbit(scale)), float(scale[profile.u.size])
    h = np.repeat(profile.h / 2.0, 2)
    finer = curve.join(make_scale(h, profile.m, sizes, period, float(scale[-1])), float(scale[-2]), 1.0)
    there = CurveMove(curve, orbits, scale, finer, h)(sample)
    return there, Frame(finer, gauge=curve.settled(there.z, finer).gauge)


def _distance(a: Array, b: Array, scale: Array) -> float:
    return float(np.linalg.norm((a - b) / scale))
