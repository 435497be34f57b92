"""Claims about equations before they are averaged: Newton's equations of bodies and platform, and the escapements."""

from functools import cache

import numpy as np
from claiming import EPS, A, B, claim, motion, pushed, rates
from numpy import cos, pi, sin, sqrt

import contin

BODIES = {"m": 0.3, "M": 1.7, "k": 2.1, "gamma": 0.02, "delta": 0.4, "eps": 0.05}
UNLIKE = {
    "m1": 0.3, "m2": 0.4, "M": 5.0, "k1": 2.1, "k2": 1.6, "c1": 0.02, "c2": 0.03, "d1": 0.4, "d2": 0.5, "eps": 0.05,
}  # fmt: skip
PUSH = "eps*(4*({0})^3 - ({0})^5) if {1}*{2} > 0 else 0"


@cache
def bodies():
    """A mass on springs and its platform, as Newton has them: no force from outside acts on the two."""
    force = f"-k*x - gamma*v + delta*({PUSH.format('k*x/delta', 'x', 'v')})"
    return contin.Model(
        "bodies", states={"X": 0, "x": 0, "V": 0, "v": 0}, parameters=BODIES,
        equations={"X": "V", "x": "v", "V": f"-({force})/M", "v": f"({force})*(1/m + 1/M)"},
    )  # fmt: skip


@cache
def three_bodies():
    """Two masses and a platform: the force of each mass's springs acts on the platform with the opposite sign."""
    one, two = (
        f"(-k{i}*x{i} - c{i}*v{i} + d{i}*({PUSH.format(f'k{i}*x{i}/d{i}', f'x{i}', f'v{i}')}))" for i in (1, 2)
    )
    platform = f"(-({one} + {two})/M)"
    rates_of = {"V": platform, "v1": f"{one}/m1 - {platform}", "v2": f"{two}/m2 - {platform}"}
    equations = {"X": "V", "x1": "v1", "x2": "v2", **rates_of}
    return contin.Model("three", states=dict.fromkeys(equations, 0), parameters=UNLIKE, equations=equations)


def _scaled_one():
    """alpha and the scales of length and time."""
    m, mass, k, gamma, delta, eps = BODIES.values()
    omega = sqrt((1 + m / mass) * k / m)
    return omega * gamma / (eps * k), delta / k, omega


@claim
def equation_of_one():
    """The mass's acceleration from Newton's equations, and from the scaled equation of `metronomes/one`."""
    alpha, length, omega = _scaled_one()
    newton = rates(bodies(), (0.3, 0.8 * length, -0.1, 0.5 * length * omega))[3]
    return newton / (length * omega**2), motion("one", (0.8, 0.5), alpha=alpha, eps=0.05)[1]


@claim
def reduced_mass():
    """M m/(M + m) x'' + k x + gamma x' - delta f: Newton's equations of two bodies, and the equation of one."""
    m, mass, k, gamma, delta, eps = BODIES.values()
    x, v = 0.15, 0.4
    push = eps * (A * (k * x / delta) ** 3 - B * (k * x / delta) ** 5)
    return rates(bodies(), (0.0, x, 0.0, v))[3] * m * mass / (mass + m), -k * x - gamma * v + delta * push


@claim
def platform_follows():
    """X'' over x''."""
    found = rates(bodies(), (0.3, 0.15, -0.1, 0.4))
    return found[2] / found[3], -BODIES["m"] / (BODIES["M"] + BODIES["m"])


@claim
def centre_of_mass_rests():
    """M X + m (X + x) after 40 units of time from rest with x = 0.3."""
    found = contin.simulate(bodies(), {"X": 0.2, "x": 0.3, "V": 0, "v": 0}, time=40, samples=3)
    m, mass = BODIES["m"], BODIES["M"]
    return mass * found.states[-1, 0] + m * (found.states[-1, 0] + found.states[-1, 1]), (mass + m) * 0.2 + m * 0.3


@claim
def exact_polar_equations():
    """r' and theta' by the chain rule from x' and y', at a point where the escapement acts."""
    r, phi, alpha = 1.3, 2.0, 0.5
    x, y = r * cos(phi), -r * sin(phi)
    dx, dy = motion("one", (x, y), alpha=alpha)
    ours = (x * dx + y * dy) / (r * EPS), (-(x * dy - y * dx) / r**2 - 1) / EPS
    force = alpha * r * sin(phi) + A * x**3 - B * x**5
    return ours, (-sin(phi) * force, -cos(phi) * force / r)


@claim
def rate_of_the_complex_amplitude():
    """A' from the equation of motion, and the printed i eps exp(-it) (alpha y - g)."""
    t, x, y, alpha = 0.9, -1.1, -0.4, 0.5
    dx, dy = motion("one", (x, y), alpha=alpha)
    ours = ((dx - 1j * dy) - 1j * (x - 1j * y)) * np.exp(-1j * t)
    printed = 1j * np.exp(-1j * t) * EPS * (alpha * y - (A * x**3 - B * x**5))
    return [ours.real, ours.imag], [printed.real, printed.imag]


@claim
def escapement_acts_outwards():
    """Forces of models (ii), (iii) at (x, y) = (1.2, 1), (1.2, -1), (-1.2, 1), (-1.2, -1): not zero where x y > 0."""
    places = ((1.2, 1.0), (1.2, -1.0), (-1.2, 1.0), (-1.2, -1.0))
    found = [abs(pushed(name, *place)) > 1e-9 for name in ("one-rational", "one") for place in places]
    return found, [True, False, False, True] * 2


@claim
def escapement_acts_if_and_only_if_outwards():
    """Does model (i) push at x = 0.5, 1.2, 2.0, moving outwards (x1 = 1, x2 = 1.5)?"""
    found = [abs(pushed("one-constant", x, 1.0)) > 1e-9 for x in (0.5, 1.2, 2.0)]
    return found, [True, True, True], [False, True, False]


@claim
def model_i():
    """Its force at eight places, of which two are pushed."""
    places = ((1.2, 1), (1.2, -1), (-1.2, 1), (-1.2, -1), (0.9, 1), (1.6, 1), (-0.9, -1), (-1.6, -1))
    return [pushed("one-constant", *place) for place in places], [1, 0, 0, -1, 0, 0, 0, 0]


@claim
def model_i_is_piecewise_linear():
    """Its force at x = 1.1, 1.2, 1.4, moving outwards: does it change between x1 and x2?"""
    values = np.array([pushed("one-constant", x, 1.0) for x in (1.1, 1.2, 1.4)])
    return bool(np.ptp(values) > 1e-9), True, False


@claim
def model_ii():
    x = np.array([0.4, 1.3, -2.0])
    return [pushed("one-rational", q, np.sign(q)) for q in x], x**3 / (1 + x**4)


@claim
def model_iii():
    x = np.array([0.4, 1.3, -2.5])
    return [pushed("one", q, np.sign(q)) for q in x], A * x**3 - B * x**5


@claim
def model_iii_pushes_with_the_motion():
    """Force at the stable amplitudes of beta = 0.5 and 0.9, at the largest displacement: is it outwards?

    It is inwards beyond sqrt(a/b), and r* > sqrt(a/b) for beta < a^2/(6 pi b) = 0.849.
    """
    r = [sqrt((3 * A + sqrt(9 * A * A - 48 * pi * B * beta)) / (4 * B)) for beta in (0.5, 0.9)]
    found = [bool(pushed("one", q, 1e-9) > 0) for q in r]
    return found, [True, True], [False, True]


@claim
def push_iii_is_zero_at_rest():
    """g/x^3 at x = 0.05, and g at sqrt(a/b)."""
    return [pushed("one", 0.05, 0.05) / 0.05**3, pushed("one", 2.0, 1.0)], [A - B * 0.05**2, 0.0]


@claim
def push_iii_is_largest():
    """Where the force of model (iii) is largest; the printed place is its zero."""
    x = np.linspace(1.4, 1.7, 21)
    values = [pushed("one", q, 1.0) for q in x]
    fit = np.polynomial.Polynomial.fit(x, values, 8)
    place = next(q.real for q in fit.deriv().roots() if abs(q.imag) < 1e-9 and 1.4 < q.real < 1.7)
    return place, sqrt(A / B), sqrt(3 * A / (5 * B))


@claim
def push_iii_diverges_negatively():
    """Force at x = 10 and 20 over -b x^5."""
    return [pushed("one", x, 1.0) / (-B * x**5) for x in (10.0, 20.0)], [1 - A / (B * x**2) for x in (10.0, 20.0)]


@claim
def push_ii_is_unimodal():
    """Where the force of model (ii) is largest; its slopes change their sign once; its value far away times x."""
    x = np.linspace(0.05, 8, 160)
    values = np.array([pushed("one-rational", q, 1.0) for q in x])
    turns = int(np.sum(np.diff(np.sign(np.diff(values))) != 0))
    return [turns, 1000 * pushed("one-rational", 1000.0, 1.0)], [1, 1.0]


@claim
def bodies_of_two():
    """Accelerations of two masses that are not alike over those of equations (14), with the platform eliminated."""
    p = UNLIKE
    x, v = np.array([0.15, -0.09]), np.array([0.4, 0.6])
    m, k, c, d = (np.array([p[f"{name}{i}"] for i in (1, 2)]) for name in ("m", "k", "c", "d"))
    push = np.where(x * v > 0, p["eps"] * (A * (k * x / d) ** 3 - B * (k * x / d) ** 5), 0.0)
    total = p["M"] + m.sum()
    found = rates(three_bodies(), (0.1, *x, -0.2, *v))
    ours = [
        m[i] * (p["M"] + m[1 - i]) / total * found[4 + i] - m[0] * m[1] / total * found[5 - i] for i in range(2)
    ]
    return ours, -k * x - c * v + d * push


@claim
def platform_of_two():
    """X'' from Newton's equations, and from the accelerations of the masses."""
    found, p = rates(three_bodies(), (0.1, 0.15, -0.09, -0.2, 0.4, 0.6)), UNLIKE
    return found[3], -(p["m1"] * found[4] + p["m2"] * found[5]) / (p["M"] + p["m1"] + p["m2"])


@claim
def equations_not_alike():
    """Accelerations from Newton's equations of masses and platform, and from the scaled equations (16)."""
    p = UNLIKE
    m, k, c, d = (np.array([p[f"{name}{i}"] for i in (1, 2)]) for name in ("m", "k", "c", "d"))
    omega, eps = sqrt(k[0] / m[0]), p["eps"]
    beta, mu = omega * c / (eps * k), m / (eps * p["M"])
    kappa, rho = k[1] / k[0], d[1] / d[0]
    x, y = np.array([0.8, -0.3]), np.array([0.5, 0.9])
    newton = rates(three_bodies(), (0.0, *(x * d / k), 0.0, *(y * d * omega / k)))[4:]
    g = np.where(x * y > 0, A * x**3 - B * x**5, 0.0)
    whole = 1 + eps * mu.sum()
    matrix = np.array(
        [
            [1 - eps * mu[0] / whole, -eps * rho / kappa * mu[1] / whole],
            [-eps * mu[1] * kappa / rho / whole, mu[1] / mu[0] - eps * mu[1] ** 2 / (mu[0] * whole)],
        ]
    )
    right = [-x[0] + eps * (-beta[0] * y[0] + g[0]), -kappa * x[1] + eps * kappa * (-beta[1] * y[1] + g[1])]
    return newton * k / (d * omega**2), np.linalg.solve(matrix, right)
