"""What a user's function is asked before it is trusted, and where its derivatives are not those of the curve."""

import warnings

import numpy as np
import pytest
import scipy.sparse as sp

import contin
from contin.errors import InputWarning, UserFunctionError


def parabola(u, p):
    return np.array([p["a"] - u[0] ** 2, u[1] - u[0]])


def slopes(u, p):
    return np.array([[-2 * u[0], 0.0], [-1.0, 1.0]])


def followed(function, u0, a, low, high, **options):
    problem = contin.FunctionProblem(function, u0, {"a": a}, **options)
    return contin.continuation(contin.equilibrium(problem), "a", (low, high))


def test_a_right_jacobian_passes_and_a_wrong_entry_is_named():
    assert [p.label for p in followed(parabola, [1.0, 1.0], 1.0, -1, 2, jacobian=slopes).points] == ["LP1"]
    with pytest.raises(UserFunctionError, match=r"jacobian is not the derivative.*dF\[0\]/du\[0\] is -1\.0"):
        followed(parabola, [1.0, 1.0], 1.0, -1, 2, jacobian=lambda u, p: slopes(u, p) * [[0.5, 1], [1, 1]])


@pytest.mark.parametrize("kind", ["csr_array", "csc_matrix"])
def test_a_wrong_sparse_jacobian_is_told(kind):
    import scipy.sparse

    n = 30
    made = getattr(scipy.sparse, kind)
    with pytest.raises(UserFunctionError, match=r"dF\[\d+\]/du\[\d+\] is -6"):
        followed(
            lambda u, p: p["a"] - u**3, np.ones(n), 1.0, 0, 2,
            jacobian=lambda u, p: made(scipy.sparse.diags(-6 * u**2)),
        )  # fmt: skip


def test_a_wrong_linear_operator_is_told():
    from scipy.sparse.linalg import LinearOperator

    n = 30

    def operator(factor):
        def jacobian(u, p):
            return LinearOperator((n, n), matvec=lambda v: factor * u**2 * np.ravel(v), dtype=float)

        return jacobian

    def made(factor):
        return contin.FunctionProblem(lambda u, p: p["a"] - u**3, np.ones(n), {"a": 1.0}, jacobian=operator(factor))

    assert made(-3.0).method == "matrix-free"
    contin.equilibrium(made(-3.0))
    with pytest.raises(UserFunctionError, match=r"jacobian is not the derivative.*dF\[\d+\]/du\[\d+\] is -6"):
        contin.equilibrium(made(-6.0))


@pytest.mark.parametrize("analytic", [True, False])
def test_a_pattern_that_leaves_entries_out_is_told(analytic):
    import scipy.sparse

    n = 40
    band = scipy.sparse.diags([np.ones(n - 1), np.ones(n), np.ones(n - 1)], [-1, 0, 1]).tocsr()

    def f(u, p):
        u = u if analytic else np.real(u)
        return p["a"] * np.ones(n) - u**3 + 0.1 * (np.roll(u, 1) + np.roll(u, -1) - 2 * u)

    ring = band.tolil()
    ring[0, n - 1] = ring[n - 1, 0] = 1.0
    full = scipy.sparse.csr_array(np.ones((n, n)))
    for right in (ring, full):
        contin.equilibrium(contin.FunctionProblem(f, np.ones(n), {"a": 1.0}, sparsity=right))
    with pytest.raises(UserFunctionError, match=r"`sparsity` is not the pattern.*\((39, 0|0, 39)\) is not in it"):
        contin.equilibrium(contin.FunctionProblem(f, np.ones(n), {"a": 1.0}, sparsity=band))


def test_a_wrong_parameter_jacobian_is_told():
    with pytest.raises(UserFunctionError, match=r"dF\[0\]/da is -1, and differences give 1"):
        followed(
            parabola, [1.0, 1.0], 1.0, -1, 2, jacobian=slopes,
            parameter_jacobian=lambda u, p, name: np.array([-1.0, 0.0]),
        )  # fmt: skip


@pytest.mark.parametrize("scale", [1e-8, 1.0, 1e8])
def test_right_derivatives_pass_at_every_scale_and_beside_kinks(scale):
    def f(u, p):
        return np.array([scale * (p["a"] - u[0] / scale - 0.1 * abs(u[0] / scale - 1.0))])

    def jacobian(u, p):
        return np.array([[-1.0 - 0.1 * np.sign(u[0] / scale - 1.0)]])

    problem = contin.FunctionProblem(f, [scale], {"a": 1.0}, jacobian=jacobian, typical=scale)
    assert contin.equilibrium(problem).u == pytest.approx([scale], rel=1e-12)  # at the kink


def test_complex_results_are_an_error_and_say_so():
    with pytest.raises(UserFunctionError, match="complex number"):
        followed(lambda u, p: np.array([p["a"] - u[0] ** 2 + 1e-3j]), [1.0], 1.0, -1, 2)


def test_a_residual_that_becomes_complex_on_the_way_ends_the_branch_in_words():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        branch = followed(
            lambda u, p: np.array([p["a"] - u[0] * np.emath.sqrt(u[0] - 0.1)]), [1.0], np.sqrt(0.9), -0.5, 2
        )
    assert "complex number" in branch.ends[0].text


@pytest.mark.parametrize("cast", [np.float32, lambda x: np.float32(x).astype(float)])
def test_float32_is_named(cast):
    with pytest.raises(UserFunctionError, match="float32"):
        followed(lambda u, p: cast(np.real(p["a"] - u**2)), [1.0], 1.0, -1, 2)


def test_whole_numbers_are_not_taken_for_float32():
    followed(lambda u, p: np.array([p["a"] - u[0], 0.0 * u[1] - 3 * (u[1] - 1)]), [1.0, 1.0], 1.0, 0, 2)


def test_numpy_warnings_of_a_function_do_not_reach_the_user():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        branch = followed(
            lambda u, p: np.array([p["a"] - np.log(u[0])]), [1.0], 0.0, -3, 2, jacobian=lambda u, p: [[-1 / u[0]]]
        )
    assert [end.reason for end in branch.ends] == ["bound", "bound"]


def test_where_complex_steps_fail_on_the_way_differences_are_taken_with_a_warning():
    def f(u, p):  # a = u^2, followed from u = 0.5; the cast is met at u = 1
        return np.array([p["a"] - (u[0] ** 2 if np.real(u[0]) < 1 else np.real(u[0]) ** 2)])

    with pytest.warns(InputWarning, match="complex step"):
        branch = followed(f, [0.5], 0.25, 0.1, 3)
    assert [end.reason for end in branch.ends] == ["bound", "bound"]
    np.testing.assert_allclose(branch.columns["u0"] ** 2, branch.columns["a"], rtol=1e-8)
    assert branch.points == ()


@pytest.mark.parametrize("size", [1.0, 1e-3, 1e3])
def test_smooth_folds_are_folds(size):
    def f(u, p):
        x = u[0] / size
        return np.array([p["a"] - x**2 - 0.3 * x**3])

    branch = followed(f, [size], 1.3, -1, 2, typical=size)
    x = -2.0 / 0.9  # the other place where 2 x + 0.9 x^2 = 0
    found = sorted(point.values["a"] for point in branch.points if point.type == "LP")
    assert found == pytest.approx([0.0, x**2 + 0.3 * x**3], abs=1e-9)


def turning(function, at, tangent):
    """What the check says of a point of the curve function(u, a) = 0."""
    from contin.problems.dense_march import dense_linearisation
    from contin.problems.turning_at_folds import no_fold

    def residual(z):
        return np.array([function(*z)])

    h = 1e-3  # as across a kink: slopes of wide differences
    z = np.array(at)
    steps = np.eye(2) * h
    jacobian = np.column_stack([(residual(z + e) - residual(z - e)) / (2 * h) for e in steps])
    here = dense_linearisation(residual(z), jacobian, np.array(tangent), np.ones(2))
    return no_fold(residual, here, z, np.ones(2))


def test_corners_and_passages_are_told_from_folds():
    assert turning(lambda u, a: a - u**2, [0.0, 0.0], [1.0, 0.0]) is None
    assert turning(lambda u, a: a - u**2 - 3 * u**3, [0.0, 0.0], [1.0, 0.0]) is None
    assert "corner" in turning(lambda u, a: a - abs(u), [0.0, 0.0], [1.0, 0.0])
    assert "does not turn" in turning(lambda u, a: a - u**3 - 0.3 * u, [0.0, 0.0], [1.0, 0.3])


CORNERS = {  # F(u, a), where the corner is (u, a), and a start
    "at zero": (lambda u, a: a - abs(u), (0.0, 0.0), (1.0, 1.0)),
    "beside zero": (lambda u, a: a - abs(u - 0.3) - u**2, (0.3, 0.09), (1.0, 1.7)),
    "steep": (lambda u, a: a - 10 * abs(u - 0.4), (0.4, 0.0), (0.5, 1.0)),
}


@pytest.mark.parametrize("what", CORNERS)
@pytest.mark.parametrize("given", [False, True])
def test_a_branch_turns_at_a_corner_in_few_steps_with_its_place_and_no_fold(what, given):
    f, (u_c, a_c), (u_0, a_0) = CORNERS[what]
    calls = [0]

    def residual(u, p):
        calls[0] += 1
        return np.array([f(u[0], p["a"]), 0.5 * u[0] - u[1]])

    def jacobian(u, p):
        h = np.copysign(1e-9, u[0] - u_c)  # away from the corner
        slope = (f(u[0] + h, p["a"]) - f(u[0], p["a"])) / h
        return np.array([[slope, 0.0], [0.5, -1.0]])

    branch = followed(residual, [u_0, u_0 / 2], a_0, -1, 2, **({"jacobian": jacobian} if given else {}))
    assert [end.reason for end in branch.ends] == ["bound", "bound"]
    np.testing.assert_allclose(
        [f(*row) for row in zip(branch.columns["u0"], branch.columns["a"], strict=True)], 0, atol=1e-5
    )
    assert min(branch.columns["u0"]) < u_c < max(branch.columns["u0"])
    assert not branch.points
    assert len(branch.columns["a"]) < 300
    assert calls[0] < 60_000
    note = next(text for text in branch.notes if "corner" in text)
    place = float(note.split("near a = ")[1].split(",")[0].split(" ")[0])
    assert abs(place - a_c) < 1e-5


def test_a_small_term_beside_large_ones_is_not_judged_by_rounding():
    n = 400
    rows = np.arange(n)

    def residual(u, p):
        return 1e3 * (np.roll(u, 1) - 2.0 * u + np.roll(u, -1)) + p["r"] * u - p["c"] * u**5

    def jacobian(u, p):
        middle = sp.csc_matrix((p["r"] - 5.0 * p["c"] * u**4 - 2e3, (rows, rows)), shape=(n, n))
        ahead = sp.csc_matrix((np.full(n, 1e3), (rows, (rows + 1) % n)), shape=(n, n))
        return (middle + ahead + ahead.T).tocsc()

    slopes = {"r": lambda u: u, "c": lambda u: -(u**5)}
    for sign, told in ((1.0, None), (-1.0, "dF.*/dr is")):
        problem = contin.FunctionProblem(
            residual, np.zeros(n), {"r": 0.5, "c": 1.0}, jacobian, parameter_jacobian=lambda u, p, name, sign=sign: (
                sign * slopes[name](u)
            ),
        )  # fmt: skip
        if told is None:
            contin.equilibrium(problem)
        else:
            with pytest.raises(contin.ContinError, match=told):
                contin.equilibrium(problem)
