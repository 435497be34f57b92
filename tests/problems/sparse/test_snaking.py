"""Localised states of the Swift-Hohenberg equation snake: published folds, and counts of a dense method."""

import numpy as np
import pytest
import scipy.sparse as sp

import contin

NODES, LENGTH = 121, 10.0 * np.pi


def even_derivative():
    """d^2/dx^2 of order 4 of functions that are even about both ends."""
    step = LENGTH / (NODES - 1)
    found = sp.lil_matrix((NODES, NODES))
    for i in range(NODES):
        for offset, weight in zip(range(-2, 3), (-1 / 12, 4 / 3, -5 / 2, 4 / 3, -1 / 12), strict=True):
            j = abs(i + offset)
            found[i, min(j, 2 * (NODES - 1) - j)] += weight / step**2
    return sp.csc_matrix(found)


@pytest.mark.seldom
def test_folds_of_snaking_states_are_the_published_ones_and_change_one_eigenvalue_each():
    """u_t = r u - (1 + dxx)^2 u + 1.8 u^2 - u^3: folds tend to r = -0.3390 and -0.2593 as the state grows longer
    (Burke and Knobloch, Phys. Rev. E 73 (2006) 056211)."""
    x, one = np.linspace(0.0, LENGTH, NODES), sp.identity(NODES, format="csc")
    root = one + even_derivative()
    operator = (root @ root).tocsc()
    problem = contin.FunctionProblem(
        lambda u, p: p["r"] * u - operator @ u + 1.8 * u * u - u**3, 1.6 * np.cos(x) / np.cosh(x / 6.0), {"r": -0.3},
        lambda u, p: (p["r"] * one - operator + sp.diags(3.6 * u - 3.0 * u * u)).tocsc(),
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(problem), "r", (-0.36, -0.2), settings={"steps": 16})
    folds = sorted(point.values["r"] for point in line.points)
    assert [point.type for point in line.points] == ["LP"] * len(folds)
    assert folds[0] == pytest.approx(-0.3390, abs=1e-4)
    assert folds[-1] == pytest.approx(-0.2593, abs=1e-4)
    assert not line.notes
    for row in range(0, len(line), 6):
        u, r = line.z[row, :-1], line.z[row, -1]
        values = np.linalg.eigvals(problem.jacobian(u, {"r": r}).toarray()).real
        assert line.columns["unstable"][row] == np.sum(values > 0.0)
