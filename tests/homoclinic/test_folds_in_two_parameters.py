"""Curves of folds of connections that persist at given parameters: folds and a cusp of amplitudes, in closed form.

With s = sech t, or s = 4 f (1 - f) along a front f, s'' = q s, and w = a s obeys

    w'' = q w + w (w^6 - 3 w^4 s^2 + m w^2 s^4 - l s^6)

where a^6 - 3 a^4 + m a^2 - l = 0: folds m = 6 A - 3 A^2, l = 3 A^2 - 2 A^3 with A = a^2, and a cusp at A = 1.
"""

import numpy as np
import pytest

import contin

AMPLITUDE = 0.935
M = 2.95


def level(big, m):
    return big**3 - 3.0 * big**2 + m * big


def model(rest, fast, power):
    """u drives w; power : s^2 in terms of u."""
    states = dict.fromkeys((*rest, "w", "z"), 0)
    return contin.Model(
        "driven", states=states, parameters={"l": level(AMPLITUDE**2, M), "m": M},
        equations={
            **rest, "w": "z", "z": f"{fast}*w + w*(w^6 - 3*w^4*({power}) + m*w^2*({power})^2 - l*({power})^3)",
        },
    )  # fmt: skip


def pulses(**settings):
    """u = s^2."""
    t = np.linspace(-14.0, 14.0, 1401)
    s, tanh = 1.0 / np.cosh(t), np.tanh(t)
    along = np.transpose([s**2, -2.0 * s**2 * tanh, AMPLITUDE * s, -AMPLITUDE * s * tanh])
    pulse = model({"u": "v", "v": "4*u - 6*u^2"}, "(1 - 2*u)", "u")
    return contin.connection(pulse, {"u": 0}, samples=(t, along), reversor={"v": "-v", "z": "-z"}, **settings)


def fronts(**settings):
    """From u = 0, which has two unstable directions, to u = 1, which has two stable ones."""
    t = np.linspace(-14.0, 14.0, 1401)
    f = 1.0 / (1.0 + np.exp(-t))
    s = 4.0 * f * (1.0 - f)
    along = np.transpose([f, AMPLITUDE * s, AMPLITUDE * s * (1.0 - 2.0 * f)])
    front = model({"u": "u*(1 - u)"}, "(1 - 6*u + 6*u^2)", "16*u^2*(1 - u)^2")
    return contin.connection(front, {"u": 0}, {"u": 1}, samples=(t, along), **settings)


def fold(start):
    """The one at which the amplitude is smaller, beside which the connection is found."""
    branch = contin.continuation(start, "l", (0.954, 0.955), settings={"stop_at": ["LP"]})
    (point,) = branch.points
    big = 1.0 - np.sqrt(1.0 - M / 3.0)
    assert point.values["l"] == pytest.approx(3 * big**2 - 2 * big**3, abs=1e-9)
    return point


@pytest.fixture(scope="module")
def fold_of_pulses():
    return fold(pulses())


def has_closed_form(curve):
    big = curve.columns["w.max"] ** 2
    np.testing.assert_allclose(curve.columns["m"], 6 * big - 3 * big**2, atol=1e-9)
    np.testing.assert_allclose(curve.columns["l"], 3 * big**2 - 2 * big**3, atol=1e-9)


@pytest.mark.seldom
def test_curve_of_folds_of_symmetric_pulses_has_its_closed_form(fold_of_pulses):
    ranges, few = {"l": (0.0, 2.0), "m": (1.0, 4.0)}, {"steps": 4}
    has_closed_form(contin.continuation(fold_of_pulses.locus(), ("l", "m"), ranges, settings=few))


def test_curve_of_folds_of_fronts_has_its_closed_form():
    ranges, few = {"l": (0.0, 2.0), "m": (1.0, 4.0)}, {"steps": 4}
    has_closed_form(contin.continuation(fold(fronts()).locus(), ("m", "l"), ranges, settings=few))


@pytest.mark.seldom
def test_cusp_of_folds_of_symmetric_pulses_is_that_of_their_amplitude(fold_of_pulses):
    ranges = {"l": (0.9, 1.1), "m": (2.94, 3.1)}
    curve = contin.continuation(fold_of_pulses.locus(), ("l", "m"), ranges, settings={"stop_at": ["CP"]})
    cusp = curve["CP1"]
    assert cusp.values["l"] == pytest.approx(1.0, abs=cusp.error)
    assert (cusp.values["m"], cusp.values["w.max"]) == pytest.approx((3.0, 1.0), abs=1e-9)
