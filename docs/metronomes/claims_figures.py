"""Claims of the figures, by simulation of the equations of motion and of the averages. eps = 0.01."""

from functools import cache

import numpy as np
from claiming import A, B, amplitudes, averaged, claim, loaded
from claims_full import as_states, fold_of_one, folds_of_the_in_phase_orbit, settled
from numpy import pi, sqrt

import contin
from contin.simulate.sweep import sweep

STARTS = {
    "near in-phase": (5.01, 0.0, 5.0, 0.0),
    "in-phase": (5.0, 0.0, 5.0, 0.0),
    "near anti-phase": (5.01, 0.0, -5.0, 0.0),
    "anti-phase": (5.0, 0.0, -5.0, 0.0),
}


def from_starts(beta: float, mu: float, which: str = "") -> list[str]:
    """What each of the four starts of the paper settles on, or of those whose names end so."""
    return [settled(beta, mu, start) for name, start in STARTS.items() if name.endswith(which)]


@claim
def figure_3b():
    return settled(0.8, 10.0, (2.8, 0.0, -2.7, 0.0)), "anti-phase"


@claim
def figure_3c():
    """From (2.8, 0, 2.7, 0), which is beside in-phase synchrony: it is stable."""
    return settled(0.8, 10.0, (2.8, 0.0, 2.7, 0.0)), "in-phase"


@claim
def figure_4_white():
    """mu = 5, beta = 1: rest from all four starts."""
    return from_starts(1.0, 5.0), ["rest"] * 4


@claim
def figure_4_blue():
    """mu = 2, beta = 0.5: both anti-phase starts come to anti-phase synchrony."""
    return from_starts(0.5, 2.0, "anti-phase"), ["anti-phase", "anti-phase"]


@claim
def figure_4_green():
    """mu = 2, beta = 0.5: the exactly in-phase start stays in phase, the one beside it does not."""
    near, exactly = from_starts(0.5, 2.0, "in-phase")
    return [exactly, near == "in-phase"], ["in-phase", False]


@claim
def figure_4_red():
    """mu = 18, beta = 0.5: both in-phase starts."""
    return from_starts(0.5, 18.0, "in-phase"), ["in-phase", "in-phase"]


@claim
def figure_4_blue_only():
    """mu = 10, beta = 0.92: in-phase starts come to rest, anti-phase ones do not."""
    return from_starts(0.92, 10.0), ["rest", "rest", "anti-phase", "anti-phase"]


@claim
def a_kick_from_anti_phase_quenches():
    """At mu = 10, beta = 0.92 the anti-phase state, with the second metronome turned round (x2, y2) -> (-x2, -y2)."""
    parameters = {"beta": 0.92, "mu": 10.0}
    start = as_states(STARTS["near anti-phase"])
    found = contin.simulate(loaded("pair"), start, parameters, time=1, transient=8000, samples=2)
    x1, y1, x2, y2 = found.states[-1].tolist()
    before = bool(np.hypot(x1 + x2, y1 + y2) < 0.05 and np.hypot(x1, y1) > 1)
    return [before, settled(0.92, 10.0, (x1, y1, -x2, -y2))], [True, "rest"]


@claim
def in_phase_is_quenched_earlier():
    """Folds of the in-phase orbit at mu = 5 and 10 lie below that of the anti-phase orbit, and fall with mu."""
    _, five, ten = folds_of_the_in_phase_orbit()
    return [five < fold_of_one(), ten < five], [True, True]


@claim
def averaging_in_phase_asks_for_eps_mu_only():
    """The fold of the in-phase orbit at mu = 100, where eps mu = 1, and beta_SN_in."""
    orbit = contin.periodic_orbit(loaded("pair"), "in-phase", {"beta": 0.5, "mu": 100.0})
    branch = contin.continuation(orbit, "beta", (0.4, 0.7), direction="up")
    found = next(p.values["beta"] for p in branch.points if p.type == "LPC")
    return found, 3 * A**2 / (16 * pi * B * sqrt(3.0)), fold_of_one() / sqrt(3.0)


@claim
def figure_5a():
    return settled(0.2, 3.0), "anti-phase"


@claim
def figure_5b():
    return settled(0.8, 3.0), "beating"


@claim
def figure_5c():
    return settled(0.74, 5.0), "unequal amplitudes"


@cache
def beat_of_the_average(mu: float, beta: float) -> tuple[float, float]:
    """Range of r1 on what the averaged pair settles on from beside in-phase synchrony."""
    start = {"r1": 2.1, "r2": 2.0, "psi": 0.0}
    found = contin.simulate(averaged("pair"), start, {"mu": mu, "beta": beta}, time=200, transient=3000, samples=40_001)
    r = found.states[:, 0]
    return float(r.min()), float(r.max())


@claim
def figure_5c_is_an_equilibrium_of_the_average():
    """Range of r1 of the averaged pair at mu = 5, beta = 0.74: it beats."""
    low, high = beat_of_the_average(5.0, 0.74)
    return high - low, 0.0, 0.392334


@claim
def figure_5b_is_a_limit_cycle_of_the_average():
    """Has the averaged pair stable periodic orbits for mu = 2.9 ... 3.1, beta = 0.8? In its Stokes form."""
    slow = averaged("pair", "stokes")
    orbit = contin.periodic_orbit(slow, {"S1": 0.05, "S2": 8.4, "S3": 0.001}, {"mu": 3.0, "beta": 0.8})
    family = contin.continuation(orbit, "mu", (2.9, 3.1))
    return [int(family.columns["unstable"].max()), bool(family.columns["period"].min() > 1)], [0, True]


@claim
def metronome_suppression():
    """mu = 0.2, beta = 0.8: amplitudes that the equations of motion keep from (2.2, 0, 0.1, 0), above and below 1."""
    start = as_states((2.2, 0.0, 0.1, 0.0))
    found = contin.simulate(loaded("pair"), start, {"mu": 0.2, "beta": 0.8}, time=200, transient=12_000, samples=4001)
    x1, y1, x2, y2 = found.states.T
    return [bool(np.hypot(x1, y1).min() > 1), bool(0.05 < np.hypot(x2, y2).max() < 1)], [True, True]


def _swept(name: str, low: float, high: float, x: float, steps: int = 2, **parameters):
    """Mean amplitudes on the way up from x."""
    found = sweep(
        loaded(name), "alpha", (low, high), start={"x": x, "y": 0}, parameters=parameters, steps=steps, down=False,
        measures={"r": "sqrt(x^2 + y^2)"},
    )  # fmt: skip
    return found.columns["r.mean"]


@claim
def sweep_i_agrees():
    """Figure 2c: amplitudes at alpha = 0.04, 0.08, 0.12, and sqrt(2 (x2 - x1)/(pi alpha))."""
    return _swept("one-constant", 0.04, 0.12, 2.0), sqrt(1 / (pi * np.array([0.04, 0.08, 0.12])))


@claim
def sweep_ii_agrees():
    """Figure 2f: amplitudes at alpha = 0.04, 0.08, 0.12, and the larger root of 2 pi alpha R = log(1 + R^2)."""
    printed = [amplitudes(averaged("one-rational"), alpha=alpha)[-1] for alpha in (0.04, 0.08, 0.12)]
    return _swept("one-rational", 0.04, 0.12, 2.0), printed


@claim
def sweep_linear_rational_agrees():
    """Figure S2c: amplitudes at alpha = 0.1, 0.2, and the root of pi alpha R = log(1 + R)."""
    printed = [amplitudes(averaged("one-linear-rational"), alpha=alpha)[-1] for alpha in (0.1, 0.2)]
    return _swept("one-linear-rational", 0.1, 0.2, 2.0, steps=1), printed


@claim
def oscillation_stops_i_and_ii():
    """Figures 2c, 2f: is there an oscillation at alpha = 0.13 and 0.15 (i), 0.12 and 0.14 (ii), on the way up?"""
    one = [bool(r > 0.1) for r in _swept("one-constant", 0.13, 0.15, 2.0, steps=1)]
    return one + [bool(r > 0.1) for r in _swept("one-rational", 0.12, 0.14, 2.0, steps=1)], [True, False] * 2


@claim
def rest_stays_on_the_way_down():
    """Models (i), (ii), (iii) from rest at alpha = 0.01 ... 0.1: amplitudes that the red dots show."""
    names = ("one-constant", "one-rational", "one")
    return [float(_swept(name, 0.01, 0.1, 0.01, steps=1).max()) < 0.02 for name in names], [True] * 3
