"""Normal forms beyond dense sizes: the same numbers as by dense methods, and of a planted Bautin point."""

import numpy as np
import pytest
import scipy.sparse as sp

import contin
from contin.loci.sparse import forms
from contin.loci.sparse.large_manifold import LargeJet, LargeManifold, Solves, pair_of
from contin.normalforms.hopf import conjugate, generalised_hopf, generalised_hopf_on
from contin.normalforms.sources import compiled_jet
from contin.problems.sparse.forms import Derivatives

RATE, PUSH, BACK = 0.5, 1.4, 0.2


def bautin(m, q):
    """z' = (p + q s - s^2 + x_0/2 + i (1.4 + 0.3 s)) z, s = |z|^2, beside x' = D x - x + (s + 0.2 Re z x_0) e_0."""
    line = sp.diags_array([np.ones(m - 1), -3 * np.ones(m), np.ones(m - 1)], offsets=[-1, 0, 1]).tocsc()
    first = np.eye(1, m)[0]

    def residual(u, p):
        w, v, x = u[0], u[1], u[2:]
        s = w * w + v * v
        growth, turn = p["p"] + p["q"] * s - s * s + RATE * x[0], PUSH + 0.3 * s
        pair = [growth * w - turn * v, growth * v + turn * w]
        return np.concatenate([pair, line @ x + first * (s + BACK * w * x[0])])

    def jacobian(u, p):
        w, v, x = u[0], u[1], u[2:]
        s = w * w + v * v
        g, r, t = p["p"] + p["q"] * s - s * s + RATE * x[0], 2 * p["q"] - 4 * s, PUSH + 0.3 * s
        top = [
            [g + w * r * w - 0.6 * w * v, w * r * v - t - 0.6 * v * v],
            [v * r * w + t + 0.6 * w * w, g + v * r * v + 0.6 * v * w],
        ]
        right, lower = np.outer([RATE * w, RATE * v], first), np.outer(first, [2 * w + BACK * x[0], 2 * v])
        own = line + sp.diags_array(BACK * w * first)
        return sp.block_array([[sp.csc_matrix(top), sp.csc_matrix(right)], [sp.csc_matrix(lower), own]], format="csc")

    return contin.FunctionProblem(residual, np.zeros(m + 2), {"p": 0.0, "q": q}, jacobian=jacobian)


def test_a_bautin_point_of_many_states_has_the_numbers_of_few():
    """The chain's answer at its end is that of an endless one up to 0.38^(2 m): l2 does not depend on m."""
    q = -RATE * (3 - np.sqrt(5)) / 2  # Re c1 = q + x_0/2, x_0 = (3 - sqrt 5)/2 of |z|^2
    few, many = bautin(30, q), bautin(600, q)
    dense = generalised_hopf(compiled_jet(few.system(), np.zeros(32), np.array([0.0, q])), PUSH)
    problem = contin.equilibrium(many).seed("p").problem
    z = np.zeros(603)
    linear = problem.linear(z)
    start = np.concatenate([[1.0, -0.9j], 0.01 * np.ones(600)])  # the eigenvector to 1.4 i, and something else
    pair = pair_of(linear, 1.39j, start)
    assert abs(pair.value - 1j * PUSH) < 1e-13
    manifold = LargeManifold(LargeJet(Derivatives(problem, z), linear), [pair, conjugate(pair)], Solves(linear))
    large = generalised_hopf_on(manifold, 0.0)
    assert abs(complex(*large.coefficients["c1"]) - 0.6j) < 1e-11
    np.testing.assert_allclose(large.coefficients["l2"], dense.coefficients["l2"], rtol=1e-9)
    np.testing.assert_allclose(large.coefficients["c2"], dense.coefficients["c2"], atol=1e-9)


@pytest.mark.seldom
def test_both_ways_give_the_same_point(monkeypatch):
    start = contin.continuation(bautin(8, 0.0), "p", (-0.1, 0.1), settings={"max_step": 0.5})["HB1"]
    found = []
    for limit in (400, 3):
        monkeypatch.setattr(forms, "DENSE", limit)
        box = {"p": (-1.0, 1.0), "q": (-0.3, 0.1)}
        found.append(contin.continuation(start.locus(), ["p", "q"], box, settings={"stop_at": ("GH",)})["GH1"])
    dense, large = (point.normal_form for point in found)
    assert set(dense) == set(large)
    assert large["l2"] == pytest.approx(dense["l2"], rel=1e-8)
    assert abs(large["l2"] - dense["l2"]) <= large["errors"]["l2"] + dense["errors"]["l2"]
    assert large["errors"]["l2"] < 1e-7
