"""Branch points of boundary-value problems at which several modes vanish at once: all branches through them.

The reduction of large systems (`contin.problems.sparse.multiple_kernel`) in the unknowns of a mesh, bordered by the
null functions and by the left null vectors, which collocation does not pair with them. There is one where all first
derivatives of the reduced equations vanish at one place; elsewhere (two folds at one place) fewer branches cross than
modes say.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from contin.abi import Array
from contin.bvp.kernel_at_branch_point import SmallestValues, nearly_null
from contin.bvp.on_mesh import OnMesh
from contin.linalg.vectors import norm
from contin.machine import elementary
from contin.normalforms.directions import any_branch_point
from contin.problems.sparse.multiple_kernel import Kernel, ReducedJet
from contin.problems.sparse.reduced_equation import border_rows
from contin.records import Fields

ALONG: Final = 1e-3  # (scaled) how far off a place may be that one mode finds alone
BACK: Final = 100.0  # times that: a correction so long does not come back to it
WITHIN: Final = 3.0  # errors of the parameter within which two places are one
ROUNDING: Final = 1e-14
TOLD: Final = ("kind", "kernel", "scaling", "branches", "continua", "repeated")  # what no basis of the kernel changes


def reduced_to_kernel(
    mesh: OnMesh, x: Array, tangent: Array, scale: Array, small: SmallestValues, error: float
) -> ReducedJet | None:  # fmt: skip
    """The equations reduced to all that nearly vanishes of F_u at x, where it vanishes together, at the jet's own z.

    None where less than two modes nearly vanish, or not together at x. One mode alone finds that place to the error of
    its parameter; along the others the equations are of second order, and so is what the parameter is off by.
    tangent : of the branch at hand, scaled.  small : of F_u at x.  error : of its parameter.  May raise
    ArithmeticError.
    """
    vectors, linear = nearly_null(mesh, x, small), mesh.linear(x)
    k = vectors.shape[1]
    if k < 2 or linear is None:
        return None
    nulls = np.linalg.qr(np.vstack([vectors / scale[:-1, None], np.zeros((1, k))]))[0]
    left = np.linalg.qr(np.column_stack([linear.factor.solve_transposed(v) for v in vectors.T]))[0]
    kernel = Kernel(mesh, x, border_rows(nulls, tangent, scale), left, scale)
    found = kernel.point(BACK * ALONG)
    if found is None:
        return None
    off = (found[0] - x) / scale
    known = WITHIN * error / float(scale[-1]) + ROUNDING + elementary.square(norm(off[:-1]))
    if not (norm(off) <= ALONG and abs(float(off[-1])) <= known):
        return None
    return ReducedJet(kernel, found[0])


def form_of(jet: ReducedJet) -> Fields:
    """`kernel`, `scaling` and the number of branches."""
    form = any_branch_point(jet.reduction.jet, kernel=jet.kernel.k, reduction=jet.reduction).coefficients
    return {name: form[name] for name in TOLD if name in form}
