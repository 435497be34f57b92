"""The metric at the start of a branch of equilibria: what `contin.problems.scales` needs, taken from the equations."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.problems.scales import bending_lengths, parameter_width, state_scales
from contin.simulate.beyond_slopes import lengths_beyond_slopes
from contin.simulate.natural import BENDS_UP_TO, growth_lengths, pure_derivatives, sizes_of

if TYPE_CHECKING:
    from contin.problems.equilibria.equations import AlgebraicEquations

FARTHER: Final = 10.0  # what a metric may allow for states that grow
ROUNDED: Final = 1e-8  # of the branch's metric: a length that is smaller at a special point may be its rounding error


def scales_at(
    problem: AlgebraicEquations, z: Array, bounds: tuple[float, float]
) -> tuple[Array, NDArray[np.bool_], float]:
    """Sizes of the states (n,), which of them are a mere 1, and the scale of the parameter."""
    width = parameter_width(problem.system.model, problem.parameters[0], float(z[-1]), bounds)
    jacobian = problem.linearise(z)[1]
    declared, usual = sizes_of(problem.system.model, tuple(problem.full_parameters(z).tolist()))
    declared = np.where(problem.angle_periods > 0.0, problem.angle_periods / (2.0 * np.pi), declared)
    lengths = None
    if problem.n <= BENDS_UP_TO and np.any(z[:-1] != 0.0):
        lengths = bending_lengths(z[:-1], jacobian, _second_derivatives(problem, z), width)
    growth = _growth(problem, z, jacobian, width, bounds) if problem.n <= BENDS_UP_TO else ()
    states, unknown = state_scales(z[:-1], jacobian, width, declared, usual, lengths, growth)
    return states, unknown, width


def near_point(problem: AlgebraicEquations, z: Array, scale: Array) -> Array:
    """Sizes (n,) for a curve that begins at a point z of a branch whose metric is `scale` (n + 1,).

    The branch may have come from far away: a gas of large volume, whose liquid bends over a thousandth of it. A size is
    no more than `FARTHER` times the state and the length over which the equations bend here, where these are known;
    they are not where the state and, at a branch point, its F_u are zero to rounding.
    """
    sizes = np.asarray(scale[:-1])
    if problem.n > BENDS_UP_TO or not np.any(z[:-1] != 0.0):
        return sizes
    lengths = bending_lengths(z[:-1], problem.linearise(z)[1], _second_derivatives(problem, z), float(scale[-1]))
    here = FARTHER * np.maximum(np.abs(z[:-1]), lengths)
    known = np.isfinite(lengths) & (lengths > 0.0) & (here > ROUNDED * sizes)
    return np.where(known, np.minimum(sizes, here), sizes)


def _second_derivatives(problem: AlgebraicEquations, z: Array) -> Array:
    """d^2 F_k / d u_i^2, (n, n)."""
    directions = np.eye(problem.n, problem.n + 1)
    return np.column_stack([problem.hessian(z, directions[i])[:, i] for i in range(problem.n)])


def _growth(
    problem: AlgebraicEquations, z: Array, jacobian: Array, width: float, bounds: tuple[float, float]
) -> Iterator[tuple[Array, Array]]:
    """Lengths at rest (n,), with slopes as large as they become, and second derivatives (n, n): three, one by one.

    `growth_lengths` at the start; with derivatives as large as they are there or at an end of the parameter's range (of
    sin(x) (p^2 cos(x) - 1) the third one vanishes at p = 1/2, by chance); and from values, where all these vanish.
    """
    n, p = problem.n, problem.full_parameters(z)
    by_parameter = problem.hessian(z, np.eye(1, n + 1, n)[0])[:, :n]
    slopes = np.nan_to_num(np.maximum(np.abs(jacobian[:, :n]), np.abs(by_parameter) * width))
    known = pure_derivatives(problem.system, z[:n], p)
    yield growth_lengths(slopes, *known), known[0]
    ends = [problem.full_parameters(np.append(z[:n], end)) for end in bounds if np.isfinite(end)]
    second, third = np.max(np.array([known, *(pure_derivatives(problem.system, z[:n], end) for end in ends)]), axis=0)
    lengths = growth_lengths(slopes, second, third)
    yield lengths, second
    yield lengths_beyond_slopes(problem.system, z[:n], p, slopes, lengths), second
