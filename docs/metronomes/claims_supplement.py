"""Claims of the supplement: integrals, the escapement x/(1 + x^2), antiderivatives."""

import numpy as np
from claiming import averaged, claim, labels, rates, slopes, watched
from numpy import arctan, log, pi, sin, sqrt

import contin


def integral(formula: str, low: float, high: float, **parameters) -> float:
    """By contin's integrator: s' = formula in t, from `low` to `high`."""
    shifted = f"({high - low!r})*({formula.replace('t', f'({low!r} + {high - low!r}*t)')})"
    model = contin.Model("integral", states={"s": 0}, parameters=parameters, equations={"s": shifted})
    return float(contin.simulate(model, {"s": 0}, time=1, samples=2, rtol=1e-12).states[-1, 0])


@claim
def largest_rate_i():
    """Largest r' for x1 < r < x2 at alpha = 0.08, x2 = 8 and the place of it."""
    model, r = averaged("one-constant"), np.linspace(1, 8, 70_001)
    values = [rates(model, [q], alpha=0.08, x2=8.0)[0] for q in r[::50]]
    best = int(np.argmax(values))
    return [values[best], round(r[::50][best], 1)], [(1 - sqrt(2 * pi * 0.08)) / pi, round(sqrt(2 / (pi * 0.08)), 1)]


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
    return form["kind"], "transcritical", "pitchfork"


@claim
def linear_rational_rest_in_the_caption():
    """Is rest unstable at alpha = 0.2 and at alpha = 1? The caption: if alpha < pi."""
    model = averaged("one-linear-rational")
    return [bool(slopes(model, [0.0], alpha=alpha)[0, 0] > 0) for alpha in (0.2, 1.0)], [True, True], [True, False]


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

    ours = integral("(1 + t^2)/((1 + t^2)^2 + r^4)", -2.0, -0.5, r=r)
    return ours, printed(-0.5) - printed(-2.0)


@claim
def antiderivatives_iii():
    def fourth(t):
        return sin(4 * t) / 32 + sin(2 * t) / 4 + 3 * t / 8

    def sixth(t):
        return sin(6 * t) / 192 + 3 * sin(4 * t) / 64 + 15 * sin(2 * t) / 64 + 5 * t / 16

    ours = [integral(f"cos(t)^{n}", 0.3, 1.4) for n in (4, 6)]
    return ours, [fourth(1.4) - fourth(0.3), sixth(1.4) - sixth(0.3)]


