"""Symmetric pulses to a saddle-focus that turn many times: found from nothing, and from samples in leading order."""

import numpy as np
import pytest

import contin

EVEN = {"v": "-v", "y": "-y"}
B = 1.8


def pattern(r):
    """Steady states of u_t = r u - (1 + d^2/dx^2)^2 u + B u^2 - u^3 (Burke and Knobloch 2006)."""
    return contin.Model(
        "swift-hohenberg", states={"u": 0, "v": 0, "w": 0, "y": 0}, parameters={"r": r},
        equations={"u": "v", "v": "w", "w": "y", "y": f"-2*w - (1 - r)*u + {B}*u^2 - u^3"},
    )  # fmt: skip


def envelope(r, x, sign):
    """In leading order of sqrt(-r)."""
    size = 2.0 * np.sqrt(-2.0 * r / (38.0 * B**2 / 9.0 - 3.0))
    return sign * size / np.cosh(0.5 * np.sqrt(-r) * x) * np.cos(x)


def by_cosines(r, sign, length=60.0, count=192):
    """Largest and smallest value of the pulse, by collocation with cosines on half of it."""
    x = length * np.arange(count) / (count - 1)
    k = np.pi * np.arange(count) / length
    values = np.cos(np.outer(x, k))
    linear = values * (r - (1.0 - k**2) ** 2)
    a = np.linalg.solve(values, envelope(r, x, sign))
    for _ in range(40):
        u = values @ a
        step = np.linalg.solve(linear + (2 * B * u - 3 * u**2)[:, None] * values, -(linear @ a + B * u**2 - u**3))
        most = np.abs(values @ step).max()
        a = a + min(1.0, 0.2 / most) * step
        if most < 1e-12:
            break
    fine = np.cos(np.outer(np.linspace(0.0, 10.0, 20001), k)) @ a
    return fine.max(), fine.min()


@pytest.mark.seldom
def test_a_pulse_that_turns_many_times_is_found_from_nothing():
    start = contin.connection(pattern(-0.1), {"u": 0}, reversor=EVEN)
    branch = contin.continuation(start, "r", (-0.11, -0.09), values={"r": [-0.1]}, settings={"steps": 3})
    point, exact = branch["UZ1"], by_cosines(-0.1, 1.0)
    assert (point.values["u.max"], point.values["u.min"]) == pytest.approx(exact, abs=1e-7)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_samples_in_leading_order_lead_to_the_pulse_next_to_them(sign):
    r, x = -0.2, np.linspace(-57.0, 57.0, 2001)
    u = envelope(r, x, sign)
    slopes = [u]
    for _ in range(3):
        slopes.append(np.gradient(slopes[-1], x))
    start = contin.connection(pattern(r), {"u": 0}, samples=(x, np.transpose(slopes)), reversor=EVEN)
    branch = contin.continuation(start, "r", (-0.21, -0.19), values={"r": [r]}, settings={"steps": 3})
    point, exact = branch["UZ1"], by_cosines(r, sign)
    assert (point.values["u.max"], point.values["u.min"]) == pytest.approx(exact, abs=1e-7)
