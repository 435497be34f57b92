"""What values that are rounded to some digits, or noisy, leave of a special point of a large system."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.continuation.sample import Frame
from contin.problems.sparse.zero_on_curve import At, Zero
from contin.systems.functions.grain import generic_line, glance, grain

if TYPE_CHECKING:
    from contin.problems.sparse.large_equations import LargeEquations

NOISY: Final = 5e-14  # of the terms: more is no rounding of double precision
SAMPLES: Final = 4  # of what components may be off by together
SAFETY: Final = 2.0  # times the largest of them


def error_of_grain(
    problem: LargeEquations, found: Zero, frame: Frame, sizes: Callable[[Array], Array], measure: Callable[[At], float]
) -> float:
    """The error of the parameter, 0 where values are known to rounding: eight more of them tell that.

    sizes : typical states (n,) -> what the terms of F are as large as.  measure : what vanishes at the point; values
    that are off move the point on its plane, by so much changes what is measured there, and where it vanishes.
    """
    z, n = found.at.z, problem.n
    line = generic_line(np.maximum(np.abs(z), frame.scale / np.sqrt(n)))
    values = lambda t: np.array([problem.residual(z + x * line) for x in t])  # noqa: E731
    if not np.any(glance(values) > NOISY * sizes(np.abs(line[:-1]))):
        return 0.0
    off = grain(values) / frame.scale[:-1]
    here = problem.linearisation(z, found.at.tangent, frame.scale)
    if here is None:
        return np.inf
    signs = np.random.default_rng(5).choice([-1.0, 1.0], (SAMPLES, n))
    moved = [here.solve(np.append(row * off, 0.0)) for row in signs]
    changed = [measure(replace(found.at, z=z + step * frame.scale)) - found.left for step in moved]
    along = float(frame.scale[-1]) * np.abs([step[-1] for step in moved])
    return float(SAFETY * np.max(along + np.abs(changed) / abs(found.by_parameter)))
