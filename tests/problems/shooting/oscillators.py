"""Piecewise-linear oscillators whose orbits are known in closed form, and a smooth normal form; families of them."""

from functools import cache
from math import cos, exp, pi, sin, sqrt

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq

from contin import api
from contin.model.model import Model

# b1 = -b2^2/4: folds
BAUTIN = Model(
    "bautin", states={"x": 0.9, "y": 0.0}, parameters={"b1": -0.1, "b2": 1.0, "w": 1.3}, definitions={"r": "x^2 + y^2"},
    equations={"x": "b1*x - w*y + b2*x*r - x*r^2", "y": "w*x + b1*y + b2*y*r - y*r^2"},
)  # fmt: skip
TWO_RELAYS = Model(
    "two", states={"x1": 1, "y1": 0.1, "x2": 1, "y2": 0.1}, parameters={"d": 0.2, "k": 0.5, "c": 0.9, "e": 0},
    equations={
        "x1": "y1", "y1": "-2*d*y1 - x1 + k*sign(y1) + c*(x2 - x1) + e*(y2 - y1)",
        "x2": "y2", "y2": "-2*d*y2 - x2 + k*sign(y2) + c*(x1 - x2) + e*(y1 - y2)",
    },
)  # fmt: skip
FORCED_BILINEAR = Model(
    "forced", states={"x": 0, "y": 0}, parameters={"w": 2.1, "d": 0.05, "k": 4, "F": 1},
    equations={"x": "y", "y": "-2*d*y - x*(1 + k if x > 0 else 1) + F*cos(w*t)"}, forcing={"period": "2*pi/w"},
)  # fmt: skip


@cache
def bautin_family():
    """Orbits by shooting, with the fold at b1 = -1/4."""
    return api.continuation(api.periodic_orbit(BAUTIN, method="shooting"), "b1", (-0.5, 0.1), values={"b1": [-0.05]})


@cache
def relays_in_phase(parameter, low, high, c=0.9):
    """The synchronous orbits of the two relays."""
    return api.continuation(api.periodic_orbit(TWO_RELAYS, None, {"c": c}), parameter, (low, high))


@cache
def forced_family():
    """Orbits of the forcing's period; they double it once."""
    return api.continuation(api.periodic_orbit(FORCED_BILINEAR), "w", (2.1, 2.5))


def half_turn(c, d, e=0.0):
    """Trace and determinant of half a turn of the difference of two relays in phase.

    q'' + 2 (d + e) q' + (1 + 2 c) q = 0 for the time pi/w of the sum's half turn, then q' grows by 1/rho.
    """
    w, damping = sqrt(1.0 - d * d), d + e
    fast, rho = sqrt(1.0 + 2.0 * c - damping**2), exp(-pi * d / w)
    theta, decay = pi * fast / w, exp(-damping * pi / w)
    part = damping / fast * sin(theta)
    return decay * (cos(theta) + part + (cos(theta) - part) / rho), decay**2 / rho


def forced_map(u, w, d=0.05, k=4.0, force=1.0):
    """Stroboscopic map of x'' + 2 d x' + (1 + k if x > 0 else 1) x = force cos(w t), and its derivative, by pieces."""

    @cache
    def turn_of(s, dt):
        return expm(np.array([[0.0, 1.0], [-s, -2.0 * d]]) * dt)

    def piece(u, t, s, dt):
        den = (s - w * w) ** 2 + (2.0 * d * w) ** 2
        a, b = force * (s - w * w) / den, 2.0 * d * w * force / den
        steady = [
            np.array([a * cos(w * q) + b * sin(w * q), w * (b * cos(w * q) - a * sin(w * q))]) for q in (t, t + dt)
        ]
        turn = turn_of(s, dt)
        return turn @ (u - steady[0]) + steady[1], turn

    t, matrix, u = 0.0, np.eye(2), np.array(u)
    while t < 2.0 * pi / w - 1e-12:
        up = u[0] > 1e-12 or (abs(u[0]) <= 1e-12 and u[1] > 0.0)
        s, step = (1.0 + k if up else 1.0), min(0.1, 2.0 * pi / w - t)
        end, turn = piece(u, t, s, step)
        if (end[0] < 0.0) == up and abs(end[0]) > 1e-13:
            step = brentq(lambda q, u=u, t=t, s=s: piece(u, t, s, q)[0][0], 1e-9, step, xtol=1e-15)
            end, turn = piece(u, t, s, step)
            end[0] = 0.0
        t, u, matrix = t + step, end, turn @ matrix
    return u, matrix


def forced_orbit(u, w, k=4.0):
    """The forced orbit next to u, and the product of all (multiplier + 1), by Newton's method on the exact map."""
    for _ in range(3):
        end, matrix = forced_map(u, w, k=k)
        u = u + np.linalg.solve(matrix - np.eye(2), u - end)
    matrix = forced_map(u, w, k=k)[1]
    return u, 1.0 + np.trace(matrix) + np.linalg.det(matrix)
