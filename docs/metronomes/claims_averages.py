"""Claims about averages: the general formulas, integrals over a turn, and the supplement's steps towards them."""

from functools import cache
from itertools import pairwise

import numpy as np
from claiming import EPS, A, B, averaged, claim, loaded, motion, pushed, rates, slopes, watched
from numpy import cos, log, pi, sin, sqrt
from scipy.integrate import quad

import contin

NAMES = ("one-constant", "one-rational", "one", "one-linear-rational")
CORNERS = (1.0, 1.5)  # x1 and x2 of model (i)


def mean_push(name, r, weight) -> float:
    """The mean over a turn of g weight(phi), by quadrature between the places where g jumps."""
    inner = [np.arccos(c / r) for c in CORNERS if c < r] if name == "one-constant" else []
    jumps = {pi * k + s * q for q in inner for k in (0, 1, 2) for s in (1, -1)} | {k * pi / 2 for k in range(5)}

    def value(t: float) -> float:
        return pushed(name, r * cos(t), -r * sin(t)) * weight(t)

    return sum(
        quad(value, low + 1e-12, high - 1e-12, limit=20, epsabs=1e-10)[0]
        for low, high in pairwise(sorted(c for c in jumps if 0.0 <= c <= 2 * pi))
    ) / (2 * pi)  # fmt: skip


@claim
def average_in_general_amplitude():
    """r' of all four models at r = 1.3 by averaging, and from the printed integral by quadrature of the force."""
    ours = [rates(averaged(name), [1.3], alpha=0.1)[0] for name in NAMES]
    return ours, [-(0.1 * 1.3 / 2 + mean_push(name, 1.3, sin)) for name in NAMES]


@claim
def average_in_general_phase():
    """The same for theta'."""
    ours = [watched(averaged(name), "frequency_shift", [1.3], alpha=0.1) for name in NAMES]
    return ours, [-mean_push(name, 1.3, cos) / 1.3 for name in NAMES]


@claim
def amplitudes_are_slow():
    """|r(t) - averaged r| at t = 1/eps from r = 2.5, in units of eps, for eps = 0.02, 0.01, 0.005: bounded by 5?"""
    found = []
    slow = contin.simulate(averaged("one"), {"r": 2.5}, {"alpha": 0.5}, time=1.0, samples=3).states[-1, 0]
    for eps in (0.02, 0.01, 0.005):
        end = contin.simulate(loaded("one"), {"x": 2.5, "y": 0}, {"alpha": 0.5, "eps": eps}, time=1 / eps, samples=3)
        found.append(bool(abs(np.hypot(*end.states[-1]) - slow) < 5 * eps))
    return found, [True] * 3


@cache
def coupled(other: str):
    """x1'' = -x1 + eps times x2 or y2, averaged: means of products of two oscillators' sines and cosines."""
    oscillators = [{"position": f"x{i}", "velocity": f"y{i}"} for i in (1, 2)]
    model = contin.Model(
        "coupled", states={"x1": 1, "y1": 0, "x2": 1, "y2": 0}, parameters={"eps": 0.01},
        equations={"x1": "y1", "y1": f"-x1 + eps*{other}", "x2": "y2", "y2": "-x2"},
        averaging={"small": "eps", "oscillators": oscillators},
    )  # fmt: skip
    return contin.average(model, form="polar")


@claim
def integrals_of_products():
    """Integrals of sin sin, sin cos, cos cos at theta1 - theta2 = 1.5, r = 1: by averages of coupled oscillators.

    r1' = -<sin(phi1) F>, and psi' = -theta1' = <cos(phi1) F>, with F = r2 cos(phi2), or -r2 sin(phi2).
    """
    by_place, by_speed = rates(coupled("x2"), (1, 1, -1.5)), rates(coupled("y2"), (1, 1, -1.5))
    ours = [-2 * pi * by_place[0], 2 * pi * by_speed[0], 2 * pi * by_place[2]]
    return ours, [pi * sin(1.5), pi * cos(1.5), pi * cos(1.5)]


@claim
def integrals_of_squares():
    """Integrals of sin^2 and sin cos over a turn, from the average of a damped spring with another stiffness."""
    model = contin.Model(
        "damped", states={"x": 1, "y": 0}, parameters={"eps": 0.01, "c": 1.0, "d": 0.0},
        equations={"x": "y", "y": "-x + eps*(-c*y + d*x)"},
        averaging={"small": "eps", "oscillators": [{"position": "x", "velocity": "y"}]},
    )  # fmt: skip
    slow = contin.average(model, form="polar")
    damped, shifted = rates(slow, [1.0], c=1.0, d=0.0)[0], rates(slow, [1.0], c=0.0, d=1.0)[0]
    turned = watched(slow, "frequency_shift", [1.0], c=0.0, d=1.0)
    return [-2 * pi * damped, 2 * pi * shifted, -2 * pi * turned], [pi, 0.0, pi]


@claim
def means_i_within_x1():
    """g1 and g2 at r = 0.6 and 0.9, from averages without damping."""
    model = averaged("one-constant")
    ours = [(rates(model, [r], alpha=0.0)[0], watched(model, "frequency_shift", [r], alpha=0.0)) for r in (0.6, 0.9)]
    return ours, [(0, 0), (0, 0)]


def _means(name, r, **parameters):
    """g1 and g2 by averaging: -r' and -r theta' without damping."""
    model = averaged(name)
    shift = watched(model, "frequency_shift", [r], alpha=0.0, **parameters)
    return [-rates(model, [r], alpha=0.0, **parameters)[0], -r * shift]


@claim
def means_i_beyond_x2():
    r = 2.0
    printed = [(1 - 1.5) / (pi * r), (sqrt(1 - 1 / r**2) - sqrt(1 - 1.5**2 / r**2)) / pi]
    return _means("one-constant", r), printed


@claim
def means_i_between():
    """At r = 1.2; printed for 'r > x2', with factors 2."""
    r = 1.2
    printed = np.array([2 * (1 / r - 1), 2 * sqrt(1 - 1 / r**2)])
    return _means("one-constant", r), printed, printed / (2 * pi)


@claim
def means_linear_rational():
    r = 1.7
    return _means("one-linear-rational", r), [-log(1 + r**2) / (2 * pi * r), (1 - 1 / sqrt(1 + r**2)) / (2 * r)]


@claim
def means_ii():
    r = 1.7
    printed = [-log(1 + r**4) / (4 * pi * r), (1 - sqrt((1 + sqrt(1 + r**4)) / (2 * (1 + r**4)))) / (2 * r)]
    return _means("one-rational", r), printed


@claim
def means_iii():
    r = 1.7
    return _means("one", r), [-(3 * A * r**3 - 2 * B * r**5) / (12 * pi), (6 * A * r**3 - 5 * B * r**5) / 32]


@claim
def rate_i_by_pieces():
    """d r'/dr of model (i) at r = 0.6, 1.2, 2.5, alpha = 0.1."""
    printed = [-0.05, -(0.05 - 1 / (pi * 1.2**2)), -0.05 - 0.5 / (pi * 2.5**2)]
    return [slopes(averaged("one-constant"), [r], alpha=0.1)[0, 0] for r in (0.6, 1.2, 2.5)], printed


@claim
def rate_i_is_not_smooth():
    """Jump of d r'/dr at r = x1: printed as a fact only; 1/(pi x1)."""
    below, above = (slopes(averaged("one-constant"), [r], alpha=0.1)[0, 0] for r in (1 - 1e-10, 1 + 1e-10))
    return above - below, 1 / pi


@claim
def rate_i_is_largest():
    """d r'/dr at r = sqrt(2 x1/(pi alpha)), alpha = 0.08, x2 = 8."""
    return slopes(averaged("one-constant"), [sqrt(2 / (pi * 0.08))], alpha=0.08, x2=8.0)[0, 0], 0.0


@claim
def rate_i_at_x2():
    """r' at r = x2 for alpha = 0.1."""
    return rates(averaged("one-constant"), [1.5], alpha=0.1)[0], -1.5 / 2 * (0.1 - 2 * 0.5 / (pi * 1.5**2))


@claim
def pendulum_exact_polar_equations():
    """r' and theta' by the chain rule with sigma = 0.8, where the escapement does not act, and the printed ones."""
    r, phi, alpha, sigma = 1.3, 1.0, 0.5, 0.8
    x, y = r * cos(phi), -r * sin(phi)
    dx, dy = motion("one", (x, y), alpha=alpha, sigma=sigma)
    ours = (x * dx + y * dy) / (r * EPS), (-(x * dy - y * dx) / r**2 - 1) / EPS
    force = alpha * r * sin(phi) + sigma * r**3 * cos(phi) ** 3
    return ours, (-sin(phi) * force, -cos(phi) * force / r)
