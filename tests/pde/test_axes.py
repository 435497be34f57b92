"""Derivative matrices, integrals and interpolation of one coordinate: exactness and observed orders."""

import numpy as np
import pytest

from contin.pde.axes import Axis


@pytest.mark.parametrize("points", [5, 6, 17])
def test_chebyshev_matrices_and_weights_are_exact_for_polynomials(points):
    axis = Axis("x", -0.5, 2.0, points, "chebyshev")
    x = axis.nodes
    for power in range(points):
        slope = power * x ** max(power - 1, 0) if power else 0 * x
        np.testing.assert_allclose(axis.derivative(1) @ x**power, slope, atol=1e-10 * 2.0**points)
        exact = (2.0 ** (power + 1) - (-0.5) ** (power + 1)) / (power + 1)
        assert axis.weights @ x**power == pytest.approx(exact, rel=1e-12)
        assert axis.interpolation(0.3) @ x**power == pytest.approx(0.3**power, abs=1e-14 * 2.0**power)


@pytest.mark.parametrize("points", [9, 12])
@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_fourier_matrices_are_exact_below_the_highest_mode(points, order):
    axis = Axis("x", 1.0, 4.0, points, "fourier", True)
    k = 2 * np.pi / 3.0
    for mode in range((points - 1) // 2 + 1):
        wave = np.exp(1j * mode * k * axis.nodes)
        np.testing.assert_allclose(axis.derivative(order) @ wave, (1j * mode * k) ** order * wave, atol=1e-9 * 9**order)
        assert axis.interpolation(1.7) @ wave == pytest.approx(np.exp(1j * mode * k * 1.7), abs=1e-12)


@pytest.mark.parametrize("points", [9, 12, 64])
@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_entries_of_fourier_matrices_are_sums_over_modes(points, order):
    k = np.arange(1, (points - 1) // 2 + 1)
    t = 2 * np.pi * np.arange(points) / points
    phase = t[:, None] * k + order * np.pi / 2  # cos differentiated `order` times
    column = 2.0 / points * (np.cos(phase) * (1.0 * k) ** order).sum(axis=1)
    if points % 2 == 0 and order % 2 == 0:
        column += np.cos(0.5 * points * t + order * np.pi / 2) * (0.5 * points) ** order / points
    matrix = Axis("x", 0.0, 2 * np.pi, points, "fourier", True).derivative(order).toarray()
    np.testing.assert_allclose(matrix[:, 0], column, atol=1e-13 * points**order)


@pytest.mark.parametrize("periodic", [False, True])
@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_differences_are_of_second_order_everywhere(periodic, order):
    if order > 2 and not periodic:
        pytest.skip("derivatives between two ends go to order 2")
    errors = []
    for points in (40, 80, 160):
        axis = Axis("x", 0.0, 2.0 * np.pi, points, "differences", periodic)
        wave = np.exp(1j * (axis.nodes + 0.3))
        errors.append(np.abs(axis.derivative(order) @ wave - 1j**order * wave).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.2)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(2.0, abs=0.1)


def test_known_slopes_enter_the_stencils_at_the_ends():
    errors = []
    for points in (40, 80):
        axis = Axis("x", 0.0, 1.0, points)
        matrix, slopes = axis.with_slopes(2, (True, True))
        value = np.exp(axis.nodes)
        errors.append(np.abs(matrix @ value + slopes @ [1.0, np.e] - value)[1:-1].max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)
    # cosines: the discrete eigenvectors of u'' with slopes zero, at the ends too
    axis = Axis("x", 0.0, 1.0, 11)
    matrix, _ = axis.with_slopes(2, (True, True))
    wave = np.cos(3 * np.pi * axis.nodes)
    np.testing.assert_allclose(matrix @ wave, -(2 - 2 * np.cos(3 * np.pi / 10)) * 100 * wave, atol=1e-10)
