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
@pytest.mark.seldom
def test_every_multiplicity_is_seen_at_its_place(stable, turned):
    line = api.continuation(uncoupled(True, stable, turned), "lam", (0.0, 1.7))
    assert [point.type for point in line.points] == ["BP"] * len(MULTIPLICITIES)
    assert tuple(point.vectors["kernel"] for point in line.points) == MULTIPLICITIES
    for k, point in enumerate(line.points, 1):
        assert abs(point.values["lam"] - 0.3 * k) <= max(1e-12, 3 * point.error)


@pytest.mark.seldom
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


@pytest.mark.seldom
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


def skewed(seed, kernel, sparse):
    """x' = (c + lam) x + .3 lam D x + B(x, x) - x^3 with `kernel` zeros in c, in skewed coordinates of unlike units."""
    g = np.random.default_rng(seed)
    n = kernel + 2
    turned = np.exp(g.uniform(-3, 3, n))[:, None] * (g.normal(size=(n, n)) + 2 * np.eye(n))
    back = np.linalg.inv(turned)
    c = np.append(np.zeros(kernel), -np.linspace(1, 3, n - kernel))
    B, D = 0.3 * g.normal(size=(n, n, n)), 0.2 * g.normal(size=(n, n))
    B = B + B.transpose(0, 2, 1)
    if seed % 2:  # as a reflection of the kernel demands
        B[:kernel, :kernel, :kernel] = 0.0

    def residual(u, p):
        x = back @ u
        return turned @ ((c + p["lam"]) * x + 0.3 * p["lam"] * D @ x + np.einsum("ijk,j,k->i", B, x, x) - x**3)

    def jacobian(u, p):
        x = back @ u
        inner = np.diag(c + p["lam"] - 3 * x**2) + 0.3 * p["lam"] * D + 2 * np.einsum("ijk,k->ij", B, x)
        matrix = turned @ inner @ back
        return sp.csc_matrix(matrix) if sparse else matrix

    return contin.FunctionProblem(residual, np.zeros(n), {"lam": -0.2}, jacobian)


@pytest.mark.parametrize(
    ("seed", "kernel"), [(0, 2), (1, 3), *(pytest.param(s, 2 + s % 3, marks=pytest.mark.long) for s in range(2, 6))]
)
@pytest.mark.seldom
def test_the_reduced_equation_is_that_of_the_dense_problem_but_for_a_rotation_of_the_kernel(seed, kernel):
    """Q is orthonormal in the user's units, <P, Q> = 1: what orthogonal changes of x leave alone must agree.

    Beside the double point of seed 0 the two eigenvalues are a complex pair.
    """
    kept = []
    for sparse in (False, True):
        form = api.continuation(skewed(seed, kernel, sparse), "lam", (-0.2, 0.02))["BP1"].normal_form
        T2, T3 = np.array(form["quadratic"]), np.array(form["cubic"])
        assert T3.shape == (kernel,) * 4
        contracted = np.einsum("aiij->aj", T3)
        mixed = T2[:, :-1, -1]
        sizes = [np.linalg.norm(t) for t in (T2, mixed, T3, contracted)]
        kept.append([*sizes, np.trace(mixed), form["branches"]])
    np.testing.assert_allclose(kept[1], kept[0], rtol=1e-10)


def test_kernels_of_more_dimensions_than_branches_can_be_told_in_are_labels_with_a_note():
    """Twelve cells coupled all to all: 2^11 branches, of which a search from random starts would state some number."""
    n = 12

    def residual(u, p):
        return p["lam"] * u - 0.5 * u.sum() * np.ones(n) + u**2 - u**3

    def jacobian(u, p):
        return p["lam"] * np.eye(n) - 0.5 * np.ones((n, n)) + np.diag(2 * u - 3 * u**2)

    for make in (np.asarray, sp.csc_matrix):
        model = contin.FunctionProblem(
            residual, np.zeros(n), {"lam": -0.2}, lambda u, p, make=make: make(jacobian(u, p))
        )
        branch = api.continuation(model, "lam", (-0.2, 0.1))
        assert [point.vectors["kernel"] for point in branch.points] == [n - 1]
        assert branch["BP1"].normal_form == {"kind": "multiple", "kernel": n - 1}
        assert len(branch.notes) == 1
        assert "not looked for" in branch.notes[0]
        with pytest.raises(contin.ContinError, match="not looked for"):
            branch["BP1"].switch()
