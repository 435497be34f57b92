"""Trigonometric interpolation, and rotation numbers of quasiperiodic points."""

import numpy as np
import pytest

from contin.tori import fourier


def test_shifts_are_exact_for_resolved_curves_and_rotations_for_quasiperiodic_points():
    s = fourier.nodes(9)
    curve = lambda s: np.stack([np.cos(2 * np.pi * s), np.sin(6 * np.pi * s)], axis=1)  # noqa: E731
    values, slopes = fourier.shift(9, 0.3)
    assert np.allclose(values @ curve(s), curve(s + 0.3))
    assert np.allclose(slopes @ curve(s), (curve(s + 0.3 + 1e-6) - curve(s + 0.3 - 1e-6)) / 2e-6, atol=1e-6)
    assert np.allclose(fourier.resampled(curve(s), 15), curve(fourier.nodes(15)))
    turn = 0.5 * (np.sqrt(5) - 1) / 2
    angles = 2 * np.pi * turn * np.arange(2000)
    points = np.stack([np.cos(angles), 0.4 * np.sin(angles)], axis=1)
    assert abs(fourier.rotation(points)) == pytest.approx(turn, abs=1e-12)  # either way round
    assert np.allclose(fourier.fitted(points, turn, 5)[:, 0], np.cos(2 * np.pi * fourier.nodes(5)))
