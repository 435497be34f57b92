"""Functions whose values are rounded to some digits: how coarse they are, and what labels know of it."""

import numpy as np
import pytest
from scipy import sparse

import contin
from contin.systems.functions.grain import grain
from contin.systems.functions.stencils import differentiated


def rounded(values, step):
    return step * np.round(np.asarray(values) / step)


@pytest.mark.parametrize("step", [1e-7, 1e-8, 1e-10])
@pytest.mark.parametrize("slope", [1.0, 0.37])
def test_grain_of_a_rounded_function_bounds_half_a_step(step, slope):
    found = grain(lambda t: rounded(np.column_stack([slope * t, np.exp(t)]), step))
    assert np.all(found > 0.4 * step)
    assert np.all(found < 3.0 * step)


def test_a_smooth_function_is_no_coarser_than_double_precision_and_a_corner_is_no_grain():
    def values(t):
        return np.column_stack([np.exp(t), np.tanh(1e3 * t), np.abs(t - 3e-5)])

    assert np.all(grain(values) < [1e-15, 1e-12, 1e-15])


def test_the_slope_of_a_rounded_function_at_its_extremum_is_not_that_between_two_steps():
    step = 1e-8
    top = differentiated(lambda t: np.array([rounded(np.cos(t + 1e-4), step)]), 1, 1.0, grain=step)
    assert abs(top[0] + np.sin(1e-4)) < 1e-5  # a step over the width, 2e-3


@pytest.mark.parametrize("shift", [0.3e-8, pytest.param(0.0, marks=pytest.mark.long)])
@pytest.mark.seldom
def test_folds_of_a_rounded_function_are_where_their_errors_say(shift):
    def residual(u, p):  # folds at x = -+1, p = +-2/3
        return rounded([p["p"] + u[0] - u[0] ** 3 / 3 + shift, u[0] ** 2 - u[1]], 1e-8)

    problem = contin.FunctionProblem(residual, [-2.0, 4.0], {"p": -1.0}, states=["x", "y"])
    line = contin.continuation(problem, "p", (-1, 0.8))
    assert [point.type for point in line.points] == ["LP", "LP"]
    for point, sign in zip(line.points, (1.0, -1.0), strict=True):
        off = abs(point.values["p"] + shift - sign * 2 / 3)
        assert off < point.error
        assert 0.5e-8 < point.error < 1e-6


def test_a_hopf_point_of_a_rounded_function_has_the_error_of_its_slopes():
    def residual(u, p):  # Stuart-Landau: at mu = 0
        r2 = u[0] ** 2 + u[1] ** 2
        return rounded([p["mu"] * (u[0] - 0.3) - u[1], u[0] - 0.3 + p["mu"] * u[1] - r2 * u[1]], 1e-9)

    problem = contin.FunctionProblem(residual, [0.3, 0.0], {"mu": -1.0}, states=["x", "y"])
    line = contin.continuation(problem, "mu", (-1, 1))
    point = line["HB1"]
    exact = 0.09 / 2  # trace: 2 mu - x^2 at x = 0.3, y = 0
    assert abs(point.values["mu"] - exact) < point.error
    assert 1e-9 < point.error < 1e-3


@pytest.mark.parametrize("step", [1e-8, 1e-12])
@pytest.mark.seldom
def test_sparse_functions_whose_values_are_rounded_have_labels_within_their_errors(step):
    turned = np.linalg.qr(np.random.default_rng(1).normal(size=(4, 4)))[0] @ np.diag([1.0, 1.7, 2.3, 3.0])
    back = np.linalg.inv(turned)

    def residual(u, p):  # a fold at x = -1, p = 2/3, and a Hopf point at p = 0.31
        x, y, z, w = back @ u
        m, r2 = p["p"] - 0.31, y * y + z * z
        own = [p["p"] + x - x**3 / 3, m * y - 1.3 * z - r2 * y, 1.3 * y + m * z - r2 * z, 0.3 * x * x - 4 * w]
        return rounded(turned @ own, step)

    def slopes(u, p):
        x, y, z, _ = back @ u
        m = p["p"] - 0.31
        rows = np.diag([1 - x * x, m - 3 * y * y - z * z, m - y * y - 3 * z * z, -4.0])
        rows[1, 2], rows[2, 1], rows[3, 0] = -1.3 - 2 * y * z, 1.3 - 2 * y * z, 0.6 * x
        return sparse.csc_matrix(turned @ rows @ back)

    x = -1.879385241571817  # x^3 / 3 - x = -1/3
    start = turned @ [x, 0.0, 0.0, 0.075 * x * x]
    problem = contin.FunctionProblem(residual, start, {"p": 1 / 3}, slopes)
    exact = {"HB": 0.31, "LP": 2 / 3}
    line = contin.continuation(problem, "p", (0.2, 0.8), settings={"stop_at": ["LP"]})
    assert {point.type for point in line.points} == {"HB", "LP"}
    for point in line.points:
        assert abs(point.values["p"] - exact[point.type]) < point.error < 100 * step
