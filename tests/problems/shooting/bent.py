"""A Bautin form whose radial law changes beyond a line: r' = r (b1 + b2 r^2 - r^4 - s max(x - c, 0)), theta' = 1.

Inside r < c it is the smooth form: folds of orbits on b1 = -b2^2/4, r^2 = b2/2. Outside, the return map of the radius
is found here by quadrature over the angle, without contin.
"""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar

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


def rate(theta, r, b1, b2, beyond):
    """dr/dtheta with the law of one side."""
    return r * (b1 + b2 * r**2 - r**4 - np.where(beyond, r * np.cos(theta) - C, 0.0))


def returned(radius, b1, b2):
    """Radius after a turn from theta = pi/2; the line, crossed once on either side of theta = 2 pi, is landed on."""

    def line(theta, r, *_):
        return r[0] * np.cos(theta) - C

    line.terminal = True
    theta, r, beyond = 0.5 * np.pi, np.array([radius]), False
    for stop in (2.0 * np.pi, 2.5 * np.pi):
        while theta < stop:
            line.direction = -1 if beyond else 1
            options = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-13}
            path = solve_ivp(rate, (theta, stop), r, events=line, args=(b1, b2, beyond), **options)
            theta, r = path.t[-1], path.y[:, -1]
            beyond = beyond != (path.status == 1)
    return float(r[0])


def gain(b1, b2, radius):
    """The largest gain of radius in a turn, near a radius: zero at a fold of orbits."""
    found = minimize_scalar(
        lambda r: r - returned(r, b1, b2), bounds=(0.95 * radius, 1.05 * radius), options={"xatol": 1e-7}
    )
    return -float(found.fun)


def orbits(b1, b2, steps=400):
    """Numbers of all and of stable orbits, from the sign changes of the return map less the identity."""
    start, h = np.linspace(0.02, 1.3, 400), 2.0 * np.pi / steps

    def slope(theta, r):
        return rate(theta, r, b1, b2, r * np.cos(theta) > C)

    r = start
    for theta in 0.5 * np.pi + h * np.arange(steps):  # the midpoint rule is enough to count
        r = r + h * slope(theta + 0.5 * h, r + 0.5 * h * slope(theta, r))
    changes = np.diff(np.sign(r - start))
    return int(np.count_nonzero(changes)), int(np.count_nonzero(changes < 0))
