"""How errors of the equations themselves reach the parameters of a curve by shooting: those of averages by quadrature.

F(x) = 0 are the curve's equations, one fewer than unknowns, x = (u, T, [further], q, p). With F + dF the curve lies
dx = -F_x^+ dF beside its old place, normal to itself in the metric. dF is bounded row by row: by the relative accuracy
of the vector field and its derivatives times their largest rate (averages may vanish where the functions that are
averaged do not), over the length of a segment, grown along it as fast as anything does.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.systems.accuracy import accuracy_of_equations

if TYPE_CHECKING:
    from contin.loci.shooting.curve import ShootingCurve
    from contin.loci.shooting.expansion import Expansion


def error_of_equations(curve: ShootingCurve, z: Array, scale: Array) -> float:
    """What the accuracy of the equations leaves of either parameter, in the first one's unit and relative metric.

    Zero for equations that are exact, infinite where it cannot be told. Cost: one linearisation.
    """
    accuracy = accuracy_of_equations(curve.orbits.system)
    if accuracy == 0.0:
        return 0.0
    equations, at = curve.settled(z, scale).linearise(z, scale), curve.expansion(z, scale)
    if equations is None or at is None or not np.all(np.isfinite(equations.jacobian)):
        return np.inf
    segments = _by_segment(at)
    conditions = len(equations.residual) - at.rows
    rows = np.concatenate([np.repeat(segments, at.orbits.n), [0.0], np.full(conditions, at.orbits.n * segments.sum())])
    moved = np.abs(np.linalg.pinv(equations.jacobian)[-2:]) @ rows
    return accuracy * float(moved.max() * scale[-1])


def _by_segment(at: Expansion) -> Array:
    """Bound of the change of a segment's end (and of its variations), relative to the states' sizes, (M,)."""
    nodes, orbits = at.segments.nodes, at.orbits
    p, length = orbits.full_parameters(nodes.vector()), nodes.period / nodes.count
    rates = []
    for k, u in enumerate(nodes.u):
        if orbits.system.is_forced:
            p[-1] = k * length
        by_state, by_parameters = orbits.system.jacobian(u, p)
        scaled = np.abs(by_state) * at.sizes / at.sizes[:, None]
        varied = np.abs(by_parameters[:, [at.second, orbits.active]]) * at.units[-2:] / at.sizes[:, None]
        field = np.abs(orbits.system.value(u, p)) / at.sizes
        rates.append(max(float(scaled.max()), float(varied.max()), float(field.max())))
    gains = np.abs(at.transitions).max(axis=(1, 2))
    return np.asarray(length * max(rates) * np.maximum(gains, 1.0))
