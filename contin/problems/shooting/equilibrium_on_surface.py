"""The equilibrium on a switching surface on which a family of piecewise-smooth orbits closes.

It has no linear part of its own, so no Hopf point is solved for: the parameter, the period and the equilibrium are
extrapolated to amplitude zero from orbits of small amplitude e. Where the equations have a linear part all the same,
or a declared symmetry, they are series in e^2, and the error is of the order e^6 in the parameter; where the linear
parts of both sides differ (an equilibrium on a corner), the parameter is proportional to e, and the series is one in e.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.branch import End
from contin.continuation.problem import Renewal
from contin.continuation.sample import Frame, Sample
from contin.continuation.settings import Settings
from contin.machine import elementary
from contin.problems.shooting.extremes import measures
from contin.problems.shooting.layout import Nodes

if TYPE_CHECKING:
    from contin.problems.shooting.shot_equations import ShotEquations

TINY: Final = 0.02  # amplitude, relative to the states' sizes, of an orbit that has shrunk
LARGER: Final = (1.0, 1.5, 2.0, 2.5)  # amplitudes of the orbits that are extrapolated from
AMPLITUDES: Final = 1e-8  # relative error of an amplitude, and with it of the distance to the limit
AT_REST: Final = 0.05  # speed at the equilibrium, relative to that of the smallest orbit


def has_shrunk(problem: ShotEquations, z: Array, scale: Array) -> bool:
    """True for an orbit so small that its family passes through amplitude zero here."""
    return bool(problem.system.n_switches and problem.autonomous and _extent(problem, z, scale) < TINY)


def at_rest(problem: ShotEquations, origin: Sample, before: Sample, frame: Frame) -> Renewal | None:
    """The end of a family at amplitude zero; None where it does not close on an equilibrium."""
    if not has_shrunk(problem, origin.z, frame.scale):
        return None
    extent = _extent(problem, origin.z, frame.scale)
    away = 1.0 if _extent_ahead(problem, origin, frame, 0.2 * extent) > extent else -1.0
    rows = [origin.z]
    for factor in LARGER[1:]:
        found = _beside(problem, origin, frame, away * (factor - 1.0) * extent)
        if found is None:
            return None
        rows.append(found.z)
    profiles = [problem.profile(z) for z in rows]
    low, high, _ = measures(problem, np.array(rows))
    extents = ((high - low)[:, : problem.n] / problem.sizes(origin.z, frame.scale)).max(axis=1)
    if not np.all(np.diff(extents) > 0.0):
        return None
    values = np.array([[p.parameter, p.period, *(p.weights @ p.u)] for p in profiles])
    series = (_limits(at, values) for at in (elementary.square(extents), extents))
    limits = min(series, key=lambda found: abs(float(found[1][0] - found[0][0])))
    parameter, period, rest = float(limits[1][0]), float(limits[1][1]), limits[1][2:]
    p = problem.full_parameters(np.append(origin.z[:-1], parameter))
    speed = np.abs(problem.system.value(rest, p)).max()
    if not speed < AT_REST * np.abs(np.ptp(profiles[0].u, axis=0)).max() * 2.0 * np.pi / period:
        return None
    known = AMPLITUDES * float(np.abs(values[:, 0] - parameter).max())
    error = 4.0 * (abs(parameter - float(limits[0][0])) + known)
    name = problem.parameters[0]
    rounded = np.round(rest, 9) + 0.0
    where = ", ".join(f"{s} = {v:.6g}" for s, v in zip(problem.system.state_names, rounded, strict=True))
    text = (
        f"the orbits shrink to the equilibrium ({where}) on a switching surface at {name} = {parameter:.10g}, "
        f"period {period:.10g}"
    )
    nodes = Nodes.of(origin.z, problem.n)
    z = replace(
        nodes, u=np.tile(rest, (nodes.count, 1)), period=period, offset=float(nodes.normal @ rest), parameter=parameter
    ).vector()
    last = replace(origin, z=z)
    return Renewal(
        frame.scale, origin, before, None, End("hopf", text, {"at": {name: parameter}, "error": error}), last, None
    )


def _limits(at: Array, values: Array) -> list[Array]:
    """Values (4, k) at 0 by polynomials through the first three and through all of them."""
    return [np.polynomial.polynomial.polyfit(at[:k], values[:k], k - 1)[0] for k in (3, 4)]


def _extent(problem: ShotEquations, z: Array, scale: Array) -> float:
    return float(np.max(np.ptp(problem.profile(z).u, axis=0) / problem.sizes(z, scale)))


def _beside(problem: ShotEquations, origin: Sample, frame: Frame, s: float) -> Sample | None:
    """The orbit at the arclength s from `origin`."""
    raw = np.where(origin.tangent == 0.0, 0.0, origin.tangent * frame.scale)
    return problem.probe(origin, s, origin.z + s * raw, frame, Settings())


def _extent_ahead(problem: ShotEquations, origin: Sample, frame: Frame, s: float) -> float:
    """Of the orbit at s; minus infinity where there is none: a family that ends at a corner has nothing beyond."""
    found = _beside(problem, origin, frame, s)
    return -np.inf if found is None else _extent(problem, found.z, frame.scale)
