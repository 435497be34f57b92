"""The cubic through two points of a curve and their tangents, against curves that are known."""

import numpy as np
import pytest

from contin.continuation.extrapolation import cubic


def helix(t):
    """A curve whose torsion and speed vary, and its velocity."""
    point = np.array([np.cos(t), np.sin(t), t + 0.3 * t * t, np.exp(0.5 * t)])
    return point, np.array([-np.sin(t), np.cos(t), 1.0 + 0.6 * t, 0.5 * np.exp(0.5 * t)])


def around(h, length=1.0, back=-1.0):
    """The cubic at t = 1 from the point a time h before it, and the points before, at and after; as seen from t = 1."""
    (here, slope), (there, old), (beyond, next_) = (helix(1.0 + h * k) for k in (0.0, back, 1.0))
    tangent = slope / np.linalg.norm(slope)
    return cubic(tangent, there - here, length * old), tangent, beyond - here, next_


def order(errors):
    return np.log2(errors[:-1] / errors[1:])


def test_what_lies_ahead_is_foreseen_with_fourth_order_and_its_slope_too():
    far, slopes = [], []
    for h in 0.1 * 0.5 ** np.arange(5):
        curve, tangent, beyond, velocity = around(h)
        s = tangent @ beyond
        far.append(np.linalg.norm(curve.at(s) - beyond))
        slopes.append(np.linalg.norm(curve.slope_at(beyond) - velocity / (tangent @ velocity)))
    assert order(np.array(far))[-2:] == pytest.approx(4.0, abs=0.15)
    assert order(np.array(slopes))[-2:] == pytest.approx(4.0, abs=0.15)


def test_the_cubic_passes_through_its_points_with_their_slopes():
    curve, tangent, _, _ = around(0.2)
    there, slope = helix(0.8)[0] - helix(1.0)[0], helix(0.8)[1]
    np.testing.assert_allclose(curve.at(0.0), np.zeros(4), atol=1e-15)
    np.testing.assert_allclose(curve.slope(0.0), tangent, atol=1e-15)
    np.testing.assert_allclose(curve.at(curve.back), there, atol=1e-14)
    np.testing.assert_allclose(curve.slope(curve.back), slope / (tangent @ slope), atol=1e-13)


def test_lengths_and_senses_of_the_other_slope_do_not_matter():
    beyond = around(0.1)[2]
    one, other = around(0.1)[0], around(0.1, length=-7.0)[0]
    np.testing.assert_allclose(one.at(0.05), other.at(0.05), atol=1e-14)
    np.testing.assert_allclose(one.slope_at(beyond), other.slope_at(beyond), atol=1e-12)


def test_what_is_no_smooth_curve_is_refused_and_what_is_too_far_is_not_said():
    tangent, point = np.array([1.0, 0.0]), np.array([-1.0, 0.0])
    assert cubic(tangent, point, np.array([0.3, 1.0])) is None  # it turns by more than 60 degrees
    assert cubic(tangent, point, np.array([1.0, 0.4])) is None  # a corner lies between
    assert cubic(tangent, np.array([-0.1, 1.0]), tangent) is None  # the other point lies beside, not behind
    straight = cubic(tangent, point, tangent)
    np.testing.assert_array_equal(straight.at(0.5), [0.5, 0.0])
    assert straight.slope_at(np.array([3.5, 0.0])) is None
    assert straight.slope_at(point) is None
