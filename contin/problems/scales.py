"""The metric at the start of a run: one scale per unknown, covariant under a change of units.

If a state is measured in other units, its scale changes by the same factor and the run is the same. A state's scale is
what the model declares, or its size at the start, or how far the branch moves it while the parameter crosses its range;
where both vanish, the size that the Jacobian's coupling to the others suggests (Osborne's balancing); where nothing is
coupled, that of the model's own starts, or the length over which the equations bend. A state far from zero, beside the
length over which the equations bend (a pressure near 1e5 whose changes matter), gets that length.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.model.model import Model
from contin.simulate.natural import ROUNDING as NEXT_TO_ZERO
from contin.simulate.natural import beyond_rounding, filled

SENSITIVITY_CAP = 10.0  # near a fold du/dp says nothing: it may enlarge the scale of a state by this factor at most
NEGLIGIBLE = 1e-9  # a state this small beside its balanced scale is a zero with rounding errors
ROUNDING = 1e-14  # of the terms that cancelled
OFFSET = 100.0  # a state this many bending lengths from zero is far from it
VERTEX = 1e-11  # of a state: a bending length this small is the rounding of a slope at a parabola's vertex
UNDETERMINED = 4.0 * np.finfo(float).eps  # of what each term of an equation may be wrong
SINGULAR = 1e8  # condition of a state beyond which the inverse of the Jacobian says nothing of its rounding
STILL = 1e3  # rounding errors of a state that is zero, below which its motion is rounding, too


def bending_lengths(u: Array, jacobian: Array, hessians: Array, parameter_scale: float) -> Array:
    """Shortest length of each state over which an equation bends, (n,); infinite where none does, 0 where unknown.

    u : (n,).  jacobian : (n, n + 1).  hessians : (n, n), entry (k, i) = d^2 F_k / d u_i^2.  On a + b u + c u^2
    the length is the larger of |b/c| and sqrt(|a_p| width/|c|), half of what the parameter's range cuts out of it. At
    its vertex, as of w(u)^2 where w vanishes, it says nothing, and there b is rounding.
    """
    n = len(jacobian)
    bends = np.abs(hessians)
    with np.errstate(divide="ignore", invalid="ignore"):
        slopes = np.abs(jacobian[:, :n]) / bends
        widths = np.sqrt(np.abs(jacobian[:, [n]]) * parameter_scale / bends)
    lengths = np.where(bends > 0.0, np.maximum(slopes, widths), np.inf)
    lengths = np.where((lengths > 0.0) & (lengths < VERTEX * np.abs(u)), np.inf, lengths)
    return np.asarray(np.min(np.where(np.isfinite(lengths) | np.isinf(lengths), lengths, 0.0), axis=0))


def state_scales(
    u: Array,
    jacobian: Array,
    parameter_scale: float,
    declared: Array,
    usual: Array,
    lengths: Array | None = None,
    growth: Iterable[tuple[Array, Array]] = (),
) -> tuple[Array, NDArray[np.bool_]]:
    """Typical sizes of the states, (n,), all positive; and which of them are a mere 1.

    u : (n,) start.  jacobian : (n, n + 1) = [F_u | F_p] there.  parameter_scale : length of the parameter's range.
    declared, usual : `contin.simulate.natural.sizes_of`.  lengths : `bending_lengths`, where they are known.
    growth : lengths (n,) as `contin.simulate.natural.growth_lengths` gives them and |d^2 F_k / d u_i^2| (n, n), for
    states about which nothing else is known; the next ones for those about which these say nothing.
    """
    n = u.size
    size = beyond_rounding(u, usual)
    finite = bool(np.all(np.isfinite(jacobian)))
    motion = _motion(jacobian, parameter_scale) if finite else np.zeros(n)
    rounding = _rounding(u, jacobian[:, :n]) if finite else np.zeros(n)
    motion = np.where((size <= rounding) & (motion <= STILL * rounding), 0.0, motion)
    size = np.where(size <= rounding, 0.0, size)
    if lengths is not None and finite:
        size = np.where(_passes_zero(size, motion, lengths, jacobian[:, :n]), 0.0, size)
    scale = np.where(size > 0.0, np.maximum(size, np.minimum(motion, SENSITIVITY_CAP * size)), motion)
    if lengths is not None:
        near = OFFSET * np.maximum(lengths, motion)
        scale = np.where((lengths > 0.0) & (size > near), near, scale)
    scale = np.where(declared > 0.0, declared, scale)
    coupling = np.abs(jacobian[:, :n]) if finite else np.zeros((n, n))
    balanced, unknown = filled(scale, coupling, lengths=lengths)
    said = ~unknown & (scale > NEXT_TO_ZERO * scale.max(initial=0.0)) & (usual > 0.0)  # also beside those found below
    if unknown.any() and usual.any():
        balanced, unknown = filled(np.where(unknown, usual, scale), coupling, lengths=lengths, said=said)
    if unknown.any():
        seen = scale
        for lengths, second in growth:
            said |= unknown & (lengths > 0.0)
            seen = np.where(unknown, lengths, seen)
            balanced, unknown = filled(seen, coupling, second, said=said)
            if not unknown.any():
                break
    small = (declared == 0.0) & (scale < NEGLIGIBLE * balanced)
    result = np.where(small | (scale <= 0.0), balanced, scale)
    return result, unknown


def _motion(jacobian: Array, parameter_scale: float) -> Array:
    """How far the parameter's range moves every state, to first order, (n,); 0 where that is rounding."""
    n = len(jacobian)
    try:
        inverse = np.linalg.inv(jacobian[:, :n])
    except np.linalg.LinAlgError:
        return np.zeros(n)
    if not np.all(np.isfinite(inverse)):  # singular to rounding, as in a continuum of equilibria
        return np.zeros(n)
    slopes = jacobian[:, n]
    motion = np.abs(inverse @ slopes) * parameter_scale
    noise = ROUNDING * (np.abs(inverse) @ np.abs(slopes)) * parameter_scale
    return np.asarray(np.where(np.isfinite(motion) & (motion > noise), motion, 0.0))


def _rounding(u: Array, matrix: Array) -> Array:
    """Rounding errors of a solved state, (n,): |J^-1| |J| |u| eps; 0 where J is too nearly singular to tell.

    A state below that is a zero: x' = -x + w(y)^2 where w(y) = 0 has x = 1e-33 in place of 0.
    """
    condition = _condition(matrix)
    return np.zeros(u.size) if condition is None else np.asarray(UNDETERMINED * (condition @ np.abs(u)))


def _condition(matrix: Array) -> Array | None:
    """|J^-1| |J|, (n, n); None where J is too nearly singular to tell."""
    try:
        inverse = np.linalg.inv(matrix)
    except np.linalg.LinAlgError:
        return None  # as below: singular, and callers know it by that
    if not np.all(np.isfinite(inverse)):
        return None
    condition = np.abs(inverse) @ np.abs(matrix)
    known = np.isfinite(condition).all() and float(np.diag(condition).max()) < SINGULAR
    return condition if known else None


def _passes_zero(size: Array, motion: Array, lengths: Array, matrix: Array) -> NDArray[np.bool_]:
    """States next to nothing beside the way the parameter moves them, where that is no neighbouring fold's doing.

    x' = p - 1/2 + x (...) has x = 1e-17 at p = 1/2, which is the rounding of terms that cancel: no size of x.
    """
    return np.asarray((size < NEGLIGIBLE * motion) & (motion <= OFFSET * lengths) & (_condition(matrix) is not None))


def parameter_width(model: object, name: str, value: float, bounds: tuple[float, float]) -> float:
    """Scale of a parameter: the width of its range; of an endless one its own scale or range, its size, or 1.

    Its size is its value, or the larger one that the model gives it: a value of 1e-17 may be a zero.
    """
    width = bounds[1] - bounds[0]
    if np.isfinite(width):
        return width
    own = getattr(model, "parameter_scale", None)
    declared = None if own is None else own(name)
    if declared:
        return float(declared)
    usual = float(model.default_parameters()[name]) if isinstance(model, Model) else 0.0
    return max(abs(value), abs(usual)) or 1.0
