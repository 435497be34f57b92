"""Unstable eigenvalues that have grown far from zero, with many stable ones nearer, are still counted.

lap u + lam exp(u) = 0 on the unit square: beyond the fold the solution becomes a peak, whose eigenvalue grows by up to
half of itself a step. The reference is the inertia of the symmetric Jacobian, from the signs of its pivots (Sylvester).
"""

import numpy as np
import pytest

import contin
from contin.linalg.factor import Factoriser
from contin.linalg.inertia import positive_eigenvalues
from contin.problems.sparse import jacobian as source
from tests.problems.sparse.test_old_factors import plate


def with_factors_of_earlier_points(monkeypatch):
    monkeypatch.setattr(source, "ALWAYS_FACTORED", 10)
    monkeypatch.setattr(Factoriser, "is_band_for", lambda self, matrix: False)


@pytest.mark.parametrize("earlier", [False, True])
def test_stability_along_a_peak_is_that_of_the_inertia(earlier, monkeypatch):
    if earlier:
        with_factors_of_earlier_points(monkeypatch)
    problem = plate(23)  # 529 states: not as few as have all their eigenvalues computed where that is in doubt
    branch = contin.continuation(problem, "lam", (0, 10), settings={"steps": 42})
    assert branch.columns["lam"][-1] < 0.7 < 6.0 < branch.columns["lam"].max()
    for row in np.flatnonzero(np.nanmin(np.abs(branch.eigenvalues), axis=1) > 1e-3):  # not at its fold
        z = branch.z[row]
        count = positive_eigenvalues(problem.jacobian(z[:-1], {"lam": z[-1]}))
        assert branch.columns["unstable"][row] == count, (row, z[-1])
    assert not branch.notes
    assert branch.effort["applications"] <= 2200  # measured 1,960 and 1,632
