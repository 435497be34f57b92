"""Claims about the equations of motion of the pair themselves, eps = 0.01 unless said otherwise."""

from functools import cache

import numpy as np
from claiming import EPS, A, B, claim, loaded, mu_c
from numpy import pi, sqrt

import contin

NEAR_IN_PHASE = (5.01, 0.0, 5.0, 0.0)


def as_states(values) -> dict[str, float]:
    """The states of the pair by name."""
    return dict(zip(("x1", "y1", "x2", "y2"), values, strict=True))


@cache
def mu_c_by_continuation(beta: float, eps: float) -> float:
    """mu at the branch point of the in-phase orbit of the piecewise-smooth equations."""
    guess = mu_c(beta)
    orbit = contin.periodic_orbit(
        loaded("pair"), "in-phase", {"beta": beta, "eps": eps, "mu": guess + 0.4}
    )
    branch = contin.continuation(orbit, "mu", (guess - 2, guess + 1))
    return next(p.values["mu"] for p in branch.points if p.type == "BPC")


@cache
def settled(beta: float, mu: float, start: tuple[float, ...] = NEAR_IN_PHASE) -> str:
    """What the equations of motion settle on from (5.01, 0, 5, 0), in words, by amplitudes over the last 3000."""
    pair, at = loaded("pair"), {"beta": beta, "mu": mu}
    found = contin.simulate(pair, as_states(start), at, time=3000, transient=12_000, samples=30_000)
    x1, y1, x2, y2 = found.states.T
    one, two = np.hypot(x1, y1), np.hypot(x2, y2)
    together, apart = np.hypot(x1 + x2, y1 + y2), np.hypot(x1 - x2, y1 - y2)
    if one.max() < 0.05 and two.max() < 0.05:
        return "rest"
    if together.max() < 0.01:
        return "anti-phase"
    if apart.max() < 0.01:
        return "in-phase"
    return "beating" if max(np.ptp(one), np.ptp(two)) > 0.5 else "unequal amplitudes"


@claim
def mu_c_in_the_equations_of_motion():
    """mu_c at beta = 0.3 and eps = 0.01, by continuation of the orbit, and the averaged one."""
    return mu_c_by_continuation(0.3, EPS), mu_c(0.3), 9.948029265


@claim
def mu_c_approaches_the_average():
    """Differences of mu_c(eps) from the averaged value at eps = 0.01, 0.005, 0.001, each over eps: they are bounded."""
    steps = np.array([0.01, 0.005, 0.001])
    differences = [mu_c(0.3) - mu_c_by_continuation(0.3, e) for e in steps]
    return [bool(d > 0) for d in differences] + [bool(d / e < 75) for d, e in zip(differences, steps, strict=True)], [
        True
    ] * 6


@claim
def mu_c_at_second_order():
    """Slope of mu_c(eps) at 0: of the orbits at 0.001 and 0.0005, extrapolated, and of second-order averages."""
    slope = [(mu_c_by_continuation(0.3, e) - mu_c(0.3)) / e for e in (0.001, 0.0005)]
    return 2 * slope[1] - slope[0], -71.16, -71.15541


@cache
def fold_of_one() -> float:
    """alpha of the fold of one metronome's orbit at eps = 0.01: of a pair in anti-phase, too."""
    orbit = contin.periodic_orbit(loaded("one"), "oscillating", {"alpha": 0.8})
    branch = contin.continuation(orbit, "alpha", (0.7, 1.0), direction="up")
    return next(p.values["alpha"] for p in branch.points if p.type == "LPC")


def folds_of_the_in_phase_orbit() -> tuple[float, ...]:
    """beta of the fold at mu = 1, 5 and 10, by continuation: at mu = 1 multipliers of a saddle cross beside it."""
    found = []
    for mu in (1.0, 5.0, 10.0):
        orbit = contin.periodic_orbit(loaded("pair"), "in-phase", {"beta": 0.8, "mu": mu})
        branch = contin.continuation(orbit, "beta", (0.7, 1.0), direction="up")
        found.append(next(p.values["beta"] for p in branch.points if p.type == "LPC"))
    return tuple(found)


@claim
def fold_of_the_in_phase_orbit():
    """beta of the fold of the in-phase orbit at mu = 1, 5 and 10, by continuation, and beta_SN_in."""
    shrink = sqrt(1 + 2 * EPS * np.array([1.0, 5.0, 10.0]))
    return list(folds_of_the_in_phase_orbit()), 3 * A**2 / (16 * pi * B * shrink), fold_of_one() / shrink
