"""Functions with a dense and with a sparse Jacobian are followed by different methods and must say the same.

Random systems u' = A u + Q(u, u) - u^3/2 + lam (b + d u) + mu c u: with b = 0 the state zero exists everywhere, and
branch points take the place of folds.
"""

import numpy as np
import pytest
import scipy.sparse as sp

import contin


def system(seed, zero, is_sparse):
    generator = np.random.default_rng(seed)
    n = int(generator.integers(3, 13))
    A = (generator.random((n, n)) < 3 / n) * generator.normal(size=(n, n))
    for k in range(0, n - 1, 2):
        frequency = np.exp(generator.uniform(-1, 1))
        A[k, k + 1] += frequency
        A[k + 1, k] -= frequency
    A -= np.diag(generator.uniform(0.2, 2.0, n))
    A -= np.eye(n) * (np.linalg.eigvals(A).real.max() + generator.uniform(0.2, 0.6))
    i, j, k = (generator.integers(n, size=2 * n) for _ in range(3))
    weights = 0.7 * generator.normal(size=2 * n)
    b, d, c = generator.normal(size=(3, n))
    b, d = (0.0 * b, d) if zero else (b, 0.0 * d)

    quadratic = np.zeros((n, 2 * n))
    quadratic[i, np.arange(2 * n)] = weights

    def residual(u, p):
        return A @ u + quadratic @ (u[j] * u[k]) - 0.5 * u**3 + p["lam"] * (b + d * u) + 0.5 * p["mu"] * c * u

    def jacobian(u, p):
        matrix = A + np.diag(-1.5 * u**2 + p["lam"] * d + 0.5 * p["mu"] * c)
        np.add.at(matrix, (i, j), weights * u[k])
        np.add.at(matrix, (i, k), weights * u[j])
        return sp.csc_matrix(matrix) if is_sparse else matrix

    return contin.FunctionProblem(residual, np.zeros(n), {"lam": 0.0, "mu": 0.0}, jacobian)


def assert_alike(dense, large, types=None):
    """Labels, places to their errors, and coefficients (signs of null vectors are free) to theirs."""
    labels = [[p for p in branch.points if types is None or p.type in types] for branch in (dense, large)]
    assert [p.label for p in labels[0]] == [p.label for p in labels[1]]
    for one, other in zip(*labels, strict=True):
        for name in ("lam", "mu"):
            if name in one.values:
                assert abs(one.values[name] - other.values[name]) <= 2 * (one.error + other.error) + 1e-12
        forms = one.normal_form, other.normal_form
        assert set(forms[0]) == set(forms[1]), one.label
        errors = [form.get("errors", {}) for form in forms]
        assert forms[0].get("errors") is None or errors[1], one.label
        for key in [k for k in errors[0] if k in errors[1] and isinstance(forms[0][k], float)]:
            slack = errors[0][key] + errors[1][key] + 1e-13 * abs(forms[0][key])
            assert abs(abs(forms[0][key]) - abs(forms[1][key])) <= slack, (one.label, key)
        for key, value in forms[0].items():
            if isinstance(value, str | int):
                assert forms[1][key] == value, (one.label, key)


@pytest.mark.parametrize(
    "seeds", [(300, 303), pytest.param(range(300, 306), marks=pytest.mark.long)], ids=["few", "more"]
)
@pytest.mark.parametrize("zero", [False, True], ids=["forced", "with a state zero"])
@pytest.mark.seldom
def test_points_of_random_systems_are_those_of_the_dense_methods(zero, seeds):
    seen = set()
    for seed in seeds:
        dense, large = (
            contin.continuation(system(seed, zero, is_sparse), "lam", (-1.5, 1.5), settings={"steps": 200})
            for is_sparse in (False, True)
        )
        assert_alike(dense, large)
        seen |= {p.type for p in dense.points}
    assert seen >= ({"BP", "HB"} if zero else {"LP"})


@pytest.mark.parametrize(
    ("seed", "types", "mu"),
    [
        pytest.param(306, ["BT"], (-1, 1), marks=pytest.mark.long),
        pytest.param(309, ["ZH", "GH"], (-1, 1), marks=pytest.mark.long),
        (309, ["GH"], (-0.02, 0.2)),  # before the ZH point, to which twenty short steps lead
    ],
)
@pytest.mark.seldom
def test_curves_of_hopf_points_of_a_state_zero_are_those_of_the_dense_methods(seed, types, mu):
    """There a curve of branch points takes the place of that of folds, and no parameter unfolds what vanishes at ZH."""
    curves = []
    for is_sparse in (False, True):
        line = contin.continuation(system(seed, True, is_sparse), "lam", (-1.5, 1.5), settings={"steps": 200})
        ranges = {"lam": (-3, 3), "mu": mu}
        settings = {"steps": 40} if mu[1] == 1 else {"step": 0.1, "max_step": 0.5}
        curves.append(contin.continuation(line["HB1"].locus(), ["lam", "mu"], ranges, settings=settings))
    assert_alike(*curves)
    assert [p.type for p in curves[0].points] == types
