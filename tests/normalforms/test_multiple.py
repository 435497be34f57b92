"""Branch points with two- and three-dimensional kernels: every branch of systems whose solutions are known."""

import numpy as np
import pytest

from contin.normalforms.directions import any_branch_point, branch_directions

from .polynomials import PolynomialJet, add, hide, multiply, scale, variable


def mode(jet, direction, T):
    """Reduced direction x of a vertical branch, from u = T x."""
    x = np.linalg.solve(T, direction.tangent[:-1])
    return x / np.linalg.norm(x)


def squares(size, order=9):
    """p x_j, x_j^3 and x_j |x|^2 as series in (x_1, ..., x_size, p)."""
    total = size + 1
    xs = [variable(j, total) for j in range(size)]
    p = variable(size, total)
    r2 = add(*(multiply(x, x, order) for x in xs))
    linear = [multiply(p, x, order) for x in xs]
    cubes = [multiply(x, multiply(x, x, order), order) for x in xs]
    round_ = [multiply(x, r2, order) for x in xs]
    return linear, cubes, round_


@pytest.mark.parametrize("k", [2, 3])
@pytest.mark.parametrize("seed", range(2))
def test_square_and_cube_symmetry_give_axes_and_diagonals(k, seed):
    # x_j' = p x_j - a x_j^3 - b x_j |x|^2: branches along m equal components, p = x^2 (a + m b), m = 1 .. k
    rng = np.random.default_rng(seed)
    a, b = 1.0, 0.6
    linear, cubes, round_ = squares(k)
    field = [add(linear[j], scale(cubes[j], -a), scale(round_[j], -b)) for j in range(k)]
    jet, T = hide(field, [-1.0], rng, 3, parameters=1)
    found = branch_directions(jet, state_error=1e-12)
    assert found[0].primary
    assert not found[0].vertical
    sides = found[1:]
    assert len(sides) == (3**k - 1) // 2
    for d in sides:
        x = np.linalg.solve(T, d.tangent[:-1])
        used = np.abs(x[:k]) > 1e-6 * np.abs(x).max()
        m, size = used.sum(), np.abs(x[:k][used])
        np.testing.assert_allclose(size, size[0], rtol=1e-6)
        assert d.vertical
        assert d.curvature[-1] == pytest.approx(size[0] ** 2 * (a + m * b), rel=1e-6)
        assert d.note == ""


def test_circle_symmetry_gives_one_representative_with_a_note():
    linear, _, round_ = squares(2)
    jet, T = hide([add(linear[j], scale(round_[j], -0.7)) for j in range(2)], [-1.0], np.random.default_rng(0), 3, 1)
    found = branch_directions(jet, state_error=1e-12)
    assert len(found) == 2
    assert "continuous symmetry" in found[1].note
    x = np.linalg.solve(T, found[1].tangent[:-1])
    assert found[1].curvature[-1] == pytest.approx(0.7 * float(x @ x), rel=1e-6)
    assert any_branch_point(jet, state_error=1e-12).coefficients["continua"] == 1


def test_triangle_symmetry_gives_three_transcritical_branches():
    # z' = p z + conj(z)^2: branches p = -r along the three axes, and rest (Golubitsky, Stewart and Schaeffer, XIII.5)
    field = [{(1, 0, 1): 1.0, (2, 0, 0): 1.0, (0, 2, 0): -1.0}, {(0, 1, 1): 1.0, (1, 1, 0): -2.0}]
    jet, T = hide(field, [-1.0, 0.5], np.random.default_rng(1), 3, parameters=1)
    found = branch_directions(jet, state_error=1e-12)
    assert len(found) == 4
    angles = []
    for d in found[1:]:
        assert not d.vertical
        x = np.linalg.solve(T, d.tangent[:-1])[:2] / d.tangent[-1]
        assert np.hypot(*x) == pytest.approx(1.0, rel=1e-7)
        angles.append(np.angle(x[0] + 1j * x[1]) % (2 * np.pi))
    np.testing.assert_allclose(np.sort(angles), np.pi / 3 + 2 * np.pi / 3 * np.arange(3), atol=1e-7)
    np.testing.assert_allclose(np.linalg.solve(T, found[0].tangent[:-1]), 0.0, atol=1e-9)


def test_all_predictors_at_a_triangle_point_leave_third_order_residuals():
    field = [{(1, 0, 1): 1.0, (2, 0, 0): 1.0, (0, 2, 0): -1.0}, {(0, 1, 1): 1.0, (1, 1, 0): -2.0}]
    jet, _ = hide(field, [-1.0, 0.5], np.random.default_rng(2), 3, parameters=1)
    found = branch_directions(jet, state_error=1e-12)
    assert len(found) == 4
    for d in found:
        steps = 1e-3 / 2.0 ** np.arange(4)
        miss = []
        for s in steps:
            z = d.predict(s)
            miss.append(np.linalg.norm([sum(c * np.prod(z ** np.array(e)) for e, c in f.items()) for f in jet.field]))
        assert np.polyfit(np.log(steps), np.log(miss), 1)[0] > 2.85


def test_a_slope_of_rounding_is_none():
    # the same with F_p = rounding of a state that does not move: no fold, although it cancels in none of its components
    noise = {(0, 0, 1): 1e-17}
    field = [{(1, 0, 1): 1.0, (2, 0, 0): 1.0, (0, 2, 0): -1.0} | noise, {(0, 1, 1): 1.0, (1, 1, 0): -2.0} | noise]
    jet = PolynomialJet(field, 1)
    assert any_branch_point(jet, state_error=1e-12).coefficients["scaling"] == "quadratic"
    assert len(branch_directions(jet, state_error=1e-12)) == 4
    slope = {(0, 0, 1): 1e-6}  # a slope that is small, but known
    assert any_branch_point(PolynomialJet([field[0] | slope, field[1]], 1)).coefficients["scaling"] == "fold"


def test_hilltop_point_has_two_vertical_curves():
    # x' = p - x^2 + ..., y' = x y - y^2 -> with F_p outside the range: x y = y^2 gives y = 0 or x = y, p = x^2
    field = [{(0, 0, 1): 1.0, (2, 0, 0): -1.0}, {(1, 1, 0): 1.0, (0, 2, 0): -1.0}]
    jet, T = hide(field, [-1.0], np.random.default_rng(3), 3, parameters=1)
    found = branch_directions(jet)
    assert len(found) == 2
    for d in found:
        x = np.linalg.solve(T, d.tangent[:-1])
        assert d.vertical
        assert d.curvature[-1] == pytest.approx(x[0] ** 2, rel=1e-7)
        assert min(abs(x[1]), abs(x[1] - x[0])) < 1e-7 * abs(x[0])
    assert any_branch_point(jet).coefficients["scaling"] == "fold"


def test_effort_of_a_two_dimensional_kernel():
    linear, cubes, _ = squares(2)
    jet = PolynomialJet([add(linear[j], scale(cubes[j], -1.0)) for j in range(2)], 1)
    branch_directions(jet, kernel=2)
    assert jet.calls <= 80


@pytest.mark.parametrize("cells", [4, 5])
def test_all_to_all_coupled_cells_have_every_two_block_branch(cells):
    # u_j' = p (u_j - mean) + u_j^2 - mean of squares - mean: the kernel is sum u = 0, and branches are the
    # 2^(cells - 1) - 1 splittings of the cells into two synchronous blocks (Golubitsky and Stewart, The Symmetry
    # Perspective, sec. 2.6)
    total = cells + 1
    u = [variable(j, total) for j in range(cells)]
    p = variable(cells, total)
    mean = scale(add(*u), 1 / cells)
    squares_mean = scale(add(*(multiply(x, x, 9) for x in u)), 1 / cells)
    field = [
        add(multiply(p, add(x, scale(mean, -1.0)), 9), multiply(x, x, 9), scale(squares_mean, -1.0), scale(mean, -1.0))
        for x in u
    ]
    found = branch_directions(PolynomialJet(field, 1), state_error=1e-12)
    assert len(found) == 1 + 2 ** (cells - 1) - 1
    np.testing.assert_allclose(found[0].tangent, np.eye(total)[-1], atol=1e-9)
    for d in found[1:]:
        x, dp = d.tangent[:cells], d.tangent[-1]
        assert len(np.unique(np.round(x, 6))) == 2
        np.testing.assert_allclose(dp * x + x * x - np.mean(x * x), 0.0, atol=1e-8)  # dp = 0 for equal blocks
