"""Branches that nearly meet: the curve stays on its own, however small the gap, and no branch point is invented."""

import numpy as np
import pytest
from scipy.optimize import brentq

from tests.problems.follow import assert_labels, follow, reasons

GAPS = [1e-2, 1e-4, 1e-6, 1e-8, 1e-9, 1e-11]
R = (-1.0, 1.5)


def on_curve(branch, formula):
    x, p = branch.columns["x"], branch.columns["p"]
    return np.abs(formula(x, p)).max()


@pytest.mark.parametrize("gap", GAPS)
@pytest.mark.parametrize("max_step", [0.05, 0.5])
def test_imperfect_pitchfork_connects_rest_to_one_side(gap, max_step):
    """p x - x^3 + g = 0: the branch from x ~ g rises to x ~ sqrt(p) > 0 without a fold."""
    branch = follow({"x": "p*x - x^3 + g"}, {"x": gap}, {"p": -1.0, "g": gap}, R, settings={"max_step": max_step})
    assert_labels(branch, [])
    assert reasons(branch) == ("bound", "bound")
    assert branch.columns["x"].min() > 0
    assert branch.columns["x"][-1] == pytest.approx(np.sqrt(1.5), abs=0.01 * gap + gap)
    assert (np.diff(branch.columns["p"]) > 0).all()


@pytest.mark.parametrize("gap", GAPS)
@pytest.mark.parametrize("max_step", [0.05, 0.5])
def test_the_other_side_of_an_imperfect_pitchfork_has_one_fold(gap, max_step):
    """p = x^2 - g/x for x < 0 has its minimum 3 (g/2)^(2/3) at x = -(g/2)^(1/3)."""
    branch = follow({"x": "p*x - x^3 + g"}, {"x": -1.1}, {"p": 1.21, "g": gap}, R, settings={"max_step": max_step})
    assert_labels(branch, [("LP", 3 * (gap / 2) ** (2 / 3))], rtol=1e-9)
    assert reasons(branch) == ("bound", "bound")
    assert branch.columns["x"].max() < 0
    assert branch["LP1"].values["x"] == pytest.approx(-((gap / 2) ** (1 / 3)), rel=1e-5)


@pytest.mark.parametrize("gap", GAPS)
@pytest.mark.parametrize("max_step", [0.05, 0.5])
def test_imperfect_transcritical_point_turns_or_passes_by_the_sign_of_the_gap(gap, max_step):
    """p x - x^2 + g = 0: for g > 0 two branches pass by, for g < 0 they turn at p = -+2 sqrt(-g)."""
    settings = {"max_step": max_step}
    passing = follow({"x": "p*x - x^2 + g"}, {"x": gap}, {"p": -1.0, "g": gap}, R, settings=settings)
    assert_labels(passing, [])
    assert passing.columns["x"][-1] == pytest.approx(1.5, abs=2 * gap)
    turning = follow({"x": "p*x - x^2 + g"}, {"x": -gap}, {"p": -1.0, "g": -gap}, R, settings=settings)
    assert_labels(turning, [("LP", -2 * np.sqrt(gap))], rtol=1e-9)
    assert turning.columns["p"].max() <= -2 * np.sqrt(gap) * (1 - 1e-9)


@pytest.mark.parametrize("gap", [1e-3, 1e-6, 1e-9])
def test_near_miss_of_a_third_branch_in_two_states(gap):
    """The imperfection sits in the second equation: x' = p x - x^3 + y, y' = g - y."""
    branch = follow({"x": "p*x - x^3 + y", "y": "g - y"}, {"x": -1.1, "y": gap}, {"p": 1.21, "g": gap}, R)
    assert_labels(branch, [("LP", 3 * (gap / 2) ** (2 / 3))], rtol=1e-8)


def test_parallel_branches_are_not_mixed_up():
    """sin(20 (x - p)) = 0: lines x = p + k pi/20, all of one slope; a step must not land on the next one."""
    for max_step in (0.05, 0.3, 1.0):
        branch = follow({"x": "sin(20*(x - p))"}, {"x": 0.0}, {"p": 0.0}, (-3.0, 3.0), settings={"max_step": max_step})
        assert on_curve(branch, lambda x, p: x - p) < 1e-8


@pytest.mark.parametrize(("eps", "q"), [(0.01, 8e-4), (1e-4, 2e-4)])
def test_stiff_oscillator_between_two_hopf_points(eps, q):
    """Two-variable Oregonator (Tyson and Fife 1980): x = z, f = (1 - x)(x + q)/(x - q), HB where the trace vanishes.

    The branch turns a sharp corner at x ~ q, where two branches nearly meet.
    """

    def f(x):
        return (1.0 - x) * (x + q) / (x - q)

    def trace(log_x):
        x = np.exp(log_x)
        return (1.0 - 2.0 * x - f(x) * 2.0 * q * x / (x + q) ** 2) / eps - 1.0

    grid = np.linspace(np.log(1.01 * q), np.log(0.999), 2001)
    values = trace(grid)
    roots = [brentq(trace, grid[k], grid[k + 1], xtol=1e-15) for k in np.flatnonzero(values[:-1] * values[1:] < 0.0)]
    branch = follow(
        {"x": "(x*(1 - x) - f*z*(x - q)/(x + q))/eps", "z": "x - z"}, {"x": 0.8, "z": 0.8},
        {"f": 0.2, "eps": eps, "q": q}, (0.05, 5.0),
    )  # fmt: skip
    assert_labels(branch, [("HB", f(np.exp(r))) for r in sorted(roots, reverse=True)])
