"""Claims of the supplement: integrals, the escapement x/(1 + x^2), antiderivatives."""

import numpy as np
from claiming import A, B, averaged, claim, labels, rates, slopes, watched
from numpy import arctan, cos, log, pi, sin, sqrt
from scipy.integrate import quad

QUARTERS = ((pi / 2, pi), (3 * pi / 2, 2 * pi))


def means(g, r, ends):
    """g1 and g2 of the text: means of g sin(phi) and g cos(phi) over a turn, where the escapement acts."""
    return [sum(quad(lambda t, f=f: g(r * cos(t)) * f(t), *pair)[0] for pair in ends) / (2 * pi) for f in (sin, cos)]


def _pushed(r, x1=1.0, x2=1.5):
    """Phases between which |x| is in (x1, x2) and moves outwards."""
    first, last = np.arccos(x1 / r), np.arccos(min(x2 / r, 1.0))
    return [(pi - first, pi - last), (2 * pi - first, 2 * pi - last)]


@claim
def integrals_of_products():
    a, b = 0.4, -1.1
    pairs = ((sin, cos), (sin, sin), (cos, cos))
    ours = [quad(lambda t, f=f, g=g: f(t + a) * g(t + b), 0, 2 * pi)[0] for f, g in pairs]
    return ours, [pi * sin(a - b), pi * cos(a - b), pi * cos(a - b)]


@claim
def means_i_beyond_x2():
    r = 2.0
    return means(np.sign, r, _pushed(r)), [
        (1 - 1.5) / (pi * r),
        (sqrt(1 - 1 / r**2) - sqrt(1 - 1.5**2 / r**2)) / pi,
    ]


@claim
def means_i_between():
    """At r = 1.2; printed for 'r > x2', with factors 2."""
    r = 1.2
    return means(np.sign, r, _pushed(r)), [2 * (1 / r - 1), 2 * sqrt(1 - 1 / r**2)]


@claim
def largest_rate_i():
    """Largest r' for x1 < r < x2 at alpha = 0.08, x2 = 8 and the place of it."""
    model, r = averaged("one-constant"), np.linspace(1, 8, 70_001)
    values = [rates(model, [q], alpha=0.08, x2=8.0)[0] for q in r[::50]]
    best = int(np.argmax(values))
    return [values[best], round(r[::50][best], 1)], [(1 - sqrt(2 * pi * 0.08)) / pi, round(sqrt(2 / (pi * 0.08)), 1)]


@claim
def means_linear_rational():
    r = 1.7
    return means(lambda x: x / (1 + x * x), r, QUARTERS), [
        -log(1 + r**2) / (2 * pi * r),
        (1 - 1 / sqrt(1 + r**2)) / (2 * r),
    ]


@claim
def averages_linear_rational():
    model, radii = averaged("one-linear-rational"), (0.4, 1.0, 2.5)
    ours = [(rates(model, [r], alpha=0.15)[0], r * watched(model, "frequency_shift", [r])) for r in radii]
    printed = [(-0.15 * r / 2 + log(1 + r**2) / (2 * pi * r), -(1 - 1 / sqrt(1 + r**2)) / (2 * r)) for r in radii]
    return ours, printed


@claim
def linear_rational_bifurcates():
    return labels("one-linear-rational", "BP", "rest", "alpha", 0.05, 0.7)[0].values["alpha"], 1 / pi


@claim
def linear_rational_is_transcritical():
    """Coefficient of r^2 in the normal form in r over that of r^3: 0 at a pitchfork, not at a transcritical point."""
    form = labels("one-linear-rational", "BP", "rest", "alpha", 0.05, 0.7)[0].normal_form
    return form["kind"], "transcritical"


@claim
def linear_rational_solutions():
    """Solutions R > 0 of pi alpha R = log(1 + R) at alpha = 0.7 and 0.15 (figure S1)."""
    q = np.linspace(1e-3, 50, 200_000)
    count = [int(np.sum(np.diff(np.sign(pi * alpha * q - log(1 + q))) != 0)) for alpha in (0.7, 0.15)]
    return count, [0, 1]


@claim
def linear_rational_rest_in_the_caption():
    """Is rest unstable at alpha = 0.2 and at alpha = 1? The caption: if alpha < pi."""
    model = averaged("one-linear-rational")
    return [bool(slopes(model, [0.0], alpha=alpha)[0, 0] > 0) for alpha in (0.2, 1.0)], [True, True]


@claim
def means_ii():
    r = 1.7
    return means(lambda x: x**3 / (1 + x**4), r, QUARTERS), [
        -log(1 + r**4) / (4 * pi * r),
        (1 - sqrt((1 + sqrt(1 + r**4)) / (2 * (1 + r**4)))) / (2 * r),
    ]


@claim
def antiderivative_ii():
    """The bracket between u = -2 and u = -0.5, against quadrature of (1 + u^2)/((1 + u^2)^2 + r^4)."""
    r = 1.3
    s = sqrt(1 + r**4)
    inner, outer, half = sqrt(2 * (s - 1)), sqrt(2 / (1 + s)), sqrt((s - 1) / 2)

    def printed(u):
        logs = sqrt(s - 1) / (4 * sqrt(2) * s) * (log(u * u - inner * u + s) - log(u * u + inner * u + s))
        arcs = sqrt(2 * (s + 1)) / (4 * s) * (arctan(outer * (u + half)) + arctan(outer * (u - half)))
        return logs + arcs

    ours = quad(lambda u: (1 + u * u) / ((1 + u * u) ** 2 + r**4), -2, -0.5)[0]
    return ours, printed(-0.5) - printed(-2.0)


@claim
def means_iii():
    r = 1.7
    return means(lambda x: A * x**3 - B * x**5, r, QUARTERS), [
        -(3 * A * r**3 - 2 * B * r**5) / (12 * pi),
        (6 * A * r**3 - 5 * B * r**5) / 32,
    ]


@claim
def antiderivatives_iii():
    def fourth(t):
        return sin(4 * t) / 32 + sin(2 * t) / 4 + 3 * t / 8

    def sixth(t):
        return sin(6 * t) / 192 + 3 * sin(4 * t) / 64 + 15 * sin(2 * t) / 64 + 5 * t / 16

    ours = [quad(lambda t, n=n: cos(t) ** n, 0.3, 1.4)[0] for n in (4, 6)]
    return ours, [fourth(1.4) - fourth(0.3), sixth(1.4) - sixth(0.3)]


@claim
def rate_of_the_complex_amplitude():
    """A' by differences along x' = y, y' = -x + eps (-alpha y + g), and the printed i eps exp(-it) (alpha y - g)."""
    t, x, y, alpha, g, eps = 0.9, 1.1, -0.4, 0.5, 0.3, 0.01
    force = -x + eps * (-alpha * y + g)
    exact = (y - 1j * force) * np.exp(-1j * t) - 1j * (x - 1j * y) * np.exp(-1j * t)
    printed = 1j * np.exp(-1j * t) * eps * (alpha * y - g)
    return [exact.real, exact.imag], [printed.real, printed.imag]
