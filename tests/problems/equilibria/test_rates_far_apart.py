"""Rates many orders of magnitude apart: slow eigenvalues keep their digits, and what happens to them is found."""

import mpmath
import numpy as np
import pytest

from contin.linalg.spectrum import noises, spectrum
from tests.problems.follow import assert_labels, follow

RATES = [1e3, 1e6, 1e9, 1e12, 1e15]


@pytest.mark.parametrize("rate", RATES)
def test_errors_of_graded_eigenvalues_are_roundings_of_their_own_rates(rate):
    """Against 60 digits: random matrices with some rows multiplied by the rate, in random order."""
    generator = np.random.default_rng(7)
    with mpmath.workdps(60):
        for _ in range(12):
            n = int(generator.integers(2, 7))
            matrix = generator.normal(size=(n, n))
            matrix[: int(generator.integers(1, n))] *= rate
            order = generator.permutation(n)
            matrix = matrix[np.ix_(order, order)]
            left = [complex(v) for v in mpmath.eig(mpmath.matrix(matrix.tolist()), left=False, right=False)]
            values, rates = spectrum(matrix)
            for value, noise in sorted(zip(values, noises(values, rates), strict=True), key=lambda t: abs(t[0])):
                nearest = left.pop(int(np.argmin([abs(value - w) for w in left])))
                assert abs(value - nearest) <= 1e-10 * noise


@pytest.mark.parametrize("rate", RATES)
def test_hopf_point_beside_a_fast_state(rate):
    branch = follow(
        {"x": "1 - (B + 1)*x + x^2*y", "y": "B*x - x^2*y", "z": "k*(x - z)"}, {"x": 1.0, "y": 0.5, "z": 1.0},
        {"B": 0.5, "k": rate}, (0.5, 4.0),
    )  # fmt: skip
    assert_labels(branch, [("HB", 2.0)])
    assert branch.notes == ()
    assert branch["HB1"].normal_form["l1"] == pytest.approx(-0.375, rel=1e-6)


@pytest.mark.parametrize("rate", RATES)
def test_fold_beside_a_fast_state(rate):
    branch = follow({"x": "p - x^2", "z": "k*(x - z)"}, {"x": 1.0, "z": 1.0}, {"p": 1.0, "k": rate}, (-1.0, 1.5))
    assert_labels(branch, [("LP", 0.0)])
    assert branch.notes == ()
