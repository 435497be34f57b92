"""Claims about the equations of motion of the pair themselves, eps = 0.01 unless said otherwise."""

from functools import cache

import numpy as np
from claiming import EPS, A, B, claim, mu_c
from numpy import pi, sqrt

import contin

NEAR_IN_PHASE = {"x1": 5.01, "y1": 0, "x2": 5, "y2": 0}


@cache
def mu_c_by_continuation(beta: float, eps: float) -> float:
    """mu at the branch point of the in-phase orbit of the piecewise-smooth equations."""
    guess = mu_c(beta)
    orbit = contin.periodic_orbit(
        contin.load("metronomes/pair"), "in-phase", {"beta": beta, "eps": eps, "mu": guess + 0.4}
    )
    branch = contin.continuation(orbit, "mu", (guess - 2, guess + 1))
    return next(p.values["mu"] for p in branch.points if p.type == "BPC")


@cache
def settled(beta: float, mu: float, start: str = "near") -> str:
    """What the equations of motion settle on from (5.01, 0, 5, 0), in words, by amplitudes over the last 3000."""
    states = NEAR_IN_PHASE if start == "near" else start
    found = contin.simulate(
        contin.load("metronomes/pair"), states, {"beta": beta, "mu": mu}, time=3000, transient=12_000, samples=30_000
    )
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
def three_states():
    ours = [settled(beta, mu) for mu, beta in ((3.0, 0.2), (3.0, 0.8), (5.0, 0.74))]
    return ours, ["anti-phase", "beating", "unequal amplitudes"]


@claim
def both_synchronous_at_mu_10():
    return [settled(0.8, 10.0, s) for s in ("anti-phase", "in-phase")], ["anti-phase", "in-phase"]


@claim
def mu_c_in_the_equations_of_motion():
    """mu_c at beta = 0.3 and eps = 0.01, by continuation of the orbit, and the averaged one."""
    return mu_c_by_continuation(0.3, EPS), mu_c(0.3)


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
    return 2 * slope[1] - slope[0], -71.16


@claim
def fold_of_the_in_phase_orbit():
    """beta of the fold of the in-phase orbit at mu = 5 and 10, by continuation, and beta_SN_in."""
    ours = []
    for mu in (5.0, 10.0):
        model = contin.load("metronomes/pair")
        orbit = contin.periodic_orbit(model, "in-phase", {"beta": 0.8, "mu": mu})
        branch = contin.continuation(orbit, "beta", (0.7, 1.0), direction="up")
        ours.append(next(p.values["beta"] for p in branch.points if p.type == "LPC"))
    return ours, [3 * A**2 / (16 * pi * B * sqrt(1 + 2 * EPS * mu)) for mu in (5.0, 10.0)]
