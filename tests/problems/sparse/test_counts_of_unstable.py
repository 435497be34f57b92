"""`unstable` of sparse systems with many unstable eigenvalues from the first row on, against dense eigenvalues.

Rows and labels: at a label the critical eigenvalue is not counted, and the matrix is singular to rounding there.
"""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse

import contin
from contin import api
from contin.linalg.inertia import positive_eigenvalues


def differences(n, length):
    h = length / (n + 1)
    first = scipy.sparse.diags([-1.0, 1.0], [-1, 1], shape=(n, n), format="csc") / (2.0 * h)
    second = scipy.sparse.diags([1.0, -2.0, 1.0], [-1, 0, 1], shape=(n, n), format="csc") / h**2
    return first, second


def reaction(linear, p):
    """u' = L u + p u - u^3 from rest."""
    return contin.FunctionProblem(
        lambda u, q: linear @ u + q["p"] * u - u**3, np.zeros(linear.shape[0]), {"p": p},
        lambda u, q: (linear + scipy.sparse.diags(q["p"] - 3.0 * u**2)).tocsc(),
    )  # fmt: skip


def wrong_counts(linear, p, bounds, steps):
    branch = api.continuation(api.equilibrium(reaction(linear, p)), "p", bounds, settings={"steps": steps})
    growth = np.linalg.eigvals(linear.toarray()).real
    found = []
    for row, (value, unstable) in enumerate(zip(branch.columns["p"], branch.columns["unstable"], strict=True)):
        critical = np.abs(growth + value) <= 1e-7 * np.abs(value)
        if int(np.sum((growth + value > 0.0) & ~critical)) != unstable:
            found.append((row, value, unstable))
    return branch, found


LONG = pytest.mark.long


@pytest.mark.parametrize(
    ("n", "wind"),
    [
        (100, 0.3), (300, 0.0), (300, 5.0),
        *(pytest.param(n, wind, marks=LONG) for n, wind in ((100, 0.0), (100, 5.0), (300, 0.3))),
    ],
)  # fmt: skip
@pytest.mark.seldom
def test_diffusion_with_a_wind(n, wind):
    first, second = differences(n, np.pi)
    branch, wrong = wrong_counts(second + wind * first, 90.5, (80.0, 110.0), 12)
    assert not wrong
    assert not branch.notes
    assert branch.points


@pytest.mark.parametrize(("n", "length"), [(120, 20.0), (560, 40.0)])
def test_a_fourth_order_equation_whose_bounds_are_far_too_wide(n, length):
    """Swift and Hohenberg's: Gershgorin's discs of the symmetric matrix reach 1e4 times as far as its eigenvalues."""
    whole = scipy.sparse.identity(n) + differences(n, length)[1]
    branch, wrong = wrong_counts((-whole @ whole).tocsc(), 0.5, (0.4, 0.6), 6)
    assert not wrong
    assert not branch.notes


@pytest.mark.parametrize("seed", range(6))
def test_inertia_is_that_of_dense_eigenvalues(seed):
    random = np.random.default_rng(seed)
    a = scipy.sparse.random(80, 80, 0.05, random_state=seed) + scipy.sparse.diags(random.normal(size=80))
    a = (a + a.T).tocsc()
    count = positive_eigenvalues(a)
    assert count is None or count == int(np.sum(np.linalg.eigvalsh(a.toarray()) > 0.0))
    shifted = (a - 20.0 * scipy.sparse.identity(80)).tocsc()
    assert positive_eigenvalues(shifted) == 0
