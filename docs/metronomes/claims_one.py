"""Claims about one metronome: equation of motion, averages, folds. a = 4, b = 1, x1 = 1, x2 = 1.5, eps = 0.01."""

import numpy as np
from claiming import A, B, averaged, claim, labels, loaded, r_star, rates, slopes, watched
from numpy import log, pi, sqrt
from scipy.optimize import brentq

import contin

R = np.array([0.6, 1.2, 1.4, 1.9, 2.6])  # amplitudes, in all three intervals of model (i)


def _amplitude(name, printed, **parameters):
    return [rates(averaged(name), [r], **parameters)[0] for r in R], [printed(r) for r in R]


def _phase(name, printed, **parameters):
    return [r * watched(averaged(name), "frequency_shift", [r], **parameters) for r in R], [printed(r) for r in R]


@claim
def average_i_amplitude():
    def printed(r, alpha=0.1, x1=1.0, x2=1.5):
        return -alpha * r / 2 + (0 if r < x1 else 1 - x1 / r if r < x2 else (x2 - x1) / r) / pi

    return _amplitude("one-constant", printed, alpha=0.1)


@claim
def average_i_phase():
    def printed(r, x1=1.0, x2=1.5):
        first = sqrt(max(1 - x1**2 / r**2, 0))
        return -(first - (sqrt(1 - x2**2 / r**2) if r >= x2 else 0)) / pi

    return _phase("one-constant", printed)


@claim
def average_ii_amplitude():
    return _amplitude("one-rational", lambda r: -0.1 * r / 2 + log(1 + r**4) / (4 * pi * r), alpha=0.1)


@claim
def average_ii_phase():
    def printed(r):
        return -(1 - sqrt((1 + sqrt(1 + r**4)) / (2 * (1 + r**4)))) / (2 * r)

    return _phase("one-rational", printed)


@claim
def average_iii_amplitude():
    return _amplitude("one", lambda r: (-6 * pi * 0.5 * r + 3 * A * r**3 - 2 * B * r**5) / (12 * pi), alpha=0.5)


@claim
def average_iii_phase():
    return _phase("one", lambda r: -(3 * A / 16 * r**3 - 5 * B / 32 * r**5))


@claim
def rest_is_always_stable():
    """The slope of r' at rest in models (i), (ii), (iii), over alpha / 2."""
    names = ("one-constant", "one-rational", "one")
    return [slopes(averaged(name), [0.0], alpha=0.1)[0, 0] / 0.05 for name in names], [-1, -1, -1]


@claim
def fold_i_narrow():
    return labels("one-constant", "LP", "oscillating", "alpha", 0.01, 0.2)[0].values["alpha"], 1 / (pi * 1.5**2)


@claim
def fold_i_wide():
    """x2 = 3 > 2 x1: the fold lies where the push has not ended, at r = 2 x1."""
    found = labels("one-constant", "LP", "oscillating", "alpha", 0.01, 0.3, x2=3.0, alpha=0.1)
    return found[-1].values["alpha"], 1 / (2 * pi)


@claim
def fold_i_is_a_corner():
    """Slopes of r' below and above r = x2 at the fold; at a saddle-node both are 0."""
    alpha = 1 / (pi * 1.5**2)
    model = averaged("one-constant")
    right = [-(alpha / 2 - 1 / (pi * 1.5**2)), -alpha / 2 - 0.5 / (pi * 1.5**2)]
    return [slopes(model, [r], alpha=alpha)[0, 0] for r in (1.5 - 1e-9, 1.5 + 1e-9)], [0, 0], right


@claim
def amplitudes_i():
    """Stable and unstable amplitude at alpha = 0.1 (x2 = 1.5), and stable at alpha = 0.15 with x2 = 3."""
    model, wide = averaged("one-constant"), {"alpha": 0.15, "x2": 3.0}
    ours = [
        brentq(lambda r: rates(model, [r], alpha=0.1)[0], 1.5, 4),
        brentq(lambda r: rates(model, [r], alpha=0.1)[0], 1.0, 1.5),
        brentq(lambda r: rates(model, [r], **wide)[0], 2.1, 3.0),
    ]
    return ours, [
        sqrt(2 * 0.5 / (0.1 * pi)),
        (1 - sqrt(1 - 0.2 * pi)) / (0.1 * pi),
        (1 + sqrt(1 - 0.3 * pi)) / (0.15 * pi),
    ]


@claim
def fold_ii():
    squared = brentq(lambda q: 2 * q * q / (1 + q * q) - log(1 + q * q), 1, 5)
    found = labels("one-rational", "LP", "oscillating", "alpha", 0.01, 0.2)[0].values["alpha"]
    return found, squared / (pi * (1 + squared**2))


@claim
def fold_iii():
    return labels("one", "LP", "oscillating", "alpha", 0.05, 1.2)[0].values["alpha"], 3 * A**2 / (16 * pi * B)


@claim
def amplitudes_iii():
    model = averaged("one")
    ours = [contin.equilibrium(model, start=start, parameters={"alpha": 0.7}) for start in ("oscillating", "threshold")]
    return [float(state.u[0]) for state in ours], [r_star(0.7), r_star(0.7, -1)]


@claim
def pendulum_term_of_one():
    """Change of r' and of theta' at r = 1.7 that sigma = 0.8 makes."""
    model, r, sigma = averaged("one"), 1.7, 0.8
    amplitude = rates(model, [r], sigma=sigma)[0] - rates(model, [r])[0]
    phase = watched(model, "frequency_shift", [r], sigma=sigma) - watched(model, "frequency_shift", [r])
    return [amplitude, phase], [0, -3 / 8 * sigma * r**2]


@claim
def sweep_iii_agrees():
    """Mean amplitude of the equation of motion at alpha = 0.3, 0.6, 0.9 against the averaged one."""
    from contin.simulate.sweep import sweep

    found = sweep(
        loaded("one"), "alpha", (0.3, 0.9), start={"x": 2, "y": 0}, steps=2, down=False,
        measures={"r": "sqrt(x^2 + y^2)"},
    )  # fmt: skip
    return found.columns["r.mean"], [r_star(alpha) for alpha in (0.3, 0.6, 0.9)], [2.342050, 2.194890, 1.932351]


@claim
def bistable_below_the_fold_only():
    """Model (iii) at alpha = 0.9 and 1.0 (eps = 0.01): largest amplitude that the equation of motion keeps."""
    from contin.simulate.sweep import sweep

    found = sweep(
        loaded("one"), "alpha", (0.9, 1.0), start={"x": 2, "y": 0}, steps=1, down=False,
        measures={"r": "sqrt(x^2 + y^2)"},
    )  # fmt: skip
    return [bool(r > 0.1) for r in found.columns["r.max"]], [True, False]
