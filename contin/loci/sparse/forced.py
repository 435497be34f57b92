"""Whether a vanishing eigenvalue is unfolded by no parameter, as where Hopf and branch points meet."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.linalg.linear import Linear
from contin.loci.codim2.zero_hopf_crossing import EXACT
from contin.normalforms.linear import EigenPair
from contin.problems.sparse.forms import EPSILON
from contin.systems.functions.function_system import SLOPES

if TYPE_CHECKING:
    from contin.loci.sparse.on_large_curve import OnLargeCurve

SEVERAL = 100.0  # rounding errors of F


def is_forced(problem: OnLargeCurve, z: Array, linear: Linear, pair: EigenPair, widths: Array) -> bool:
    """True where psi . F_p vanishes for both parameters: to EXACT of its terms, and of what they are where the state
    moves along the null vector by its own size; and to rounding of F, whose terms may be much larger than F_p's.

    widths : scales of the second and of the first parameter.
    """
    curve, n = problem.curve, problem.n
    system, p, u = curve.origin.system, curve.full_parameters(z), z[: problem.n]
    psi, sizes = pair.left.real, system.sizes_at(u)
    along = np.zeros(n + system.m)
    along[:n] = pair.right.real / np.max(np.abs(pair.right.real) / sizes)
    exact = system.lines.analytic or system.model.parameter_jacobian is not None
    rounding = SEVERAL * EPSILON if exact else SLOPES
    lost = rounding * float(np.abs(psi) @ linear.magnitude(np.abs(u)))
    for k, width in zip((curve.second, curve.first), widths, strict=True):
        direction = np.zeros(n + system.m)
        direction[n + k] = width
        slope = width * system.parameter_slope(u, p, k)
        bend = np.real(system.derivative(u, p, along, direction))
        size = float(np.abs(psi) @ (np.abs(slope) + np.abs(bend)))
        if not abs(float(psi @ slope)) <= EXACT * size + lost:
            return False
    return True
