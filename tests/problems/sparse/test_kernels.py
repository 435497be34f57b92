"""Kernels of any dimension: sparse problems see what dense ones see."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp

import contin
from contin import api

MULTIPLICITIES = (1, 2, 3, 1, 4)


def uncoupled(sparse: bool, stable: int, turned: int | None = None):
    """u' = (lam - c) u - u^3, or the same in turned coordinates; every c with its multiplicity, and stable states."""
    c = np.concatenate([np.repeat(0.3 * np.arange(1, 6), MULTIPLICITIES), np.linspace(4.0, 20.0, stable)])
    n = len(c)
    q = np.eye(n) if turned is None else np.linalg.qr(np.random.default_rng(turned).normal(size=(n, n)))[0]

    def residual(u, p):
        x = q.T @ u
        return q @ ((p["lam"] - c) * x - x**3)

    def jacobian(u, p):
        x = q.T @ u
        matrix = (q * (p["lam"] - c - 3 * x**2)) @ q.T
        return sp.csc_matrix(matrix) if sparse else matrix

    return contin.FunctionProblem(residual, np.zeros(n), {"lam": 0.0}, jacobian)


@pytest.mark.parametrize(("stable", "turned"), [pytest.param(5, None, marks=pytest.mark.long), (40, None), (20, 3)])
def test_every_multiplicity_is_seen_at_its_place(stable, turned):
    line = api.continuation(uncoupled(True, stable, turned), "lam", (0.0, 1.7))
    assert [point.type for point in line.points] == ["BP"] * len(MULTIPLICITIES)
    assert tuple(point.vectors["kernel"] for point in line.points) == MULTIPLICITIES
    for k, point in enumerate(line.points, 1):
        assert abs(point.values["lam"] - 0.3 * k) <= max(1e-12, 3 * point.error)


def test_branches_and_normal_form_of_a_double_point_are_those_of_the_dense_problem():
    points = [api.continuation(uncoupled(sparse, 5), "lam", (0.0, 0.7))["BP2"] for sparse in (False, True)]
    seeds = [point.switch() for point in points]
    assert len(seeds[1]) == len(seeds[0]) == 4  # along either state, and along both diagonals
    for name in ("kind", "kernel", "scaling", "branches"):
        assert points[1].normal_form[name] == points[0].normal_form[name]
    ends = []
    for family in seeds:
        rows = [api.continuation(seed, "lam", (0.6, 0.7)) for seed in family]
        ends.append(sorted(float(np.abs(row.z[-1][:-1]).max()) for row in rows))
        for row in rows:
            moving = np.abs(row.z[-1][:-1]) > 1e-6
            np.testing.assert_allclose(np.abs(row.z[-1][:-1][moving]), np.sqrt(row.z[-1][-1] - 0.6), rtol=1e-8)
    assert len(ends[0]) == len(ends[1])


def test_the_double_and_simple_modes_of_a_square_are_told_apart():
    """Mittelmann's problem with no flux through the sides: laplace u = 10 (u - lam exp u).

    Constant solutions lam = u exp(-u) lose stability where 10 (u - 1) is an eigenvalue of -laplace.
    """
    m = 12
    h = 1.0 / (m - 1)
    line = sp.diags([np.ones(m - 1), -2 * np.ones(m), np.ones(m - 1)], [-1, 0, 1]).tolil()
    line[0, 0] = line[-1, -1] = -1
    one = sp.identity(m)
    laplace = ((sp.kron(one, line) + sp.kron(line, one)) / h**2).tocsc()
    model = contin.FunctionProblem(
        lambda u, p: laplace @ u - 10 * (u - p["lam"] * np.exp(u)), 0.15 * np.ones(m * m), {"lam": 0.13},
        lambda u, p: (laplace + sp.diags(10 * p["lam"] * np.exp(u) - 10)).tocsc(),
    )  # fmt: skip
    branch = api.continuation(model, "lam", (0.12, 0.4), settings={"steps": 90})
    waves = (2 - 2 * np.cos(np.pi * np.arange(3) / m)) / h**2
    expected = [(waves[1], 2), (2 * waves[1], 1)]
    found = [point for point in branch.points if point.type == "BP"]
    assert [point.vectors["kernel"] for point in found] == [k for _, k in expected]
    for point, (eigenvalue, _) in zip(found, expected, strict=True):
        u = 1 + eigenvalue / 10
        assert abs(point.values["lam"] - u * np.exp(-u)) <= max(1e-10, 3 * point.error)
