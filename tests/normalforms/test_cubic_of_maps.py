"""The cubic coefficients by their formulas beside those of the centre manifold, values and errors."""

from __future__ import annotations

from collections.abc import Callable
from itertools import permutations

import numpy as np
import pytest

from contin.abi import Array
from contin.normalforms.cubic_of_maps import at_flip, on_circle
from contin.normalforms.jet import DerivativeJet
from contin.normalforms.maps import cubic_beyond_error, cubic_on_circle, flip_manifold, neimark_sacker
from contin.normalforms.result import TRUST


def jets(block: Array, n: int, seed: int) -> Callable[[], DerivativeJet]:
    """A map of n states with one parameter whose critical multipliers are those of `block`, in random coordinates."""
    rng = np.random.default_rng(seed)
    k = len(block)
    inner = np.diag(rng.uniform(-3.0, 3.0, n))
    inner[:k, :k] = block
    basis = rng.normal(size=(n, n))
    matrix = basis @ inner @ np.linalg.inv(basis)
    second = rng.normal(size=(n, n + 1, n + 1))
    second = second + second.transpose(0, 2, 1)
    third = rng.normal(size=(n, n + 1, n + 1, n + 1))
    third = sum(third.transpose(0, *(1 + k for k in order)) for order in permutations(range(3)))

    def derivative(directions: tuple[Array, ...]) -> Array:
        if len(directions) == 2:
            return np.einsum("ijk,j,k", second, *directions)
        return np.einsum("ijkl,j,k,l", third, *directions)

    return lambda: DerivativeJet(matrix, derivative, parameters=1, kind="map")


@pytest.mark.parametrize("n", [1, 2, 3, 6])
def test_a_period_doubling(n: int) -> None:
    for seed in range(5):
        jet = jets(np.array([[-1.0]]), n, seed)
        manifold = flip_manifold(jet())
        found = at_flip(jet(), with_error=True)
        assert found.value == pytest.approx(manifold.g((3,), 0), rel=1e-10)
        assert np.array_equal(found.right, manifold.right[0].real)
        assert found.error is None or found.error == pytest.approx(TRUST * manifold.magnitude((3,), 0), rel=1e-10)


@pytest.mark.parametrize("n", [2, 3, 6])
@pytest.mark.parametrize("theta", [0.3, 1.9, 2.8])
def test_a_circle(n: int, theta: float) -> None:
    block = np.array([[np.cos(theta), -np.sin(theta)], [np.sin(theta), np.cos(theta)]])
    for seed in range(5):
        jet = jets(block, n, seed)
        form = neimark_sacker(jet(), theta)
        found = on_circle(jet(), theta, with_error=True)
        assert found is not None
        assert found.value == pytest.approx(complex(*form.coefficients["d"]), rel=1e-10)
        assert found.error is None or found.error == pytest.approx(form.errors["d"], rel=1e-10)


def test_next_to_a_strong_resonance_the_manifold_tells() -> None:
    theta = 2.0 * np.pi / 3.0
    block = np.array([[np.cos(theta), -np.sin(theta)], [np.sin(theta), np.cos(theta)]])
    jet = jets(block, 3, 1)
    assert on_circle(jet(), theta) is None
    assert cubic_on_circle(jet(), theta) == pytest.approx(
        complex(*neimark_sacker(jet(), theta).coefficients["d"]), rel=1e-12
    )


def test_a_value_within_its_error_has_no_sign() -> None:
    """w -> e^{i theta} w (1 + i |w|^2): Re d = 0."""
    theta = 1.1
    block = np.array([[np.cos(theta), -np.sin(theta)], [np.sin(theta), np.cos(theta)]])

    def derivative(directions: tuple[Array, ...]) -> Array:
        if len(directions) == 2:
            return np.zeros(2)
        complex_ = [complex(*d[:2]) for d in directions]
        third = sum(complex_[i] * complex_[j] * complex_[k].conjugate() for i, j, k in permutations(range(3)))
        image = np.exp(1j * theta) * 1j * third
        return np.array([image.real, image.imag])

    assert cubic_beyond_error(DerivativeJet(block, derivative, kind="map"), theta) == 0.0
