"""A Bautin form whose radial law changes beyond a line: r' = r (b1 + b2 r^2 - r^4 - s max(x - c, 0)), theta' = 1.

Inside r < c it is the smooth form: folds of orbits on b1 = -b2^2/4, r^2 = b2/2. Outside, the return map of the radius
is found here by quadrature over the angle, without contin.
"""

import numpy as np
from scipy.optimize import fsolve

from contin.model.model import Model

C = 0.5
TOUCHED = 2.0 * C * C  # b2 of the fold orbit with r = c
BENT = Model(
    "bent", states={"x": 0.0, "y": 0.0}, parameters={"b1": -0.5, "b2": 0.5, "c": C},
    definitions={"r": "x^2 + y^2", "g": "b1 + b2*r - r^2 - (x - c if x > c else 0)"},
    equations={"x": "x*g - y", "y": "y*g + x"},
)  # fmt: skip

JUMPING = Model(
    "jumping", states={"x": 0.0, "y": 0.0}, parameters={"b1": -0.5, "b2": 0.5},
    definitions={"r": "x^2 + y^2", "g": "b1 + b2*r - r^2*(3 if x > 0.5 else 1)"},
    equations={"x": "x*g - y", "y": "y*g + x"},
)  # fmt: skip


def returned(radii, b1, b2, steps=4000):
    """Radii after a turn from theta = pi/2, and their derivatives by the initial ones.

    By the classical Runge-Kutta method; where the law bends the error is of the third order.
    """

    def rate(theta, v):
        r, d = v
        cos = np.cos(theta)
        beyond = r * cos > C
        g = b1 + b2 * r**2 - r**4 - np.where(beyond, r * cos - C, 0.0)
        slope = 2.0 * b2 * r - 4.0 * r**3 - np.where(beyond, cos, 0.0)
        return np.array([r * g, d * (g + r * slope)])

    v, h = np.array([np.atleast_1d(radii), np.ones(np.size(radii))]), 2.0 * np.pi / steps
    for theta in 0.5 * np.pi + h * np.arange(steps):
        k1 = rate(theta, v)
        k2 = rate(theta + 0.5 * h, v + 0.5 * h * k1)
        k3 = rate(theta + 0.5 * h, v + 0.5 * h * k2)
        v = v + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + rate(theta + h, v + h * k3))
    return v


def fold(b2, radius, b1):
    """b1 of the fold next to a guess of its radius at theta = pi/2 and of b1."""

    def misses(v):
        end, slope = returned(v[0], v[1], b2)
        return [end[0] - v[0], slope[0] - 1.0]

    return float(fsolve(misses, [radius, b1], xtol=1e-10)[1])


def orbits(b1, b2):
    """Numbers of all and of stable orbits, from the sign changes of the return map less the identity."""
    r = np.linspace(0.02, 1.3, 400)
    gains = np.sign(returned(r, b1, b2, 400)[0] - r)
    changes = np.diff(gains)
    return int(np.count_nonzero(changes)), int(np.count_nonzero(changes < 0))
