"""The reduced equation of a branch point with a k-dimensional kernel, in the coordinates that FORMATS gives it.

The branches of such a point are found in coordinates made for its borders (`multiple_kernel`): lengths are those of
the metric, the last coordinate is along the branch. What is stated is in the user's units, as small systems have it
(`contin.normalforms.reduction`): columns of Q orthonormal over the states with mass, <P, M Q> = 1, the coordinates
y = (x, dp), and second-order parts across P.
"""

from __future__ import annotations

from itertools import combinations_with_replacement, permutations
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.linalg.linear import moving
from contin.problems.sparse.forms import linear_at

if TYPE_CHECKING:
    from contin.problems.sparse.multiple_kernel import Kernel


def kernel_coefficients(kernel: Kernel, z: Array) -> dict[str, object]:
    """`a01` (k,), `quadratic` (k, k + 1, k + 1) and `cubic` (k, k, k, k) at the branch point z, as lists.

    Cost: a factorisation, and O(k^3) solves and forms of order up to 3.
    """
    linear, k = linear_at(kernel.problem, z), kernel.k
    q, across = _null_vectors(kernel, z)
    heavy = linear.weigh(q)
    solver = kernel.bordered(linear, heavy, q, np.zeros((k, k)))

    def project(r: Array) -> tuple[Array, Array]:
        """(x, <P, r>) with A x = -(r - M Q <P, r>) and <P, M x> = 0."""
        found = np.real(solver.solve(np.append(r, np.zeros(k))))
        x, value = found[:-k], found[-k:]
        return -(x - q @ np.real(solver.solve(np.append(linear.weigh(x), np.zeros(k)))[-k:])), value

    h = across - q @ project(linear.weigh(across))[1]
    lifted = np.vstack([np.column_stack([q.T, np.zeros(k)]), np.append(h, 1.0)])
    form, size = kernel.problem.form, k + 1
    T2, bent = np.empty((k, size, size)), np.empty((size, size, len(z)))
    for i, j in combinations_with_replacement(range(size), 2):
        x, value = project(form(z, lifted[i], lifted[j]))
        T2[:, i, j] = T2[:, j, i] = value
        bent[i, j] = bent[j, i] = np.append(x, 0.0)
    T3 = np.empty((k, k, k, k))
    for a, b, c in combinations_with_replacement(range(k), 3):
        terms = form(z, lifted[a], lifted[b], lifted[c])
        for one, (d, e) in ((a, (b, c)), (b, (a, c)), (c, (a, b))):
            terms = terms + form(z, lifted[one], bent[d, e])
        value = project(terms)[1]
        for i, j, m in permutations((a, b, c)):
            T3[:, i, j, m] = value
    a01 = project(kernel.problem.parameter_slope(z))[1]
    return {"a01": a01.tolist(), "quadratic": T2.tolist(), "cubic": T3.tolist()}


def _null_vectors(kernel: Kernel, z: Array) -> tuple[Array, Array]:
    """Q (n, k), and a state (n,) that belongs to a unit of the parameter: they span the null space of [F_u F_p]."""
    _, along, _ = kernel.slopes(z)
    speeds = along[:, -1]
    resting = np.linalg.svd(speeds[None, :])[2][1:]  # combinations along which the parameter does not move
    vectors = (resting @ along)[:, :-1].T
    counted = moving(linear_at(kernel.problem, z))
    return vectors @ np.linalg.inv(np.linalg.qr(vectors[counted])[1]), (speeds @ along)[:-1] / float(speeds @ speeds)
