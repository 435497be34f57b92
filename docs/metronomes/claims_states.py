"""Claims about states of one metronome: how many, which are stable, where they come to be."""

import numpy as np
from claiming import EPS, A, B, amplitudes, averaged, claim, loaded, pushed, r_star, rates, slopes
from claims_motion import BODIES, bodies
from numpy import log, pi, sqrt

import contin


def _signs(name, **parameters):
    """Signs of the slopes of r' at the amplitudes, from below."""
    model = averaged(name)
    return [int(np.sign(slopes(model, [r], **parameters)[0, 0])) for r in amplitudes(model, **parameters)]


@claim
def stable_and_unstable_i():
    return _signs("one-constant", alpha=0.1), [1, -1]


@claim
def stable_and_unstable_i_wide():
    """x2 = 3 > 2 x1, alpha = 0.15 above 2 (x2 - x1)/(pi x2^2) = 0.1415, and 0.13 below."""
    return [_signs("one-constant", alpha=alpha, x2=3.0) for alpha in (0.15, 0.13)], [[1, -1], [1, -1]]


@claim
def stable_and_unstable_ii():
    return _signs("one-rational", alpha=0.1), [1, -1]


@claim
def stable_and_unstable_iii():
    return _signs("one", alpha=0.7), [1, -1]


@claim
def flow_i():
    """Figure 2b: how many amplitudes beside rest at alpha = 0.1 and 0.2."""
    return [len(amplitudes(averaged("one-constant"), alpha=alpha)) for alpha in (0.1, 0.2)], [2, 0]


@claim
def flow_ii():
    """Figure 2e: at alpha = 0.1 and 0.2."""
    return [len(amplitudes(averaged("one-rational"), alpha=alpha)) for alpha in (0.1, 0.2)], [2, 0]


@claim
def flow_iii():
    """Figure 2h: at alpha = 0.7 and 1.1."""
    return [len(amplitudes(averaged("one"), alpha=alpha)) for alpha in (0.7, 1.1)], [2, 0]


@claim
def only_rest_i_strong():
    """Supplement 4, case (i): alpha = 0.7 > 2/(pi x1): largest r' is negative, r' falls everywhere, x2 = 8."""
    model, at = averaged("one-constant"), np.linspace(0.05, 10, 400)
    values = np.array([rates(model, [r], alpha=0.7, x2=8.0)[0] for r in at])
    return [bool(values.max() < 0), bool(np.all(np.diff(values) < 0))], [True, True]


@claim
def only_rest_i_medium():
    """Case (ii-a): 1/(2 pi x1) <= alpha = 0.2 <= 2/(pi x1), x2 = 8: r' has a maximum, which is negative."""
    model, at = averaged("one-constant"), np.linspace(0.05, 10, 400)
    values = np.array([rates(model, [r], alpha=0.2, x2=8.0)[0] for r in at])
    return [bool(values.max() < 0), bool(np.all(np.diff(values) < 0))], [True, False]


@claim
def two_states_i_only_if_wide():
    """Case (ii-b): is the stable amplitude below x2 just below the fold, for x2 = 3 > 2 x1, and for 1.9?"""
    model = averaged("one-constant")
    return [bool(amplitudes(model, alpha=0.157, x2=x2)[-1] < x2) for x2 in (3.0, 1.9)], [True, False]


@claim
def two_states_i_narrow():
    """Case (iii): x2 = 1.5, alpha just below and above 2 (x2 - x1)/(pi x2^2) = 0.14147."""
    fold = 2 * 0.5 / (pi * 1.5**2)
    model = averaged("one-constant")
    return [len(amplitudes(model, alpha=q * fold)) for q in (0.99, 1.01)], [2, 0]


@claim
def case_iii_has_states_if_wide():
    """x2 = 3: at alpha = 2 x1/(pi x2^2) = 0.0707, the border of case (iii), there are two amplitudes."""
    return len(amplitudes(averaged("one-constant"), alpha=2 / (pi * 9), x2=3.0)), 2


@claim
def place_of_the_maximum_i():
    """Is sqrt(2 x1/(pi alpha)) < x1 for alpha = 0.64 > 2/(pi x1), and not for 0.63? By the slope of r' at x1."""
    model = averaged("one-constant")
    return [bool(slopes(model, [1 + 1e-9], alpha=alpha, x2=8.0)[0, 0] < 0) for alpha in (0.64, 0.63)], [True, False]


@claim
def amplitude_equation_ii():
    """4 pi r r' = log(1 + R^2) - 2 pi alpha R, R = r^2."""
    at = np.array([0.5, 1.1, 2.4])
    ours = [4 * pi * r * rates(averaged("one-rational"), [r], alpha=0.11)[0] for r in at]
    return ours, log(1 + at**4) - 2 * pi * 0.11 * at**2


@claim
def log_is_a_sigmoid():
    """log(1 + R^2), taken from r' without damping, at R = 1e8 over that at R = 1e4: 1 if it is bounded, 2 as it is."""
    low, high = (4 * pi * r * rates(averaged("one-rational"), [r], alpha=0.0)[0] for r in (1e2, 1e4))
    return high / low, 1.0, 2.0


@claim
def solutions_ii():
    """Amplitudes of model (ii) at alpha = 0.5 and 0.11 (figure S3)."""
    return [len(amplitudes(averaged("one-rational"), alpha=alpha)) for alpha in (0.5, 0.11)], [0, 2]


@claim
def linear_rational_equation():
    """2 pi r r' = log(1 + R) - pi alpha R."""
    at = np.array([0.5, 1.1, 2.4])
    ours = [2 * pi * r * rates(averaged("one-linear-rational"), [r], alpha=0.15)[0] for r in at]
    return ours, log(1 + at**2) - pi * 0.15 * at**2


@claim
def linear_rational_solutions():
    """Amplitudes at alpha = 0.7 and 0.15 (figures S1, S2a, S2b)."""
    return [len(amplitudes(averaged("one-linear-rational"), alpha=alpha)) for alpha in (0.7, 0.15)], [0, 1]


@claim
def linear_rational_rest():
    """Slope of r' at rest: (1/pi - alpha)/2, at alpha = 0.2 and 0.7."""
    model = averaged("one-linear-rational")
    return [slopes(model, [0.0], alpha=alpha)[0, 0] for alpha in (0.2, 0.7)], [(1 / pi - q) / 2 for q in (0.2, 0.7)]


@claim
def linear_rational_is_not_bistable():
    """Is rest stable where an oscillation exists (alpha = 0.15)?"""
    model = averaged("one-linear-rational")
    return [len(amplitudes(model, alpha=0.15)), bool(slopes(model, [0.0], alpha=0.15)[0, 0] < 0)], [1, False]


@claim
def linear_rational_push_is_linear_at_rest():
    """Force of x/(1 + x^2) over x at x = 0.01, and that of model (ii) over x^3."""
    ours = [pushed("one-linear-rational", 0.01, 0.01) / 0.01, pushed("one-rational", 0.01, 0.01) / 0.01**3]
    return ours, [1 / (1 + 1e-4), 1 / (1 + 1e-8)]


@claim
def van_der_pol_does_not_rest():
    """The average of x'' + x = eps (1 - x^2) x' at rest: its slope is positive, so that rest is unstable."""
    model = contin.Model(
        "van-der-pol", states={"x": 2, "y": 0}, parameters={"eps": 0.01},
        equations={"x": "y", "y": "-x + eps*(1 - x^2)*y"},
        averaging={"small": "eps", "oscillators": [{"position": "x", "velocity": "y"}]},
    )  # fmt: skip
    return slopes(contin.average(model, form="polar"), [0.0])[0, 0], 0.5


@claim
def typical_motion_of_one():
    """Figure 1b: amplitude after 5000 from (3, 0), alpha = 0.5, and the averaged one."""
    found = contin.simulate(loaded("one"), {"x": 3, "y": 0}, {"alpha": 0.5}, time=100, transient=4900, samples=2001)
    return np.hypot(*found.states.T).mean(), r_star(0.5)


@claim
def alpha_grows_with_mu():
    """alpha of a platform of mass m/0.1 and m over that of one without motion: damping over frequency, at rest."""
    def alpha(mass):
        matrix = slopes(bodies(), (0, 0, 0, 0), M=mass)
        return -matrix[3, 3] / sqrt(-matrix[3, 1])

    return [alpha(BODIES["m"] / mu) / alpha(1e15) for mu in (0.1, 1.0)], [sqrt(1.1), sqrt(2.0)]


@claim
def heavier_metronomes_are_quenched():
    """Does alpha grow with m at fixed M? From m = 0.3 to 0.6, M = 1.7: alpha goes as sqrt(1/m + 1/M)."""
    def alpha(m):
        matrix = slopes(bodies(), (0, 0, 0, 0), m=m)
        return -matrix[3, 3] / sqrt(-matrix[3, 1])

    printed = [True, sqrt((1 + 0.6 / 1.7) / (1 + 0.3 / 1.7))]
    ratio = sqrt((1 / 0.6 + 1 / 1.7) / (1 / 0.3 + 1 / 1.7))
    return [bool(alpha(0.6) > alpha(0.3)), alpha(0.6) / alpha(0.3)], printed, [False, ratio]


@claim
def dispersion_of_eps():
    """x'' + x = eps(...): slope of the force in eps at (1.2, 0.5), alpha = 0.5."""
    one, two = (rates(loaded("one"), (1.2, 0.5), alpha=0.5, eps=eps)[1] for eps in (EPS, 2 * EPS))
    return (two - one) / EPS, -0.5 * 0.5 + A * 1.2**3 - B * 1.2**5
