"""Random polynomial systems whose special points are known because they were built backwards; honest errors."""

from itertools import pairwise
from math import prod

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.problems.backwards import hidden
from tests.problems.follow import follow


@pytest.mark.parametrize("type_", ["LP", "BP", "HB"])
@settings(max_examples=6)
@given(n=st.integers(2, 5), spread=st.sampled_from([0, 8, 20]), seed=st.integers(0, 10**6))
def test_hidden_point_is_found_with_its_type_and_the_error_bounds_the_distance(type_, n, spread, seed):
    """The point is exact in binary: p0 = k/32, states in units from 2^-spread to 2^spread, mixed by integers."""
    case = hidden(np.random.default_rng(seed), type_, n, spread)
    branch = follow(case.equations, case.states, case.parameters, case.range)
    near = [p for p in branch.points if abs(p.values["p"] - case.at) < 1e-6]
    assert [p.type for p in near] == [type_], branch.notes
    assert abs(near[0].values["p"] - case.at) <= near[0].error
    assert near[0].error < 1e-10


def random_cubic(rng, n):
    """Coefficients of all monomials of degree <= 3 in (u, p), with F(0, 0) = 0 and F_u(0, 0) stable."""
    from itertools import product

    exponents = [e for e in product(range(4), repeat=n + 1) if 1 <= sum(e) <= 3]
    field = [{e: float(rng.normal()) for e in exponents} for _ in range(n)]
    for i in range(n):
        for j in range(n):
            e = tuple(int(k == j) for k in range(n + 1))
            field[i][e] = 0.5 * field[i][e] - (2.0 if i == j else 0.0)
    return field


def as_text(field, n):
    names = [f"u{j}" for j in range(n)] + ["p"]

    def monomial(e):
        return "*".join(f"{name}^{k}" for name, k in zip(names, e, strict=True) if k)

    return {f"u{i}": " + ".join(f"({c!r})*{monomial(e)}" for e, c in f.items()) for i, f in enumerate(field)}


def derivative(field, j):
    return [{tuple(k - (i == j) for i, k in enumerate(e)): c * e[j] for e, c in f.items() if e[j]} for f in field]


def value(field, z):
    powers = [[1, x, x * x, x * x * x] for x in z]
    return [
        mpmath.fsum(c * prod(row[k] for row, k in zip(powers, e, strict=True) if k) for e, c in f.items())
        for f in field
    ]


def defect(field, n, type_):
    """F and the scalar that vanishes at the point: det F_u (LP), the Hurwitz determinant (HB, n = 2: trace, n = 3)."""
    columns = [derivative(field, j) for j in range(n)]

    def equations(*z):
        a = mpmath.matrix([value(column, z) for column in columns]).T
        if type_ == "LP":
            scalar = mpmath.det(a)
        elif n == 2:
            scalar = a[0, 0] + a[1, 1]
        else:
            trace = sum(a[i, i] for i in range(3))
            minors = sum(a[i, i] * a[j, j] - a[i, j] * a[j, i] for i, j in ((0, 1), (0, 2), (1, 2)))
            scalar = trace * minors - mpmath.det(a)
        return [*value(field, z), scalar]

    return equations


@pytest.mark.seldom
def test_error_estimates_bound_the_true_errors_and_are_not_a_thousand_times_them():
    """Every fold and Hopf point of random cubic systems, against Newton in 50 digits with the same coefficients."""
    ratios = []
    with mpmath.workdps(50):
        for seed in range(8):
            n = 2 + seed % 2
            field = random_cubic(np.random.default_rng(seed), n)
            branch = follow(as_text(field, n), {f"u{j}": 0.0 for j in range(n)}, {"p": 0.0}, (-3.0, 3.0))
            for point in branch.points:
                exact = mpmath.findroot(defect(field, n, point.type), [mpmath.mpf(x) for x in point.z], tol=1e-80)
                error = abs(float(exact[n] - mpmath.mpf(point.values["p"])))
                assert error <= point.error, (seed, point.label, error, point.error)
                ratios.append(point.error / max(error, np.finfo(float).eps * abs(point.values["p"]) / 8))
    assert len(ratios) > 20  # measured 30
    assert max(ratios) < 1000  # measured 47
    assert np.median(ratios) < 50  # measured 6


@pytest.mark.parametrize("seed", range(6))
def test_labels_account_for_every_change_of_stability_and_of_direction(seed):
    """Between labels nothing changes: eigenvalues counted by numpy at every row, and the sense of the parameter."""
    n = 2 + seed % 3
    field = random_cubic(np.random.default_rng(100 + seed), n)
    branch = follow(as_text(field, n), {f"u{j}": 0.0 for j in range(n)}, {"p": 0.0}, (-3.0, 3.0))
    counts = np.array([np.sum(np.linalg.eigvals(branch.problem.linear_part(z)).real > 0) for z in branch.z])
    labelled = {p.index: p for p in branch.points}
    plain = [k for k in range(len(branch)) if k not in labelled]
    for k, m in pairwise(plain):
        between = [labelled[j].type for j in range(k + 1, m)]
        moved, turned = abs(counts[m] - counts[k]), branch.tangents[m][-1] * branch.tangents[k][-1] < 0
        assert moved <= between.count("LP") + 2 * between.count("HB")
        assert (moved - between.count("LP")) % 2 == 0
        assert turned == (between.count("LP") % 2 == 1)
        assert between or moved == 0
    assert (branch.columns["unstable"][plain] == counts[plain]).all()
