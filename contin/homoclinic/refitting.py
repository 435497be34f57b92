"""Connecting orbits on another interval of time or another mesh, with the tangent of the curve that they lie on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final, Protocol

import numpy as np

from contin.abi import Array
from contin.continuation.problem import Renewal
from contin.continuation.sample import Frame, Sample
from contin.errors import InputError
from contin.homoclinic.interval import farther, fits, fitted
from contin.machine import elementary
from contin.problems.contracts import Probing
from contin.problems.orbits.mesh.adaption import choose_mesh, estimate

if TYPE_CHECKING:
    from contin.continuation.settings import Settings
    from contin.homoclinic.equations import ConnectionCurve

OUTGROWN: Final = 1.5  # mesh error beside the tolerance at which a new mesh is made
FINE: Final = 8  # times a node, at which the state of another interval is looked for


class Measured(Protocol):
    """Connecting orbits with a metric."""

    @property
    def curve(self) -> ConnectionCurve: ...
    def sizes(self, z: Array, scale: Array) -> Array:
        """Of the states, in a metric of z."""

    def scale_for(self, h: Array, sizes: Array, first: float, second: float) -> Array:
        """The metric on a mesh, of states of these sizes and parameters of these widths."""


class Followed(Probing, Protocol):
    """A curve in the unknowns of connecting orbits."""

    def tangents(self, z: Array, scale: Array) -> Sequence[Array]: ...


@dataclass(frozen=True, eq=False)
class Fit:
    """What an orbit is to be moved to. z : on the interval that is wanted, with the mesh that it had."""

    z: Array
    h: Array
    scale: Array
    another_interval: bool


def fit_for(problem: Measured, z: Array, scale: Array) -> Fit | None:
    """None where interval and mesh fit."""
    curve, sizes = problem.curve, problem.sizes(z, scale)
    profile, orbits = curve.profile(z), problem.curve.orbits
    grown = np.maximum(sizes, np.abs(profile.u).max(axis=0))
    error, _ = estimate(profile, grown)
    short = not fits(curve, z, sizes)
    if not short and error <= OUTGROWN * orbits.tolerance and np.all(grown <= 2.0 * sizes):
        return None
    if short:
        z = fitted(curve, z, sizes)
    chosen = choose_mesh(curve.profile(z), grown, orbits.tolerance, orbits.intervals)
    return Fit(z, chosen.h, problem.scale_for(chosen.h, grown, float(scale[-1]), float(scale[-2])), short)


def farther_and_finer(problem: Measured, z: Array, scale: Array) -> Fit:
    """On a longer interval, with a mesh of half the lengths."""
    curve, sizes = problem.curve, problem.sizes(z, scale)
    z = fitted(curve, z, sizes, farther(curve))
    h = np.repeat(0.5 * curve.profile(z).h, 2)
    return Fit(z, h, problem.scale_for(h, sizes, float(scale[-1]), float(scale[-2])), True)


def on_interval(
    followed: Followed, curve: ConnectionCurve, fit: Fit, origin: Sample, old: Array, settings: Settings
) -> Renewal | None:  # fmt: skip
    """The point on another interval of time: solved anew, with the tangent in the same sense (its metric was `old`)."""
    z = curve.join(curve.profile(fit.z).on_mesh(fit.h), curve.equilibria(fit.z), float(fit.z[-2]))
    try:
        tangent = np.asarray(followed.tangents(z, fit.scale)[0])
    except InputError:  # the interval stays as it is
        return None
    if _alike(curve, origin, old, z, tangent * fit.scale) < 0.0:
        tangent = -tangent
    base = replace(origin, z=z, tangent=tangent)
    corrected = followed.probe(base, 0.0, z, Frame(fit.scale), settings)
    if corrected is None:
        return None
    sign = np.sign(float(corrected.tangent @ tangent)) or 1.0
    here = replace(corrected, tangent=sign * corrected.tangent, tests=origin.tests, unstable=origin.unstable)
    return Renewal(fit.scale, here, None, None)


def _alike(curve: ConnectionCurve, one: Sample, old: Array, z: Array, raw: Array) -> float:
    """The product of a tangent, in the metric `old`, with an unscaled one at z on another interval.

    By parameters alone a fold of a branch has no sense. An orbit comes to a state once, by which the times of both
    intervals are compared; what only one of them has lies near a saddle.
    """
    before, after, given = curve.profile(one.z), curve.profile(z), one.tangent * old
    extents = np.ptp(before.u, axis=0)
    moving = extents > 0.0
    sizes = np.where(moving, extents, 1.0)
    speeds = np.abs(np.diff(before.u, axis=0) / sizes).max(axis=1) / np.diff(before.times)
    fastest = int(np.argmax(speeds))
    fine = np.linspace(0.0, 1.0, FINE * len(after.u))
    there = float(fine[np.argmin(np.abs((after.at(fine) - before.u[fastest]) / sizes).max(axis=1))])
    times = there + (before.times - before.times[fastest]) * (before.period / after.period)
    both = (times >= 0.0) & (times <= 1.0)
    first = given[: before.u.size].reshape(before.u.shape)[both] / sizes
    second = replace(after, u=raw[: after.u.size].reshape(after.u.shape)).at(times[both]) / sizes
    functions = float(np.sum(before.weights[both] @ (first * second)))
    return functions + float(np.sum(given[-2:] * raw[-2:] / elementary.square(old[-2:])))


def on_mesh(
    followed: Followed, curve: ConnectionCurve, fit: Fit, origin: Sample, before: Sample | None, old: Array,
    settings: Settings,
) -> Renewal:  # fmt: skip
    """The point and the one before it on another mesh, in the metric that was `old`."""
    here = moved(curve, origin, old, fit.scale, fit.h)
    corrected = followed.probe(here, 0.0, here.z, Frame(fit.scale), settings)
    if corrected is not None:
        sign = np.sign(float(corrected.tangent @ here.tangent)) or 1.0
        here = replace(here, z=corrected.z, tangent=sign * corrected.tangent)
    return Renewal(fit.scale, here, None if before is None else moved(curve, before, old, fit.scale, fit.h), None)


def moved(curve: ConnectionCurve, sample: Sample, scale: Array, renewed: Array, h: Array) -> Sample:
    """A sample on another mesh and in another metric."""
    old = curve.profile(sample.z)
    raw = sample.tangent * scale
    moving = replace(old, u=raw[: old.u.size].reshape(old.u.shape)).on_mesh(h)
    z = curve.join(old.on_mesh(h), curve.equilibria(sample.z), float(sample.z[-2]))
    saddles = raw[old.u.size : old.u.size + curve.saddles * curve.n]
    t = np.concatenate([moving.u.ravel(), saddles, [0.0], np.zeros(len(h)), raw[-2:]]) / renewed
    return replace(sample, z=z, tangent=t / np.linalg.norm(t))
