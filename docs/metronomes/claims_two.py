"""Claims about two metronomes: equations of motion, averages, stability, quenching. a = 4, b = 1, eps = 0.01."""

from itertools import product

import numpy as np
from claiming import EPS, A, B, averaged, claim, labels, loaded, mu_c, r_star, rates, slopes
from numpy import cos, pi, sin, sqrt

BETAS, MUS = (0.05, 0.3, 0.6, 0.8, 0.94), (0.05, 1.0, 4.0, 8.0, 15.0)
SETS = tuple(product(BETAS, MUS))


@claim
def average_of_the_pair():
    """r1', r2', psi' at two points."""

    def printed(r1, r2, psi, mu=3.0, beta=0.8):
        return [
            (-6 * pi * mu * r2 * sin(psi) - 6 * pi * beta * r1 + 3 * A * r1**3 - 2 * B * r1**5) / (12 * pi),
            (6 * pi * mu * r1 * sin(psi) - 6 * pi * beta * r2 + 3 * A * r2**3 - 2 * B * r2**5) / (12 * pi),
            (16 * mu * (r1 / r2 - r2 / r1) * cos(psi) + 6 * A * (r1**2 - r2**2) - 5 * B * (r1**4 - r2**4)) / 32,
        ]

    places = ((1.3, 0.7, 0.4), (2.2, 1.9, -2.0))
    return [rates(averaged("pair"), u, mu=3.0, beta=0.8) for u in places], [printed(*u) for u in places]


@claim
def synchronous_states():
    """Largest residual of the averaged equations at (r*, r*, 0) and (r*, r*, pi), stable and unstable amplitudes."""
    worst = max(
        float(np.abs(rates(averaged("pair"), (r, r, psi), mu=mu, beta=beta)).max())
        for beta, mu in SETS
        for r in (r_star(beta), r_star(beta, -1))
        for psi in (0, pi)
    )
    return worst, 0


@claim
def fold_of_both():
    found = labels("pair", "LP", "anti-phase", "beta", 0.05, 1.0)
    return found[0].values["beta"], 3 * A**2 / (16 * pi * B)


@claim
def fold_of_both_is_a_fold_only():
    """Are the eigenvalues other than 0 off the imaginary axis at the fold of the anti-phase state, mu = 8?"""
    matrix = slopes(averaged("pair"), (sqrt(3.0), sqrt(3.0), pi), mu=8.0, beta=3 * A**2 / (16 * pi * B))
    values = sorted(np.linalg.eigvals(matrix), key=abs)[1:]
    return [abs(v.real) > 1e-6 for v in values], [True, True], [False, False]


def _entries(beta, mu, s):
    r = r_star(beta)
    return (
        (-6 * pi * beta + 9 * A * r**2 - 10 * B * r**4) / (12 * pi),
        mu * r * s / 2,
        (3 * A * r - 5 * B * r**3 + 8 * mu * s / r) / 8,
    )


@claim
def jacobian():
    ours, printed = [], []
    for (beta, mu), s in product(SETS, (1, -1)):
        r = r_star(beta)
        ours.append(slopes(averaged("pair"), (r, r, 0 if s == 1 else pi), mu=mu, beta=beta))
        j1, j2, j3 = _entries(beta, mu, s)
        printed.append([[j1, 0, -j2], [0, j1, j2], [j3, -j3, 0]])
    return ours, printed


@claim
def eigenvalues_in_closed_form():
    ours, printed = [], []
    for (beta, mu), s in product(SETS, (1, -1)):
        r = r_star(beta)
        matrix = slopes(averaged("pair"), (r, r, 0 if s == 1 else pi), mu=mu, beta=beta)
        j1, j2, j3 = _entries(beta, mu, s)
        root = np.emath.sqrt(j1**2 - 8 * j2 * j3)
        ours.append(np.poly(matrix))
        printed.append(np.poly([j1, (j1 + root) / 2, (j1 - root) / 2]))
    return ours, printed


@claim
def j1_simplified():
    root = [sqrt(9 * A**2 - 48 * pi * B * beta) for beta in BETAS]
    printed = [-(3 * A**2 - 16 * pi * B * b + A * s) / (8 * pi * B) for b, s in zip(BETAS, root, strict=True)]
    radii = [r_star(beta) for beta in BETAS]
    found = [slopes(averaged("pair"), (r, r, 0.0), mu=1.0, beta=b) for r, b in zip(radii, BETAS, strict=True)]
    return [matrix[0, 0] for matrix in found], printed


@claim
def j3_simplified():
    ours, printed = [], []
    for (beta, mu), s in product(SETS, (1, -1)):
        root = sqrt(9 * A**2 - 48 * pi * B * beta)
        r = r_star(beta)
        ours.append(slopes(averaged("pair"), (r, r, 0 if s == 1 else pi), mu=mu, beta=beta)[2, 0])
        upper = 27 * A**2 - 120 * pi * B * beta + 9 * A * root - 64 * B * mu * s
        printed.append(-upper / (32 * sqrt((3 * A + root) * B)))
    return ours, printed


@claim
def anti_phase_is_always_stable():
    """Largest real part over 25 points of the plane is negative; no branch point on the branch in mu."""
    worst = max(
        np.linalg.eigvals(slopes(averaged("pair"), (r_star(b), r_star(b), pi), mu=m, beta=b)).real.max()
        for b, m in SETS
    )
    return [bool(worst < 0), len(labels("pair", "BP", "anti-phase", "mu", 0.05, 8.0))], [True, 0]


@claim
def in_phase_is_stable_above_mu_c():
    """mu at the branch point of the in-phase branch, by continuation, at three values of beta."""
    betas = (0.3, 0.8, 0.9)
    ours = [labels("pair", "BP", "in-phase", "mu", 0.05, 15.0, beta=b)[0].values["mu"] for b in betas]
    return ours, [mu_c(b) for b in betas]


@claim
def last_sentence_of_the_stability_analysis():
    """Stable at mu = 1, beta = 0.8? (r*, r*, 0), then (r*, r*, pi)."""
    r = r_star(0.8)
    matrices = [slopes(averaged("pair"), (r, r, psi), mu=1.0, beta=0.8) for psi in (0, pi)]
    return [bool(np.linalg.eigvals(m).real.max() < 0) for m in matrices], [True, False], [False, True]


@claim
def supercritical_pitchfork():
    """Kind of the branch point and sign of its cubic coefficient at beta = 0.1, 0.5, 0.8, 0.94."""
    points = [labels("pair", "BP", "in-phase", "mu", 0.05, 15.0, beta=b)[0] for b in (0.1, 0.5, 0.8, 0.94)]
    return [bool(p.normal_form["b30"] < 0 and p.normal_form["kind"] == "pitchfork") for p in points], [True] * 4


def _rest(mu, beta):
    return slopes(loaded("pair"), (0, 0, 0, 0), mu=mu, beta=beta)


@claim
def rest_of_the_pair_is_stable():
    return bool(max(np.linalg.eigvals(_rest(mu, beta)).real.max() for beta, mu in SETS) < 0), True


@claim
def rest_linearised_in_phase():
    """Damping and square of the frequency of x1 + x2 at mu = 10, beta = 0.8, from the equations of motion."""
    matrix = _rest(10.0, 0.8)
    row = matrix[1] + matrix[3]
    printed = [EPS * 0.8 * (1 + EPS**2 * 10), 1 + 2 * EPS * 10]
    return [-row[1], -row[0]], printed, [EPS * 0.8 * (1 + 2 * EPS * 10), 1 + 2 * EPS * 10]


@claim
def rest_linearised_anti_phase():
    row = (lambda m: m[1] - m[3])(_rest(10.0, 0.8))
    return [-row[1], -row[0]], [EPS * 0.8, 1]


@claim
def pendulum_term_moves_mu_c():
    """mu of the branch point at sigma = 0.3, beta = 0.8, over its value at sigma = 0 (printed: it would change)."""
    found = labels("pair", "BP", "in-phase", "mu", 0.05, 15.0, beta=0.8, sigma=0.3)[0].values["mu"]
    return found, mu_c(0.8) - 0.75 * 0.3 * r_star(0.8) ** 2
