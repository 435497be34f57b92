"""A matrix as well as it is known: with other rounding errors of its entries."""

from __future__ import annotations

import numpy as np

from contin.linalg.factor import Factoriser
from contin.linalg.linear import DirectLinear, Linear
from contin.normalforms.result import NotThisTypeError
from contin.problems.sparse.forms import EPSILON, SAME


def rounded(linear: Linear, slopes: float, generator: np.random.Generator) -> Linear:
    """Entries off by rounding, or by the part `slopes` of them where differences give them.

    Those of the diagonal are off by a common part besides, as where all rows of a discretisation are alike: that shifts
    all eigenvalues together, where random errors of many rows cancel.
    """
    if linear.matrix is None:
        raise NotThisTypeError("the Jacobian is only applied, and what rounding does to it is not known")
    matrix = linear.matrix.tocsc(copy=True)
    amount = max(EPSILON, slopes)
    matrix.data = matrix.data * (1.0 + amount * generator.uniform(-1.0, 1.0, matrix.nnz))
    column = np.repeat(np.arange(matrix.shape[1]), np.diff(matrix.indptr))
    own = matrix.indices == column
    matrix.data[own] *= 1.0 + 2.0 * SAME * amount * generator.choice([-1.0, 1.0])
    return DirectLinear(matrix, Factoriser(), mass=linear.mass)
