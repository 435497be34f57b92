"""Doubled orbits that come back to those of half their period: at a period doubling of these, and located on them.

There the doubled family turns and its two halves change places, a pitchfork that is flat to its errors (Newton's method
stalls on it); the period doubling is a regular point of the orbits of half the period.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.outcome import Outcome, Verified
from contin.continuation.sample import Frame, Sample
from contin.machine import elementary
from contin.problems.shooting.layout import Nodes, make_scale
from contin.problems.tolerances import ONE_PASSAGE

if TYPE_CHECKING:
    from contin.problems.shooting.shot_equations import ShotEquations

NEAR: Final = 0.1  # of the states' sizes: how far apart the halves of an orbit may be for the place to be looked for
OPPOSITE: Final = 0.1  # relative: directions up to which two are opposite

Verify = Callable[["ShotEquations", str, Sample, Frame], Outcome]


def halving(problem: ShotEquations, near: Sample, frame: Frame, verify: Verify) -> Verified | None:
    """The orbit next to a sample that is one of half the period, at its period doubling; None where there is none."""
    n, nodes = problem.n, Nodes.of(near.z, problem.n)
    half = nodes.count // 2
    if problem.multiple % 2 or nodes.count % 2 or problem.fixed is not None:
        return None
    sizes, turn = problem.sizes(near.z, frame.scale), 0.5 * problem.winding
    apart = float(np.max(np.abs(nodes.u[half:] - turn - nodes.u[:half]) / sizes))
    if not apart < NEAR:
        return None
    orbits = replace(problem, count=half, winding=turn, multiple=problem.multiple // 2)
    scale = make_scale(sizes, half, 0.5 * float(frame.scale[-n - 3]), float(frame.scale[-1]))
    mean = replace(nodes, u=0.5 * (nodes.u[:half] + nodes.u[half:] - turn), period=0.5 * nodes.period)
    z = orbits.at_parameter(mean.vector(), nodes.parameter, scale)
    if z is None:
        return None
    beside = replace(near, z=z, tangent=orbits.tangents(z, scale)[0], eigenvalues=orbits.multipliers(z))
    point = verify(orbits, "PD", beside, Frame(scale))
    if not isinstance(point, Verified):
        return None
    single = Nodes.of(point.z, n)
    z = replace(single, u=np.vstack([single.u, single.u + turn]), period=2.0 * single.period).vector()
    if not float(np.max(np.abs((z - near.z)[: nodes.u.size].reshape(-1, n)) / sizes)) < 2.0 * apart + ONE_PASSAGE:
        return None
    values = elementary.square(np.asarray(point.eigenvalues))
    return replace(
        point, type="BPC", z=z, eigenvalues=values, normal_form={"kind": "pitchfork"}, remark="",
        vectors={"theta": 0.0, "kernel": 1},
    )  # fmt: skip


def drives_halves_apart(problem: ShotEquations, z: Array, tangent: Array) -> bool:
    """True where the second half of the orbit z repeats the first, and the raw `tangent` moves them oppositely.

    A shift in time, which keeps the first node on its plane, is no difference.
    """
    nodes, size = Nodes.of(z, problem.n), problem.n
    half = nodes.count // 2
    if problem.multiple % 2 or nodes.count % 2:
        return False
    sizes = np.maximum(np.ptp(problem.profile(z).u, axis=0), 1e-300)
    gap = (nodes.u[half:] - 0.5 * problem.winding - nodes.u[:half]) / sizes
    if not float(np.max(np.abs(gap))) < ONE_PASSAGE:
        return False
    first, second = (tangent[k * size : (k + 1) * size] / sizes for k in (0, half))
    together, flow = first + second, problem.system.value(nodes.u[0], problem.full_parameters(z)) / sizes
    if np.any(nodes.normal) and np.any(flow):
        together = together - flow * float(flow @ together) / float(flow @ flow)
    return float(np.linalg.norm(together)) <= OPPOSITE * float(np.linalg.norm(first - second))
