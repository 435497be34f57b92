"""The metric at the start of a run: one scale per unknown, covariant under a change of units.

If a state is measured in other units, its scale changes by the same factor and the run is the same. A state's scale is
its size at the start, or how far the branch moves it while the parameter crosses its range; where both vanish, the size
that the Jacobian's coupling to the others suggests (Osborne's balancing), and 1 where nothing is coupled. A state far
from zero, beside the length over which the equations bend (a pressure near 1e5 whose changes matter), gets that length.
"""

from __future__ import annotations

import numpy as np

from contin.abi import Array

SENSITIVITY_CAP = 10.0  # near a fold du/dp says nothing: it may enlarge the scale of a state by this factor at most
NEGLIGIBLE = 1e-9  # a state this small beside its balanced scale is a zero with rounding errors
TINY = 1e-14
ROUNDING = 1e-12


OFFSET = 100.0  # a state this many bending lengths from zero is far from it


def bending_lengths(jacobian: Array, hessians: Array, parameter_scale: float) -> Array:
    """Shortest length of each state over which an equation bends, (n,); infinite where none does, 0 where unknown.

    jacobian : (n, n + 1).  hessians : (n, n), entry (k, i) = d^2 F_k / d u_i^2. On a parabola a + b u + c u^2 the
    length is the larger of |b/c| and sqrt(|a_p| width/|c|), half of what the parameter's range cuts out of it.
    """
    n = len(jacobian)
    bends = np.abs(hessians)
    with np.errstate(divide="ignore", invalid="ignore"):
        slopes = np.abs(jacobian[:, :n]) / bends
        widths = np.sqrt(np.abs(jacobian[:, [n]]) * parameter_scale / bends)
    lengths = np.where(bends > 0.0, np.maximum(slopes, widths), np.inf)
    return np.asarray(np.min(np.where(np.isfinite(lengths) | np.isinf(lengths), lengths, 0.0), axis=0))


def state_scales(
    u: Array, jacobian: Array, parameter_scale: float, angle_periods: Array, lengths: Array | None = None
) -> Array:
    """Typical sizes of the states, (n,), all positive.

    u : (n,) start.  jacobian : (n, n + 1) = [F_u | F_p] there.  parameter_scale : length of the parameter's range.
    lengths : `bending_lengths`, where they are known.
    """
    n = u.size
    size = np.abs(u)
    size[size < TINY] = 0.0
    motion = np.zeros(n)
    if np.all(np.isfinite(jacobian)):
        try:
            motion = np.abs(np.linalg.solve(jacobian[:, :n], jacobian[:, n])) * parameter_scale
        except np.linalg.LinAlgError:
            motion = np.zeros(n)
        motion[~np.isfinite(motion)] = 0.0
        motion[motion < TINY] = 0.0
    scale = np.where(size > 0.0, np.maximum(size, np.minimum(motion, SENSITIVITY_CAP * size)), motion)
    if lengths is not None:
        near = OFFSET * np.maximum(lengths, motion)
        scale = np.where((lengths > 0.0) & (size > near), near, scale)
    angles = angle_periods > 0.0
    scale[angles] = angle_periods[angles] / (2.0 * np.pi)
    coupling = np.abs(jacobian[:, :n]) if np.all(np.isfinite(jacobian)) else np.zeros((n, n))
    balanced = balance(scale, coupling)
    small = ~angles & (scale < NEGLIGIBLE * balanced)
    return np.where(small, balanced, np.where(scale > 0.0, scale, balanced))


def balance(scale: Array, coupling: Array) -> Array:
    """Fill unknown (zero) scales (n,) so that coupling (n, n) to and from the others is alike; 1 without any."""
    n = scale.size
    known = scale > ROUNDING * scale.max(initial=0.0)  # below that, the coupling decides whether it is rounding
    result = np.where(known, scale, 1.0)
    if not known.any():
        return result
    coupling = np.where(coupling > ROUNDING * coupling.max(), coupling, 0.0)
    for _ in range(10):
        for i in np.flatnonzero(~known):
            others = np.arange(n) != i
            incoming = float(coupling[i, others] @ result[others])
            outgoing = float(coupling[others, i] @ (1.0 / result[others]))
            if incoming > 0.0 and outgoing > 0.0:
                result[i] = np.sqrt(incoming / outgoing)
            elif incoming > 0.0 and coupling[i, i] > 0.0:  # only driven: as large as the others make it
                result[i] = incoming / coupling[i, i]
    return result
