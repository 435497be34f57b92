"""Claims about two metronomes: exact equations, their averages, and what follows from them."""

from functools import cache

import numpy as np
from claiming import EPS, A, B, averaged, claim, loaded, motion, mu_c, pushed, r_star, rates, slopes
from claims_two import SETS
from numpy import cos, pi, sin, sqrt

import contin

PLACE = (1.3, 0.2, -0.4, 0.9)  # x1, y1, x2, y2: the first is pushed, the second is not
OSCILLATORS = [{"position": f"x{i}", "velocity": f"y{i}"} for i in (1, 2)]


def _push(x, y):
    return np.where(np.asarray(x) * y > 0, A * np.asarray(x) ** 3 - B * np.asarray(x) ** 5, 0.0)


@claim
def equations_alike():
    """`metronomes/pair-unlike` with equal springs and dampings is `metronomes/pair`."""
    unlike = rates(loaded("pair-unlike"), PLACE, mu=3.0, beta=0.8, skew=0.0, delta=0.0)
    return unlike, motion("pair", PLACE, mu=3.0, beta=0.8)


@claim
def equations_implicit():
    """The left-hand side of the equations with accelerations on both sides, and the right-hand side."""
    found = motion("pair", PLACE, mu=3.0, beta=0.8)
    x, y, a = np.array(PLACE[::2]), np.array(PLACE[1::2]), found[1::2]
    return a + x, EPS * (-0.8 * y + _push(x, y) + 3.0 * a.sum() / (1 + 2 * EPS * 3.0))


@claim
def equations_solved():
    """The accelerations, solved for."""
    mu, beta, x, y = 3.0, 0.8, np.array(PLACE[::2]), np.array(PLACE[1::2])
    g = _push(x, y)
    common = EPS**2 * mu * (-beta * y.sum() + g.sum())
    return motion("pair", PLACE, mu=mu, beta=beta)[1::2], -x - EPS * (mu * x.sum() + beta * y - g) + common


@cache
def reduced():
    """The pair without its terms of order eps^2."""
    own = "eps*(mu*(x1 + x2) + beta*y{0} - (a*x{0}^3 - b*x{0}^5 if x{0}*y{0} > 0 else 0))"
    return contin.Model(
        "reduced", states=dict(zip(("x1", "y1", "x2", "y2"), PLACE, strict=True)),
        parameters={"mu": 3, "beta": 0.8, "a": A, "b": B, "eps": EPS},
        equations={"x1": "y1", "y1": f"-x1 - {own.format(1)}", "x2": "y2", "y2": f"-x2 - {own.format(2)}"},
        averaging={"small": "eps", "oscillators": OSCILLATORS},
    )  # fmt: skip


@claim
def reduced_equations():
    """What the reduced equations leave out, over eps^2: mu (-beta (y1 + y2) + g1 + g2) in each."""
    x, y = np.array(PLACE[::2]), np.array(PLACE[1::2])
    left = motion("pair", PLACE, mu=3.0, beta=0.8) - rates(reduced(), PLACE)
    return left[1::2] / EPS**2, [3.0 * (-0.8 * y.sum() + _push(x, y).sum())] * 2


@claim
def reduced_equations_have_the_same_average():
    places = ((1.3, 0.7, 0.4), (2.2, 1.9, -2.0))
    ours = [rates(contin.average(reduced(), form="polar"), u) for u in places]
    return ours, [rates(averaged("pair"), u, mu=3.0, beta=0.8) for u in places]


def _polar(r, phi):
    """x1, y1, x2, y2."""
    return np.ravel(np.column_stack([r * cos(phi), -r * sin(phi)]))


@claim
def polar_equations_of_the_pair():
    """r_i' and theta_i' by the chain rule from the reduced equations, and the printed ones."""
    r, phi = np.array([1.3, 0.8]), np.array([2.0, 0.6])
    state = _polar(r, phi)
    x, y, d = state[::2], state[1::2], rates(reduced(), state)
    ours = [(x * d[::2] + y * d[1::2]) / (r * EPS), (-(x * d[1::2] - y * d[::2]) / r**2 - 1) / EPS]
    force = 3.0 * x.sum() + 0.8 * y - _push(x, y)
    return ours, [sin(phi) * force, cos(phi) * force / r]


@claim
def complex_amplitudes_of_the_pair():
    """A_i' from the reduced equations, and the printed i eps exp(-it) (mu (x1 + x2) + beta y - g)."""
    x, y, d = np.array(PLACE[::2]), np.array(PLACE[1::2]), rates(reduced(), PLACE)
    ours = ((d[::2] - 1j * d[1::2]) - 1j * (x - 1j * y)) * np.exp(-0.9j)
    printed = 1j * np.exp(-0.9j) * EPS * (3.0 * x.sum() + 0.8 * y - _push(x, y))
    return [ours.real, ours.imag], [printed.real, printed.imag]


def _amplitudes_by_cartesian(r, theta, **parameters):
    """r_i' and theta_i' from the average in cartesian form, where A_i = u_i + i v_i."""
    model = averaged("pair", "cartesian")
    z = r * np.exp(1j * theta)
    found = rates(model, np.ravel(np.column_stack([z.real, z.imag])), **parameters)
    rate = (found[::2] + 1j * found[1::2]) * np.exp(-1j * theta)
    return rate.real, rate.imag / r


@claim
def averages_of_both_phases():
    """theta_1' and theta_2' at r = (1.3, 0.7), theta = (0.4, -0.5), from the average in cartesian amplitudes."""
    r, theta, mu = np.array([1.3, 0.7]), np.array([0.4, -0.5]), 3.0
    ours = _amplitudes_by_cartesian(r, theta, mu=mu, beta=0.8)[1]
    g2 = (6 * A * r**3 - 5 * B * r**5) / 32
    printed = mu / 2 + mu * r[::-1] / (2 * r) * cos(theta[0] - theta[1]) - g2 / r
    return ours, printed


@claim
def averages_of_both_amplitudes():
    """r_1' and r_2' there."""
    r, theta, mu = np.array([1.3, 0.7]), np.array([0.4, -0.5]), 3.0
    ours = _amplitudes_by_cartesian(r, theta, mu=mu, beta=0.8)[0]
    g1 = -(3 * A * r**3 - 2 * B * r**5) / (12 * pi)
    return ours, mu * r[::-1] / 2 * sin(np.array([1, -1]) * (theta[0] - theta[1])) - 0.8 * r / 2 - g1


@claim
def averages_are_symmetric():
    """The averaged equations under (r1, r2, psi) -> (r2, r1, -psi)."""
    here = rates(averaged("pair"), (1.3, 0.7, 0.4), mu=3.0, beta=0.8)
    there = rates(averaged("pair"), (0.7, 1.3, -0.4), mu=3.0, beta=0.8)
    return there, [here[1], here[0], -here[2]]


def _stable(r, psi, beta, mu) -> bool:
    matrix = slopes(averaged("pair"), (r, r, psi), mu=mu, beta=beta)
    return bool(np.linalg.eigvals(matrix).real.max() < 0)


@claim
def partners_are_unstable():
    """Are the states of the smaller amplitude stable anywhere, at 25 points?"""
    return [any(_stable(r_star(b, -1), psi, b, m) for b, m in SETS) for psi in (0, pi)], [False, False]


@claim
def no_synchrony_beyond_the_fold():
    """Largest of r' of one alone at beta = 0.9549 and 0.9550: synchronous states exist below beta_SN = 0.95493 only."""
    at = np.linspace(1.6, 1.9, 3001)
    found = [max(float(rates(averaged("pair"), (r, r, 0.0), beta=beta)[0]) for r in at) for beta in (0.954, 0.956)]
    return [value > 0 for value in found], [True, False]


@claim
def stability_by_the_signs():
    """Stable exactly where j1 < 0 and j2 j3 > 0: at 25 points, in-phase and anti-phase, both amplitudes."""
    ours, printed = [], []
    for (beta, mu), psi, sign in ((q, psi, sign) for q in SETS for psi in (0.0, pi) for sign in (1, -1)):
        r, s = r_star(beta, sign), 1 if psi == 0 else -1
        j1 = (-6 * pi * beta + 9 * A * r**2 - 10 * B * r**4) / (12 * pi)
        j2, j3 = mu * r * s / 2, (3 * A * r - 5 * B * r**3 + 8 * mu * s / r) / 8
        ours.append(_stable(r, psi, beta, mu))
        printed.append(bool(j1 < 0 and j2 * j3 > 0))
    return ours, printed


@claim
def signs_of_the_entries():
    """Signs of j1, j2, j3 in anti-phase, and of j1, j2 in phase, over 25 points."""
    found = [slopes(averaged("pair"), (r_star(b), r_star(b), psi), mu=m, beta=b) for psi in (pi, 0) for b, m in SETS]
    anti, both = found[: len(SETS)], found[len(SETS) :]
    ours = [{int(np.sign(m[i, j])) for m in group} for group, i, j in
            ((anti, 0, 0), (anti, 1, 2), (anti, 2, 0), (both, 0, 0), (both, 1, 2))]  # fmt: skip
    return [min(s) if len(s) == 1 else 0 for s in ours], [-1, -1, -1, -1, 1]


@claim
def in_phase_changes_at_mu_c_only():
    """Stable at 0.98 mu_c and at 1.02 mu_c, for beta = 0.2, 0.5, 0.9."""
    ours = [[_stable(r_star(b), 0.0, b, q * mu_c(b)) for q in (0.98, 1.02)] for b in (0.2, 0.5, 0.9)]
    return ours, [[False, True]] * 3


@claim
def eigenvalue_zero_on_the_dashed_line():
    """Smallest eigenvalue in modulus of the in-phase state at mu_c, beta = 0.2, 0.5, 0.9."""
    found = [slopes(averaged("pair"), (r_star(b), r_star(b), 0.0), mu=mu_c(b), beta=b) for b in (0.2, 0.5, 0.9)]
    return [float(np.abs(np.linalg.eigvals(m)).min()) for m in found], [0.0] * 3


@claim
def in_phase_motion_scaled():
    """(1 + 2 eps mu) times the force on x1 = x2, and the printed equation after t -> t sqrt(1 + 2 eps mu)."""
    mu, beta, x, v = 10.0, 0.8, 1.2, 0.7
    whole = 1 + 2 * EPS * mu
    ours = motion("pair", (x, v * sqrt(whole), x, v * sqrt(whole)), mu=mu, beta=beta)[1] / whole
    return ours, -x + EPS * (-beta * sqrt(whole) * v + A * x**3 - B * x**5)


@claim
def in_phase_motion():
    """x''/(1 + 2 eps mu) + x on x1 = x2, and eps (-beta x' + g)."""
    mu, beta, x, v = 10.0, 0.8, 1.2, 0.7
    found = motion("pair", (x, v, x, v), mu=mu, beta=beta)
    return found[1] / (1 + 2 * EPS * mu) + x, EPS * (-beta * v + A * x**3 - B * x**5)


@claim
def push_does_not_ask_for_the_speed():
    """g(x, 0.7) and g(x, 2.1) at x = 1.2, from the equation of motion of one."""
    return pushed("one", 1.2, 0.7), pushed("one", 1.2, 2.1)


@claim
def in_phase_average():
    """r' of one metronome with damping beta sqrt(1 + 2 eps mu), at mu = 10, beta = 0.8, r = 1.9."""
    r, beta = 1.9, 0.8 * sqrt(1 + 2 * EPS * 10)
    return rates(averaged("one"), [r], alpha=beta)[0], (-6 * pi * beta * r + 3 * A * r**3 - 2 * B * r**5) / (12 * pi)


@claim
def quenched_above_the_fold():
    """beta at which the largest of d(r1^2 + r2^2)/dt, from the averaged pair at any phase, is zero.

    The coupling drops out of it, so that the sum falls from every state where this is negative: with r2 -> 0 the rate
    over r1^2 is that of one metronome alone.
    """
    at = np.linspace(1.7, 1.8, 2001)
    found = [rates(averaged("pair"), (r, 1e-9, 1.0), beta=0.0, mu=3.0) for r in at]
    return 2 * max(d[0] / r for d, r in zip(found, at, strict=True)), 3 * A**2 / (16 * pi * B)


@claim
def coupling_keeps_the_sum_of_squares():
    """d(r1^2 + r2^2)/dt at mu = 3 and at mu = 0."""
    u = np.array([1.3, 0.7, 0.4])
    with_, without = (rates(averaged("pair"), u, mu=mu, beta=0.8)[:2] @ u[:2] for mu in (3.0, 0.0))
    return with_, without


@claim
def unequal_amplitudes_near_mu_c():
    """Is there a stable state with r1 > r2 just below mu_c (beta = 0.8, mu = 4.7)? By branch switching."""
    state = contin.equilibrium(averaged("pair", "stokes"), start="in-phase", parameters={"beta": 0.8, "mu": 8.0})
    line = contin.continuation(state, "mu", (4.0, 8.0))
    branch = contin.continuation(line["BP1"].switch(), "mu", (4.0, 8.0))
    mu, stable = branch.columns["mu"], branch.columns["unstable"] == 0
    return [bool(np.any(stable & (np.abs(mu - 4.7) < 0.05))), bool(np.all(mu < mu_c(0.8) + 1e-6))], [True, True]
