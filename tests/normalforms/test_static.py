"""Folds, cusps and simple branch points whose coefficients are known by construction or in closed form."""

import numpy as np
import pytest

import contin
from contin.normalforms.branching import branch_point, simple_directions
from contin.normalforms.fold import cusp, fold
from contin.normalforms.linear import null_pair, solve
from contin.normalforms.reduction import reduce

from .polynomials import PolynomialJet, hide

UNITS = [None, [1e6, 1.0, 1e-6], [1e-4, 1e3, 1.0]]


def signed(t):
    """|t| with the sign that turns t's component of largest modulus positive: x -> u = t x becomes q = t/that."""
    return np.linalg.norm(t) * np.sign(t[np.argmax(np.abs(t))])


def residual(jet, z):
    """F(u0 + du, p0 + dp) of a polynomial jet."""
    return np.array([sum(c * np.prod(z ** np.array(e)) for e, c in f.items()) for f in jet.field])


@pytest.mark.parametrize("units", UNITS)
@pytest.mark.parametrize("kind", ["flow", "map"])
@pytest.mark.parametrize("seed", range(3))
def test_fold_coefficient_survives_a_change_of_coordinates_and_units(seed, kind, units):
    rng = np.random.default_rng(seed)
    a = rng.normal()
    unit = 1.0 if kind == "map" else 0.0
    centre = [{(1,): unit, (2,): a}]
    rates = [0.3, -0.6] if kind == "map" else [-1.0, 0.7]
    jet, T = hide(centre, rates, rng, 2, kind=kind, units=units)
    form = fold(jet)
    # u = T e1 x, w = |T e1| x (up to sign): x' = a x^2 becomes w' = (a / |T e1|) w^2
    assert form.coefficients["a"] == pytest.approx(a / signed(T[:, 0]), rel=1e-8)
    assert np.linalg.norm(form.vectors["q"]) == pytest.approx(1.0, abs=1e-14)
    assert form.words == "fold"


@pytest.mark.parametrize("units", UNITS)
@pytest.mark.parametrize("kind", ["flow", "map"])
@pytest.mark.parametrize("seed", range(3))
def test_cusp_coefficient_survives_a_change_of_coordinates_and_units(seed, kind, units):
    rng = np.random.default_rng(seed)
    c = rng.normal()
    centre = [{(1,): 1.0 if kind == "map" else 0.0, (3,): c}]
    jet, T = hide(centre, [0.3, -0.6] if kind == "map" else [-1.0, 0.7], rng, 3, kind=kind, units=units)
    assert cusp(jet).coefficients["c"] == pytest.approx(c / signed(T[:, 0]) ** 2, rel=1e-6)
    assert "case" not in cusp(jet).coefficients
    assert "cusp" in fold(jet).words  # a = 0 is recognised against its summands


def test_a_cusp_without_a_cubic_coefficient_says_so():
    jet, _ = hide([{(1,): 0.0, (4,): 1.3}], [-1.0, 0.7], np.random.default_rng(1), 4)
    assert cusp(jet).coefficients["case"] == "degenerate"


@pytest.mark.parametrize("units", UNITS)
@pytest.mark.parametrize("kind", ["flow", "map"])
@pytest.mark.parametrize("seed", range(3))
def test_transcritical_coefficients_and_both_branches(seed, kind, units):
    rng = np.random.default_rng(seed)
    b20, b11, a02 = rng.normal(size=3)
    a02 = -a02 * np.sign(a02 * b20)  # real crossing
    centre = [{(1, 0): 1.0 if kind == "map" else 0.0, (2, 0): b20 / 2, (1, 1): b11, (0, 2): a02 / 2}]
    jet, T = hide(centre, [0.3, -0.6] if kind == "map" else [-1.0, 0.7], rng, 3, parameters=1, kind=kind, units=units)
    form = branch_point(jet, state_error=0.0)
    length = signed(T[:, 0])
    got = form.coefficients
    # g = x' in x; w = length x: the quadratic form keeps its discriminant, b20 scales, b11 may shift with x -> x + c dp
    assert got["kind"] == "transcritical"
    assert got["b20"] == pytest.approx(b20 / length, rel=1e-7)
    assert got["discriminant"] == pytest.approx(b11**2 - a02 * b20, rel=1e-6)
    assert abs(got["a01"]) <= 1e-12 * np.abs(jet.form(np.eye(4)[3])).max() * np.abs(form.vectors["p"]).max()


def orders(jet, direction, scale):
    """Observed order of the residual along tangent and curvature."""
    steps = scale / 2.0 ** np.arange(4)
    miss = []
    for s in steps:
        z = direction.predict(s)
        r = residual(jet, z)
        if jet.kind == "map":
            r = r - z[: jet.n]
        miss.append(np.linalg.norm(r))
    return np.polyfit(np.log(steps), np.log(miss), 1)[0]


@pytest.mark.parametrize("kind", ["flow", "map"])
@pytest.mark.parametrize("seed", range(4))
def test_second_order_predictors_of_both_branches_leave_a_residual_of_third_order(seed, kind):
    rng = np.random.default_rng(seed)
    for b20 in (0.0, 0.8):  # pitchfork, transcritical
        centre = [{(1, 0): 1.0 if kind == "map" else 0.0, (2, 0): b20 / 2, (1, 1): 1.3, (3, 0): -0.7}]
        jet, _ = hide(centre, [0.3, -0.6] if kind == "map" else [-1.0, 0.7], rng, 3, parameters=1, kind=kind)
        r = reduce(jet, 1)
        both = simple_directions(r, b20_error=1e-9)
        assert len(both) == 2
        assert [d.vertical for d in both] == [False, b20 == 0.0]
        for direction in both:
            tangent_matrix = np.array([jet.form(e) for e in np.eye(4)]).T - (np.eye(3, 4) if kind == "map" else 0.0)
            np.testing.assert_allclose(tangent_matrix @ direction.tangent, 0.0, atol=1e-12)
            assert orders(jet, direction, 1e-3) == pytest.approx(3.0, abs=0.15)  # F misses at s^3 in the range of A


@pytest.mark.parametrize("units", UNITS)
@pytest.mark.parametrize("kind", ["flow", "map"])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_pitchfork_is_told_from_transcritical_and_its_criticality_from_its_cubic_term(sign, kind, units):
    rng = np.random.default_rng(7)
    b30 = 6.0 * sign
    centre = [{(1, 0): 1.0 if kind == "map" else 0.0, (1, 1): -2.0, (3, 0): b30 / 6}]
    rates = [0.3, 1.6] if kind == "map" else [-1.0, 0.7]
    jet, T = hide(centre, rates, rng, 3, parameters=1, kind=kind, units=units)
    form = branch_point(jet, state_error=0.0)
    assert form.coefficients["kind"] == "pitchfork"
    assert form.coefficients["criticality"] == ("supercritical" if sign < 0 else "subcritical")
    assert form.coefficients["b30"] == pytest.approx(b30 / signed(T[:, 0]) ** 2, rel=1e-5)
    assert abs(form.coefficients["b11"]) == pytest.approx(2.0, rel=1e-6)


def test_known_tangent_chooses_the_primary_branch_even_when_it_is_vertical():
    jet = PolynomialJet([{(1, 1): 1.0, (3, 0): -1.0}], parameters=1)  # x' = p x - x^3
    r = reduce(jet, 1)
    from_side = simple_directions(r, known=np.array([1.0, 0.0]))
    assert [d.vertical for d in from_side] == [True, False]
    np.testing.assert_allclose(from_side[1].tangent, [0.0, 1.0], atol=1e-15)
    np.testing.assert_allclose(from_side[0].curvature, [0.0, 1.0], atol=1e-15)  # p = x^2


def test_an_error_of_the_state_widens_the_uncertainty_of_b20():
    d = 1e-11  # x' = p x - x^3 seen from x = d, where b20 = -6 d
    jet = PolynomialJet([{(1, 1): 1.0, (2, 0): -3 * d, (3, 0): -1.0}], parameters=1)
    assert branch_point(jet, state_error=0.0).coefficients["kind"] == "transcritical"
    assert branch_point(jet).coefficients["kind"] == "pitchfork"


def test_isolated_point_has_no_directions():
    jet = PolynomialJet([{(2, 0): 1.0, (0, 2): 1.0}], parameters=1)
    assert branch_point(jet).coefficients["kind"] == "isolated"
    assert simple_directions(reduce(jet, 1)) == []


def test_a_row_of_rounding_errors_is_not_taken_for_an_equation():
    pair = null_pair(np.array([[-1.0, 0.0], [0.0, 3e-17]]))
    np.testing.assert_allclose(pair.right, [0.0, 1.0], atol=1e-15)


def test_slow_and_fast_equations_leave_the_null_vector_accurate():
    A = np.array([[-1e8, 1e8, 0.0], [1e-3, -2e-3, 1e-3], [0.0, 1.0, -1.0]])  # A (1, 1, 1) = 0
    np.testing.assert_allclose(null_pair(A).right, np.full(3, 3**-0.5), rtol=1e-14)


def test_null_vectors_are_independent_of_units():
    rng = np.random.default_rng(3)
    A = rng.normal(size=(5, 5))
    A[:, 0] = A[:, 1:] @ rng.normal(size=4)
    units = np.array([1e6, 1e-6, 1.0, 1e3, 1e-9])
    q, q_scaled = null_pair(A), null_pair(units[:, None] * A / units)
    back = q_scaled.right / units
    np.testing.assert_allclose(back / np.linalg.norm(back), q.right * np.sign(back @ q.right), rtol=1e-10)
    with pytest.raises(ZeroDivisionError, match="not simple"):
        null_pair(np.array([[0.0, 1.0], [0.0, 0.0]]))


def test_bordered_solve_removes_the_part_outside_the_range():
    rng = np.random.default_rng(4)
    A = rng.normal(size=(4, 4))
    A[2] = A[0] - A[1]
    pair = null_pair(A)
    rhs = rng.normal(size=4)
    x = solve(A, rhs, pair.right[:, None], pair.left[:, None])
    np.testing.assert_allclose(A @ x, rhs - pair.right * (pair.left @ rhs), atol=1e-13)
    assert abs(pair.left @ x) < 1e-13


def test_coefficients_that_vanish_are_zero_to_their_errors():
    """Tumour and immune cells (Kuznetsov 1994): a01 = a02 = 0 where there is no tumour; rounding makes 1e-29 of it."""
    model = contin.Model(
        "tumour", states={"E": 0.3, "T": 0}, parameters={"d": 0.3},
        equations={"E": "0.1181 + 1.131*E*T/(20.19 + T) - 0.00311*E*T - d*E", "T": "1.636*T*(1 - 0.002*T) - E*T"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model, {"E": 0.1181 / 0.3, "T": 0}), "d", (0.01, 1.0))
    form = line["BP1"].normal_form
    assert line["BP1"].values["d"] == pytest.approx(0.1181 / 1.636, rel=1e-12)
    assert form["kind"] == "transcritical"
    for key in ("a01", "a02"):
        assert abs(form[key]) <= form["errors"][key] < 1e-6


def test_errors_of_a_mesh_in_the_row_of_a_null_vector_do_not_hide_it():
    """Couplings of 1e-10 beside an eigenvalue of 1e-14, which equilibration would make large; a decoupled state."""
    matrix = np.array([[2.0, 0.0, 0.0], [0.0, -7e-15, 2.5e-10], [0.0, -2.9e-10, 0.998]])
    pair = null_pair(matrix, -1.0, np.ones(3))
    np.testing.assert_allclose(np.abs(pair.right), [0, 1, 0], atol=1e-9)
    np.testing.assert_allclose(np.abs(pair.left), [0, 1, 0], atol=1e-9)
    assert pair.singular < 1e-12
