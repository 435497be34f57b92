"""Demos of AUTO-07p: travelling waves as connecting orbits, beside shooting, another solver and discriminants."""

from math import sqrt

import numpy as np
import pytest
from scipy.integrate import solve_bvp, solve_ivp
from scipy.optimize import brentq

from tests.cli.auto_demos.results import branches_of, result_of


@pytest.mark.long
def test_solitary_waves_have_belyakov_points_where_a_discriminant_vanishes():
    """fhh: l^3 - c l^2 - a l - eps/c at rest; a = -eps/c^2 at the Hopf point."""
    branches = branches_of("fhh")
    (hopf,) = [point for point in branches["rest"]["points"] if point["type"] == "HB"]
    assert hopf["values"]["a"] == pytest.approx(-0.0025 / 0.21**2, rel=1e-9)
    found = [point["values"] for point in branches["waves"]["points"] if point["type"] == "DRS"]
    assert len(found) == 2
    for values in found:
        a, c, e0 = values["a"], values["c"], 0.0025 / values["c"]
        terms = [18 * a * c * e0 * -1, -4 * c**3 * e0, a * a * c * c, 4 * a**3, -27 * e0 * e0]
        assert sum(terms) == pytest.approx(0.0, abs=1e-8 * max(map(abs, terms)))


@pytest.mark.seldom
def test_the_speed_of_a_sharp_wave_is_that_of_a_shot_from_the_other_end():
    """stw at lam = 1/2: the unstable manifold of (1, 0) passes the saddle (0, c) on one side or the other."""

    def beyond(c):
        rate = (c + sqrt(c * c + 10)) / 2  # of the linearisation [[0, 5/2], [1, c]]
        start = [1 - 1e-7, -1e-7 * rate / 2.5]

        def rates(_, y):
            u, v = y
            return [(2 * u + u * u / 2) * v, c * v - (1 + u / 2) * v * v - u * (1 - u)]

        near = lambda t, y: y[0] - 1e-9  # noqa: E731
        near.terminal = True
        return solve_ivp(rates, (0, 200), start, "DOP853", events=[near], rtol=1e-11, atol=1e-13).y[1, -1] - c

    (wave,) = result_of("stw")["branches"]
    (point,) = [p for p in wave["points"] if p["type"] == "UZ"]
    assert point["values"]["c"] == pytest.approx(brentq(beyond, -0.6, -0.58, xtol=1e-9), abs=1e-6)


def test_antisymmetric_orbits_are_those_of_another_solver():
    """rev at P = 0, by scipy's collocation: from the unstable eigenspace of u'''' = u^3 - u to u = u'' = 0."""
    odd = {branch["name"]: branch for branch in result_of("rev")["branches"]}["odd"]
    point = next(p for p in odd["points"] if abs(p["values"]["P"]) < 1e-9)
    orbit = {name: np.array(values) for name, values in point["orbit"].items()}
    matrix = np.array([[0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1], [-1, 0, 0, 0.0]])
    values, vectors = np.linalg.eig(matrix.T)
    away = vectors[:, np.argmin(values.real)]  # of a stable eigenvalue: no part along it
    middle = int(np.argmax(np.abs(orbit["v"])))
    t, guess = orbit["t"][: middle + 1], np.array([orbit[name][: middle + 1] for name in "uvwy"])
    keep = np.append(np.diff(t) > 0, True)
    ends = lambda a, b: [away.real @ a, away.imag @ a, b[0], b[2]]  # noqa: E731
    found = solve_bvp(lambda _, z: [z[1], z[2], z[3], z[0] ** 3 - z[0]], ends, t[keep], guess[:, keep], tol=1e-6)
    assert found.success
    assert abs(found.y[1, -1]) == pytest.approx(abs(point["values"]["v.min"]), rel=1e-6)


@pytest.mark.seldom
def test_three_pulses_are_those_of_another_solver():
    """kdv3 at b = 0, by scipy's collocation: from the unstable eigenspace of rest to p = r = 0 in the middle pulse."""
    (wave,) = result_of("kdv3")["branches"]
    assert {end["reason"] for end in wave["ends"]} == {"bound"}
    point = next(p for p in wave["points"] if p["type"] == "UZ")
    orbit = {name: np.array(values) for name, values in point["orbit"].items()}
    matrix = np.array([[0, 0, 1, 0], [3, 0, 0, 0], [0, 0, 0, 7.5], [0, -1, 0, 0.0]])
    values, vectors = np.linalg.eig(matrix.T)
    away = vectors[:, np.argmin(values.real)]
    low = orbit["q"] < 0.9 * orbit["q"].min()
    assert np.sum(np.diff(low.astype(int)) == 1) == 3
    middle = int(np.argmin(np.abs(orbit["p"]) + np.abs(orbit["r"]) + 10 * ~low))
    t, guess = orbit["t"][: middle + 1], np.array([orbit[name][: middle + 1] for name in "qprs"])
    keep = np.append(np.diff(t) > 0, True)

    def rates(_, z):
        q, p, r, s = z
        return [r, 1.5 * q**2 + 3 * q - r**2 / 2, 7.5 * s, -p - q * r]

    ends = lambda a, b: [away.real @ a, away.imag @ a, b[1], b[2]]  # noqa: E731
    found = solve_bvp(rates, ends, t[keep], guess[:, keep], tol=1e-6, max_nodes=20000)
    assert found.success
    assert found.y[0, -1] == pytest.approx(orbit["q"][middle], rel=1e-6)
    outer, theirs = int(np.argmin(orbit["q"][: middle // 2])), found.sol(t)[0]
    assert theirs[outer] == pytest.approx(orbit["q"][outer], rel=1e-5)
