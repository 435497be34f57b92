"""Large systems: folds, Hopf and branch points against closed forms."""

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.optimize import brentq
from scipy.sparse.linalg import eigs, splu

import contin
from contin import api
from contin.errors import InputError, NoSolutionError
from contin.linalg.followed import followed
from contin.linalg.linear import KrylovLinear


@pytest.fixture(params=["factors of every point", "factors of earlier points"])
def factored(request, monkeypatch):
    """Both ways in which large matrices are solved with, whatever their size."""
    if request.param == "factors of earlier points":
        monkeypatch.setattr("contin.problems.sparse.jacobian.ALWAYS_FACTORED", 0)
        monkeypatch.setattr("contin.linalg.factor.Factoriser.is_band_for", lambda self, matrix: False)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.seldom
def test_unstable_states_are_counted_from_the_first_point_on(seed, factored):
    """Matrices of no symmetry in their pattern, with fast unstable pairs beside slow stable states."""
    generator = np.random.default_rng(seed)
    n = 90
    pairs = [np.array([[0.5, w], [-w, 0.5]]) for w in (8.0, 11.0, 15.0)]
    blocks = sp.block_diag([*pairs, sp.diags(-np.linspace(0.2, 2.0, n - 6))])
    upper = sp.triu(sp.random(n, n, density=0.02, random_state=generator), 1)  # feeds forward: eigenvalues stay
    couplings = sp.block_diag([sp.csc_matrix((6, 6)), upper.tocsc()[6:, 6:]])
    matrix = sp.csc_matrix(blocks + couplings)
    problem = contin.FunctionProblem(
        lambda u, p: matrix @ u + p["p"] - 0.01 * u**3, np.zeros(n), {"p": 0.0},
        lambda u, p: (matrix - sp.diags(0.03 * u**2)).tocsc(),
    )  # fmt: skip
    line = api.continuation(problem, "p", (-0.05, 0.05), settings={"steps": 3})
    assert line.columns["unstable"].tolist() == [6] * len(line)
    assert not line.points
    assert not line.notes


# Bratu: u'' + p exp(u) = 0, u(0) = u(1) = 0 -------------------------------------------------------------------------


def bratu_fold():
    """p = 8 (s / cosh s)^2 where s tanh s = 1: 3.513830719125..."""
    s = brentq(lambda s: s * np.tanh(s) - 1.0, 1.0, 2.0, xtol=1e-15)
    return 8.0 * (s / np.cosh(s)) ** 2


def bratu(n, **given):
    h = 1.0 / (n + 1)
    pattern = sp.diags([np.ones(n - 1), -2 * np.ones(n), np.ones(n - 1)], [-1, 0, 1], format="csc") / h**2
    diagonal = np.flatnonzero(pattern.indices == np.repeat(np.arange(n), np.diff(pattern.indptr)))

    def residual(u, p):
        value = p["p"] * np.exp(u) - 2.0 * u / h**2
        value[1:] += u[:-1] / h**2
        value[:-1] += u[1:] / h**2
        return value

    def jacobian(u, p):
        matrix = pattern.copy()
        matrix.data[diagonal] += p["p"] * np.exp(u)
        return matrix

    ways = {
        "sparse": {"jacobian": jacobian},
        "coloured": {"sparsity": pattern},
        "matrix-free": {
            "jacobian": lambda u, p: sp.linalg.aslinearoperator(jacobian(u, p)),
            "preconditioner": lambda u, p: sp.linalg.splu(pattern).solve,
        },
        "products": {"preconditioner": lambda u, p: sp.linalg.splu(pattern).solve},
    }
    return contin.FunctionProblem(residual, np.zeros(n), {"p": 0.0}, **ways[given.get("way", "sparse")])


@pytest.mark.parametrize("way", ["sparse", "coloured", "matrix-free", "products"])
def test_bratu_fold_is_that_of_the_discretised_problem(way):
    n = 150
    problem = bratu(n, way=way)
    assert problem.method == ("sparse" if way in ("sparse", "coloured") else "matrix-free")
    branch = api.continuation(problem, "p", (0.0, 4.0), direction="up", settings={"steps": 46})
    assert [point.type for point in branch.points] == ["LP"]
    fold = branch["LP1"]
    h = 1.0 / (n + 1)
    assert fold.values["p"] == pytest.approx(bratu_fold() - 1.83 * h**2, abs=2e-3 * 1.83 * h**2 + 1e-9)
    assert fold.error < 1e-7
    assert (branch.columns["unstable"][0], branch.columns["unstable"][-1]) == (0, 1)


def test_the_fold_converges_with_second_order_and_the_dense_method_agrees():
    values = []
    to_fold = {"stop_at": ("LP",)}
    for n in (50, 100, 200):
        branch = api.continuation(bratu(n), "p", (0.0, 4.0), direction="up", settings=to_fold)
        values.append(branch["LP1"].values["p"])
        if n == 50:
            problem = bratu(n)
            dense = contin.FunctionProblem(
                problem.residual, np.zeros(n), {"p": 0.0}, lambda u, p, given=problem.jacobian: given(u, p).toarray()
            )
            reference = api.continuation(dense, "p", (0.0, 4.0), direction="up", settings=to_fold)["LP1"]
            assert values[0] == pytest.approx(reference.values["p"], abs=1e-11)
            ours = branch["LP1"].normal_form["a"]
            assert abs(ours) == pytest.approx(abs(reference.normal_form["a"]), rel=1e-6)
    errors = bratu_fold() - np.array(values)
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.05)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(2.0, abs=0.05)


def test_ten_thousand_unknowns_take_few_factorisations():
    problem = bratu(10_000)
    calls = 0
    given = problem.jacobian

    def counted(u, p):
        nonlocal calls
        calls += 1
        return given(u, p)

    problem.jacobian = counted
    branch = api.continuation(problem, "p", (0.0, 4.0), direction="up", settings={"steps": 42})
    assert branch["LP1"].values["p"] == pytest.approx(bratu_fold() - 1.83e-8, abs=5e-9)
    assert calls < 4 * branch.steps


# Brusselator on an interval: Hopf points in closed form --------------------------------------------------------------


def brusselator(n, **given):
    """X' = D1/L^2 X'' + X^2 Y - (B + 1) X + A, Y' = D2/L^2 Y'' - X^2 Y + B X, held at (A, B/A) on both ends."""
    h, d1, d2, a, b = 1.0 / (n + 1), 0.008, 0.004, 2.0, 5.45

    def laplacian(x, end):
        value = -2.0 * x
        value[1:] += x[:-1]
        value[:-1] += x[1:]
        value[0] += end
        value[-1] += end
        return value / h**2

    def residual(u, p):
        x, y, s = u[0::2], u[1::2], p["L"] ** 2
        value = np.empty_like(u)
        value[0::2] = d1 / s * laplacian(x, a) + x * x * y - (b + 1) * x + a
        value[1::2] = d2 / s * laplacian(y, b / a) - x * x * y + b * x
        return value

    u0 = np.tile([a, b / a], n)
    neighbours = sp.diags([np.ones(n - 1), np.ones(n), np.ones(n - 1)], [-1, 0, 1])
    pattern = sp.kron(neighbours, sp.identity(2)) + sp.kron(sp.identity(n), np.ones((2, 2)))
    exact = [np.sqrt((d1 + d2) * 4 / h**2 * np.sin(k * np.pi * h / 2) ** 2 / (b - 1 - a**2)) for k in (1, 2, 3)]
    return contin.FunctionProblem(residual, u0, {"L": 0.4}, sparsity=pattern), exact


def test_brusselator_hopf_points_are_at_their_closed_form():
    problem, exact = brusselator(500)  # 1000 unknowns
    branch = api.continuation(problem, "L", (0.4, 1.2), direction="up")
    assert [point.type for point in branch.points] == ["HB", "HB"]
    for point, value in zip(branch.points, exact, strict=False):
        assert abs(point.values["L"] - value) <= max(point.error, 1e-14)
        assert point.error < 1e-7
        assert point.normal_form["omega"] == pytest.approx(2.1395092895, abs=1e-8)
        assert point.normal_form["criticality"] == "supercritical"
    assert [point.values["unstable"] for point in branch.points] == [0, 2]
    assert branch.steps < 40


def test_hopf_normal_form_is_that_of_the_dense_method():
    large, _ = brusselator(12)
    dense = contin.FunctionProblem(large.residual, large.u0, {"L": 0.4})
    ours = api.continuation(large, "L", (0.4, 0.8), direction="up")["HB1"]
    reference = api.continuation(dense, "L", (0.4, 0.8), direction="up")["HB1"]
    assert ours.values["L"] == pytest.approx(reference.values["L"], abs=1e-11)
    np.testing.assert_allclose(ours.normal_form["c1"], reference.normal_form["c1"], rtol=1e-6)


# branch points: u'' + p (u - u^3) = 0 --------------------------------------------------------------------------------


def chafee_infante(n, dense=False, quadratic=0.0):
    """Branch points of the rest state at p = 4/h^2 sin^2(k pi h/2)."""
    h = 1.0 / (n + 1)
    laplacian = sp.diags([np.ones(n - 1), -2 * np.ones(n), np.ones(n - 1)], [-1, 0, 1], format="csc") / h**2

    def residual(u, p):
        return laplacian @ u + p["p"] * (u + quadratic * u**2 - u**3)

    def jacobian(u, p):
        matrix = (laplacian + sp.diags(p["p"] * (1 + 2 * quadratic * u - 3 * u**2))).tocsc()
        return matrix.toarray() if dense else matrix

    exact = [4 / h**2 * np.sin(k * np.pi * h / 2) ** 2 for k in (1, 2, 3)]
    symmetries = None if quadratic else {"flip": lambda u: -u}
    return contin.FunctionProblem(residual, np.zeros(n), {"p": 1.0}, jacobian, symmetries=symmetries), exact


@pytest.mark.seldom
def test_pitchforks_and_switched_branches(factored):
    problem, exact = chafee_infante(300)
    line = api.continuation(problem, "p", (1.0, 60.0), direction="up")
    assert [point.type for point in line.points] == ["BP", "BP"]
    for point, value in zip(line.points, exact, strict=False):
        assert abs(point.values["p"] - value) <= max(point.error, 1e-12)
        assert point.normal_form["kind"] == "pitchfork"
        assert point.normal_form["criticality"] == "supercritical"
        assert point.normal_form["b11"] == pytest.approx(1.0, abs=1e-9)
    fork = api.continuation(line["BP1"].switch(), "p", (1.0, 60.0))
    assert fork.symmetries == ("flip",)
    assert fork.points == ()
    assert np.all(fork.columns["stable"][1:])
    assert fork.columns["max"][-1] == pytest.approx(1.0, abs=0.1)
    diagram = api.diagram(problem, "p", (1.0, 60.0))
    assert len(diagram) == 5  # rest, two branches and their mirror images


@pytest.mark.seldom
def test_branch_point_coefficients_are_those_of_the_dense_method():
    first = {"stop_at": ("BP",)}
    for quadratic in (0.0, 0.5):
        large, _ = chafee_infante(30, quadratic=quadratic)
        dense, _ = chafee_infante(30, dense=True, quadratic=quadratic)
        ours = api.continuation(large, "p", (1.0, 20.0), direction="up", settings=first)["BP1"]
        reference = api.continuation(dense, "p", (1.0, 20.0), direction="up", settings=first)["BP1"]
        assert ours.values["p"] == pytest.approx(reference.values["p"], abs=1e-10)
        assert ours.normal_form["kind"] == reference.normal_form["kind"]
        assert ours.normal_form["kind"] == ("transcritical" if quadratic else "pitchfork")
        for key in ("a01", "a02", "b11", "b20", "b30"):
            value, expected = ours.normal_form[key], reference.normal_form[key]
            assert abs(value) == pytest.approx(abs(expected), rel=1e-6, abs=1e-7), key


def test_transcritical_branches_cross(factored):
    problem, _ = chafee_infante(100, quadratic=0.5)
    line = api.continuation(api.equilibrium(problem, parameters={"p": 6.0}), "p", (5.0, 15.0))
    cross = api.continuation(line["BP1"].switch(), "p", (5.0, 15.0))
    assert {end.reason for end in cross.ends} == {"bound"}
    assert cross.columns["p"].min() < line["BP1"].values["p"] < cross.columns["p"].max() + 1e-9


# effort, memory, messages --------------------------------------------------------------------------------------------


def test_colours_of_a_grid_are_few():
    from contin.problems.sparse.jacobian import JacobianSource

    n = 20
    grid = sp.diags([1.0, 1.0, 1.0], [-1, 0, 1], shape=(n, n))
    pattern = sp.kron(grid, sp.identity(n)) + sp.kron(sp.identity(n), grid)
    u0 = np.ones(n * n)
    problem = contin.FunctionProblem(lambda u, p: pattern @ np.sin(u) + p["a"], u0, {"a": 1.0}, sparsity=pattern)
    source = JacobianSource(problem.system())
    u = np.random.default_rng(5).normal(size=n * n)
    exact = pattern @ sp.diags(np.cos(u))
    np.testing.assert_allclose(source.matrix(u, np.array([1.0])).toarray(), exact.toarray(), atol=1e-14)
    assert source._pattern[3] <= 9


def test_large_equilibria_say_what_is_missing():
    many = 1001
    with pytest.raises(InputError, match=r"a map of 1001 states with a sparse Jacobian; maps are followed with dense"):
        api.equilibrium(
            contin.FunctionProblem(lambda u, p: u, np.ones(many), {"a": 1.0}, sparsity=sp.identity(many), kind="map")
        )
    never = contin.FunctionProblem(lambda u, p: u**2 + 1.0 + p["a"], np.ones(3), {"a": 1.0}, sparsity=np.eye(3))
    with pytest.raises(NoSolutionError, match=r"no equilibrium found from the start: residual .* Newton steps"):
        api.equilibrium(never)
    wrong = contin.FunctionProblem(lambda u, p: u, np.ones(3), {"a": 1.0}, sparsity=np.eye(4))
    with pytest.raises(InputError, match=r"sparsity must be a matrix of shape \(3, 3\), like dF/du; got \(4, 4\)"):
        api.equilibrium(wrong)


@pytest.mark.parametrize("broken", ["residual", "jacobian", "preconditioner"])
def test_a_function_that_fails_ends_the_branch_with_its_reason(broken):
    def failing(function):
        def guarded(u, p):
            if np.real(p["p"]) > 1.5:
                raise RuntimeError("no data")
            return function(u, p)

        return guarded

    functions = {"residual": lambda u, p: p["p"] - u**2, "jacobian": lambda u, p: sp.diags(-2.0 * u).tocsc()}
    if broken == "preconditioner":  # kept while it serves: it fails where it is applied
        latest = {}

        def products(u, p):
            latest.update(p)
            return sp.linalg.aslinearoperator(sp.diags(-2.0 * u))

        functions["jacobian"] = products
        functions["preconditioner"] = lambda u, p: lambda r: failing(lambda u, p: -r / (2.0 * u))(u, latest)
    else:
        functions[broken] = failing(functions[broken])
    problem = contin.FunctionProblem(u0=np.ones(60), parameters={"p": 1.0}, **functions)
    branch = api.continuation(problem, "p", (0.5, 2.0))
    assert (branch.columns["p"].min(), branch.columns["p"].max()) == (0.5, pytest.approx(1.5, rel=2e-2))
    assert branch.ends[0].reason == "bound"
    assert branch.ends[1].reason == "corrector"
    assert "raised RuntimeError: no data (test_sparse.py, line" in branch.ends[1].text


def test_branches_of_large_systems_count_their_factorisations_and_solves():
    first, second = (api.continuation(bratu(2000), "p", (0.0, 3.0), settings={"steps": k}) for k in (2, 4))
    for line in (first, second):
        assert 0 < line.effort["factorisations"] < line.effort["applications"]
    assert first.effort["applications"] < second.effort["applications"]


def plane_bratu(m):
    """Laplace u + p exp(u) = 0 on the unit square, u = 0 on its boundary, m x m inner nodes."""
    one = sp.diags([1.0, -2.0, 1.0], [-1, 0, 1], shape=(m, m)) * (m + 1.0) * (m + 1.0)
    laplace = (sp.kron(one, sp.identity(m)) + sp.kron(sp.identity(m), one)).tocsc()
    return contin.FunctionProblem(
        lambda u, p: laplace @ u + p["p"] * np.exp(u), np.zeros(m * m), {"p": 0.0},
        lambda u, p: (laplace + sp.diags(p["p"] * np.exp(u))).tocsc(),
    )  # fmt: skip


def test_old_factors_lead_to_the_same_branch_as_factors_of_every_point(monkeypatch):
    settings = {"steps": 22}
    direct = api.continuation(plane_bratu(20), "p", (0.0, 10.0), direction="up", settings=settings)
    monkeypatch.setattr("contin.problems.sparse.jacobian.ALWAYS_FACTORED", 0)
    monkeypatch.setattr("contin.linalg.factor.NARROW", 4)
    lagged = api.continuation(plane_bratu(20), "p", (0.0, 10.0), direction="up", settings=settings)
    assert lagged.effort["factorisations"] < 0.2 * direct.effort["factorisations"]
    assert [point.type for point in lagged.points] == [point.type for point in direct.points] == ["LP"]
    (a,), (b,) = lagged.points, direct.points
    assert abs(a.values["p"] - b.values["p"]) <= a.error + b.error
    for line in (lagged, direct):
        turn = line.points[0].index
        assert np.all(line.columns["unstable"][:turn] == 0)
        assert np.all(line.columns["unstable"][turn + 1 :] == 1)


@pytest.mark.parametrize("skew", [0.0, 30.0])
def test_eigenvalues_are_followed_along_smooth_changes_by_one_application_a_point(skew):
    """Vectors that are roughly wrong at first, and then change smoothly, as along a curve: 5 % of each value and its
    sign hold, near the axis too. (What rough residuals had been worth was believed of smooth ones: 10 % off, and a
    wrong sign.)"""
    n = 40
    d = sp.diags([np.ones(n - 1), -np.ones(n - 1)], [1, -1])
    base = (plane_bratu(n).jacobian(np.zeros(n * n), {"p": 0.0}) + skew * sp.kron(d, sp.identity(n))).tocsc()
    hill = np.exp(-8.0 * np.add.outer(np.linspace(-0.5, 0.6, n) ** 2, np.linspace(-0.4, 0.5, n) ** 2)).ravel()
    inverse, asked = splu(base), []

    def precondition(right):
        asked.append(right.shape[1])
        return 0.8 * inverse.solve(right)

    _, vectors = eigs(base, k=3, sigma=0.0, v0=hill)
    vectors, before, signs = vectors + 1e-4 * np.random.default_rng(1).normal(size=vectors.shape), None, set()
    for height in np.linspace(0.0, 60.0, 25):
        matrix = (base + sp.diags(height * hill)).tocsc()
        operator = KrylovLinear(lambda v, m=matrix: m @ v, lambda r: r)
        found = followed(operator, precondition, 0.3, vectors, before, symmetric=skew == 0.0)
        vectors, before = found.vectors, vectors
        exact = eigs(matrix, k=5, sigma=3.0, v0=hill)[0]
        assert max(np.min(np.abs(exact - value) / np.abs(exact)) for value in found.values) < 0.05
        signs.add(int(np.sum(found.values.real > 0.0)))
    assert len(signs) > 1
    assert sum(asked) <= (1 if skew == 0.0 else 3) * 25 + 3 * 6


def test_places_and_frequencies_of_skewed_sparse_systems_hold_to_rounding():
    # u' = S (C + lam T) S^-1 u - u^3: a real mode and a pair, whose frequency changes with lam, cross at known places
    n, place, born, w = 24, 0.31, 0.47, 1.3
    skew = sp.csc_matrix(sp.diags_array([np.ones(n), 0.8 * np.ones(n - 1)], offsets=[0, -1]))
    inverse = sp.csc_matrix(np.linalg.inv(skew.toarray()))
    turning = sp.csc_matrix(([-1.0, 1.0], ([1, 2], [2, 1])), shape=(n, n))
    decay = np.concatenate(([place, born, born], np.linspace(3.0, 40.0, n - 3)))
    constant = (skew @ (w * turning - sp.diags_array(decay)) @ inverse).tocsc()
    slope = (skew @ (sp.identity(n) + 2.0 * turning) @ inverse).tocsc()
    problem = contin.FunctionProblem(
        lambda u, p: constant @ u + p["lam"] * (slope @ u) - u**3, np.zeros(n), {"lam": 0.0},
        lambda u, p: (constant + p["lam"] * slope - sp.diags_array(3.0 * u**2)).tocsc(),
    )  # fmt: skip
    branch = contin.continuation(problem, "lam", (0, 0.6))
    crossing, hopf = branch.points
    assert (crossing.type, hopf.type) == ("BP", "HB")
    entries = 1e-16 * np.linalg.cond(skew.toarray()) * 40.0  # what forming the matrix leaves
    assert abs(crossing.values["lam"] - place) <= crossing.error + entries
    assert abs(hopf.values["lam"] - born) <= hopf.error + entries
    assert abs(hopf.normal_form["omega"] - (w + 2.0 * born)) <= 2.0 * (hopf.error + entries)
    assert max(crossing.error, hopf.error) < 1e-11
