"""Guesses that are put together from known solutions lead deflated Newton to what is connected to nothing."""

import numpy as np
from scipy.linalg import solve_banded

from contin.search.deflated_newton import SHORT, beside, is_new
from contin.search.guesses import images, with_window

EPS, NODES = 0.1, 199


def correction(u):
    """Newton's step for Carrier's problem, eps^2 y'' + 2 (1 - x^2) y + y^2 = 1, y(-1) = y(1) = 0, by differences."""
    h = 2.0 / (NODES + 1)
    x = -1.0 + h * np.arange(1, NODES + 1)
    bend, y = (EPS / h) ** 2, np.concatenate(([0.0], u, [0.0]))
    rest = bend * (y[2:] - 2 * u + y[:-2]) + 2 * (1 - x**2) * u + u**2 - 1
    band = np.full((3, NODES), bend)
    band[1] = -2 * bend + 2 * (1 - x**2) + 2 * u
    return solve_banded((1, 1), band, -rest)


def test_all_sixteen_solutions_of_carriers_problem_are_found_from_one_of_them():
    # two for large eps, two more at each pitchfork eps = 0.472537/n, n = 1, 2, ..., and at each fold
    # 0.472537/(n - 0.8344/n), n = 2, 3, ... (Chapman and Farrell 2017): at 0.1 that is 2 + 2*4 + 2*3. Shooting from
    # x = -1 in extended precision, whose curve of (y, y') at x = 0 meets its mirror image in the solutions, counts the
    # same 16 (and 6, 8, 24, 36 at 0.25, 0.2, 0.07, 0.05)
    size, rng = np.sqrt(NODES), np.random.default_rng(1)
    x = np.linspace(-1.0, 1.0, NODES + 2)[1:-1]
    known = [beside(correction, x**2 - 1, [], size)]
    for _ in range(1500):
        u = beside(correction, with_window(known, size, rng), known, size, SHORT)
        for guess in [] if u is None else [u, *images(u)]:
            v = beside(correction, guess, known, size, SHORT)
            known += [] if v is None else [v]
        if len(known) >= 16:
            break
    assert len(known) == 16
    assert all(is_new(u, known[:k], size) for k, u in enumerate(known))


def test_images_are_those_under_reversal_and_change_of_sign():
    a, b, c = images(np.array([1.0, 2.0, 3.0]))
    np.testing.assert_array_equal([a, b, c], [[3, 2, 1], [-1, -2, -3], [-3, -2, -1]])
