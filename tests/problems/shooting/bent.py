"""A Bautin form whose radial law changes beyond a line: r' = r (b1 + b2 r^2 - r^4 - s max(x - c, 0)), theta' = 1.

Inside r < c it is the smooth form: folds of orbits on b1 = -b2^2/4, r^2 = b2/2. Outside, the return map of the radius
is found here by quadrature over the angle, without contin.
"""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve, minimize_scalar

from contin.model.model import Model

C = 0.5
TOUCHED = 2.0 * C * C  # b2 of the fold orbit with r = c


def bent(strength):
    """The model with this s."""
    return Model(
        "bent", states={"x": 0.0, "y": 0.0}, parameters={"b1": -0.5, "b2": 0.5, "c": C, "s": strength},
        definitions={"r": "x^2 + y^2", "g": "b1 + b2*r - r^2 - (s*(x - c) if x > c else 0)"},
        equations={"x": "x*g - y", "y": "y*g + x"},
    )  # fmt: skip


BENT = bent(1.0)
JUMPING = Model(
    "jumping", states={"x": 0.0, "y": 0.0}, parameters={"b1": -0.5, "b2": 0.5},
    definitions={"r": "x^2 + y^2", "g": "b1 + b2*r - r^2*(3 if x > 0.5 else 1)"},
    equations={"x": "x*g - y", "y": "y*g + x"},
)  # fmt: skip


def rate(theta, v, b1, b2, s, beyond):
    """dr/dtheta and that of dr/dr0, with the law of one side."""
    r, d = v
    cos, s = np.cos(theta), np.where(beyond, s, 0.0)
    g = b1 + b2 * r**2 - r**4 - s * (r * cos - C)
    return np.array([r * g, d * (g + r * (2.0 * b2 * r - 4.0 * r**3 - s * cos))])


def returned(radius, b1, b2, s=1.0):
    """Radius after a turn from theta = pi/2 and its derivative by the initial one.

    The line, crossed at most once on either side of theta = 2 pi, is landed on.
    """

    def line(theta, v, *_):
        return v[0] * np.cos(theta) - C

    line.terminal = True
    theta, v, beyond = 0.5 * np.pi, np.array([radius, 1.0]), False
    for stop in (2.0 * np.pi, 2.5 * np.pi):
        while theta < stop:
            line.direction = -1 if beyond else 1
            options = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-14}
            path = solve_ivp(rate, (theta, stop), v, events=line, args=(b1, b2, s, beyond), **options)
            theta, v = path.t[-1], path.y[:, -1]
            beyond = beyond != (path.status == 1)
    return v


def fold_at(radius, guess, s):
    """(b1, b2) of the fold of orbits with this radius at theta = pi/2."""

    def misses(b):
        return returned(radius, *b, s) - (radius, 1.0)

    return fsolve(misses, guess, xtol=1e-10)


def gain(b1, b2, radius):
    """The largest gain of radius in a turn, near a radius: zero at a fold of orbits."""
    found = minimize_scalar(
        lambda r: r - returned(r, b1, b2)[0], bounds=(0.95 * radius, 1.05 * radius), options={"xatol": 1e-7}
    )
    return -float(found.fun)


def orbits(b1, b2, steps=400):
    """Numbers of all and of stable orbits, from the sign changes of the return map less the identity."""
    start, h = np.linspace(0.02, 1.3, 400), 2.0 * np.pi / steps

    def slope(theta, v):
        return rate(theta, v, b1, b2, 1.0, v[0] * np.cos(theta) > C)

    v = np.array([start, np.ones_like(start)])
    for theta in 0.5 * np.pi + h * np.arange(steps):  # the midpoint rule is enough to count
        v = v + h * slope(theta + 0.5 * h, v + 0.5 * h * slope(theta, v))
    changes = np.diff(np.sign(v[0] - start))
    return int(np.count_nonzero(changes)), int(np.count_nonzero(changes < 0))
