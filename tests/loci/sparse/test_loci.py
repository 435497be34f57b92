"""Curves of folds and Hopf points of large systems: closed forms, and the method of small systems on the same model."""

from functools import cache

import numpy as np
import pytest
import scipy.sparse as sp
import sympy

import contin
from contin.errors import InputError
from tests.loci.equilibria.planes import BOGDANOV_TAKENS, BOX, DOUBLE_HOPF, follow, found, zero_hopf

NEAR = {"p": (-0.8, 0.6), "q": (-0.6, 0.4)}  # about the points of codimension two
WIDE = {"max_step": 0.25}  # of the range: curves are looked at by their labels and closed forms


def laplacian(n):
    return sp.diags_array([np.ones(n - 1), -2 * np.ones(n), np.ones(n - 1)], offsets=[-1, 0, 1]).tocsc() * (n + 1) ** 2


def combustion(n, sparse=True):
    """u'' + lambda exp(u/(1 + e u)) = 0 with u = 0 at both ends: the perturbed Gelfand problem."""
    line = laplacian(n)

    def residual(u, p):
        return line @ u + p["lam"] * np.exp(u / (1 + p["e"] * u))

    def jacobian(u, p):
        s = 1 + p["e"] * u
        matrix = line + sp.diags_array(p["lam"] * np.exp(u / s) / s**2).tocsc()
        return matrix if sparse else matrix.toarray()

    return contin.FunctionProblem(residual, np.zeros(n), {"lam": 0.0, "e": 0.2}, jacobian=jacobian)


def brusselator(m):
    """Two species on an interval of length l, both held at the homogeneous state at the ends; A = 2."""
    line = laplacian(m)
    ends = np.zeros(m)
    ends[[0, -1]] = (m + 1) ** 2

    def residual(w, p):
        u, v = w[:m], w[m:]
        a, b, c = 2.0, p["B"], 1 / p["l"] ** 2
        r = u * u * v
        du = 0.008 * c * (line @ u + a * ends) + a - (b + 1) * u + r
        return np.concatenate([du, 0.004 * c * (line @ v + b / a * ends) + b * u - r])

    def jacobian(w, p):
        u, v, c = w[:m], w[m:], 1 / p["l"] ** 2
        rows = [
            [0.008 * c * line + sp.diags_array(2 * u * v - p["B"] - 1), sp.diags_array(u * u)],
            [sp.diags_array(p["B"] - 2 * u * v), 0.004 * c * line - sp.diags_array(u * u)],
        ]
        return sp.block_array(rows, format="csc")

    start = np.concatenate([np.full(m, 2.0), np.full(m, 2.5)])
    return contin.FunctionProblem(residual, start, {"B": 5.0, "l": 1.0}, jacobian=jacobian)


@cache
def fold_curve(n, sparse):
    line = contin.continuation(combustion(n, sparse), "lam", (0, 6), settings={"stop_at": ("LP",)})
    span = {"lam": (2, 10), "e": (0, 0.4)}
    return contin.continuation(line["LP1"].locus(), ["lam", "e"], span, settings={"stop_at": ("CP",), **WIDE})


@pytest.mark.seldom
def test_the_cusp_of_the_combustion_problem_is_that_of_the_dense_method():
    large, dense = fold_curve(19, True), fold_curve(19, False)
    assert [p.type for p in large.points] == [p.type for p in dense.points] == ["CP"]
    for name in ("lam", "e"):
        assert large["CP1"].values[name] == pytest.approx(dense["CP1"].values[name], abs=1e-10)
    assert large["CP1"].normal_form["c"] == pytest.approx(dense["CP1"].normal_form["c"], rel=1e-5)


@pytest.mark.seldom
def test_the_cusp_of_the_discretised_problem_converges_with_second_order():
    places = [fold_curve(n, True)["CP1"].values["e"] for n in (19, 39, 79)]
    assert (places[1] - places[0]) / (places[2] - places[1]) == pytest.approx(4.0, rel=0.02)


@pytest.mark.seldom
def test_hopf_points_of_the_brusselator_lie_on_their_curve():
    """One half-wave: B = 1 + A^2 + (Dx + Dy) k, k = 4 (m+1)^2 sin^2(pi/(2 (m+1)))/l^2."""
    m = 12
    line = contin.continuation(brusselator(m), "B", (5.0, 6.0), settings={"stop_at": ("HB",)})
    span = {"B": (5, 7), "l": (0.5, 2.0)}
    curve = contin.continuation(line["HB1"].locus(), ["B", "l"], span, settings=WIDE)
    wave = 4 * (m + 1) ** 2 * np.sin(np.pi / 2 / (m + 1)) ** 2 / curve.columns["l"] ** 2
    np.testing.assert_allclose(curve.columns["B"], 5 + 0.012 * wave, rtol=1e-11)
    assert not any(curve.columns["neutral"])
    assert {end.reason for end in curve.ends} == {"bound"}


def as_large(plane):
    """The plane's field in skewed coordinates, as a function with a sparse Jacobian; and its branch in p."""
    n = len(plane.field)
    matrix = np.eye(n) + 0.3 * np.random.default_rng(6).normal(size=(n, n))
    inverse = np.linalg.inv(matrix)
    names = [f"w{k}" for k in range(n)]
    field = sympy.Matrix([sympy.sympify(text.replace("^", "**")) for text in plane.field])
    value = sympy.lambdify([*names, "p", "q"], list(field))
    slope = sympy.lambdify([*names, "p", "q"], field.jacobian(sympy.symbols(names)))

    def residual(x, c):
        return inverse @ np.array(value(*(matrix @ x), c["p"], c["q"]))

    def jacobian(x, c):
        return sp.csc_matrix(inverse @ slope(*(matrix @ x), c["p"], c["q"]) @ matrix)

    start = np.linalg.solve(matrix, np.array(plane.start))
    problem = contin.FunctionProblem(residual, start, dict(plane.at), jacobian=jacobian)
    return contin.continuation(problem, "p", (plane.box or BOX)["p"])


@pytest.mark.parametrize(
    "plane",
    [
        pytest.param(BOGDANOV_TAKENS, marks=pytest.mark.long),
        DOUBLE_HOPF,
        pytest.param(zero_hopf(-1, 0.8), marks=pytest.mark.long),
    ],
    ids=["BT", "HH", "ZH"],
)
@pytest.mark.seldom
def test_points_of_codimension_two_are_those_of_the_extended_systems(plane):
    small, large = plane.line(6), as_large(plane)
    assert [p.type for p in large.points] == [p.type for p in small.points]
    for a, b in zip(large.points, small.points, strict=True):
        ours, theirs = (follow(point, box=NEAR, settings=WIDE) for point in (a, b))
        assert len(found(ours)) == len(found(theirs)) > 0
        for one, other in zip(found(ours), found(theirs), strict=True):
            assert one[0] == other[0]
            np.testing.assert_allclose(one[1:], other[1:], atol=1e-9)


@pytest.mark.seldom
def test_from_bt_to_the_other_curve():
    line = as_large(BOGDANOV_TAKENS)
    folds = follow(line["LP1"], box=NEAR, settings={"stop_at": ("BT",), **WIDE})
    hopf = contin.continuation(folds["BT1"].locus(), ["p", "q"], NEAR, settings=WIDE)
    assert hopf.locus == "HB"
    np.testing.assert_allclose(hopf.columns["p"], 0.0, atol=1e-8)
    assert min(hopf.columns["kappa"]) < 0.0 < max(hopf.columns["kappa"])
    again = contin.continuation(hopf["BT1"].locus(), ["p", "q"], NEAR, settings=WIDE)
    assert again.locus == "LP"
    np.testing.assert_allclose(again.columns["p"], again.columns["q"] ** 2 / 4, atol=1e-8)


def test_branch_points_of_large_systems_say_that_they_have_no_curve():
    problem = contin.FunctionProblem(
        lambda u, p: np.array([p["a"] * u[0] - u[0] ** 3, p["b"] - u[1]]), np.zeros(2), {"a": -1.0, "b": 0.0},
        jacobian=lambda u, p: sp.diags_array(np.array([p["a"] - 3 * u[0] ** 2, -1.0])).tocsc(),
    )  # fmt: skip
    point = contin.continuation(problem, "a", (-1, 1.5))["BP1"]
    with pytest.raises(InputError, match="BP has no curve in two parameters; LP, HB have"):
        contin.continuation(point.locus(), ["a", "b"], {"a": (-1, 1), "b": (-1, 1)})
