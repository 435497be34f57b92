"""Forms that are evaluated together are the forms one by one, whether or not all derivatives are at hand."""

from itertools import product

import numpy as np
import pytest

from contin.normalforms.branching import branch_point
from contin.normalforms.jet import DerivativeJet, along_units, combined

N, PARAMETERS = 2, 1
WIDTH = N + PARAMETERS


def jet_of(tensors, *, together):
    """A jet with these derivatives (width, ..., width, n) by order; the matrix is that of a simple zero eigenvalue."""

    def derivative(directions):
        value = tensors[len(directions)]
        for d in directions:
            value = np.tensordot(d, value, (0, 0))
        return value

    several = (lambda wanted: [derivative(directions) for directions in wanted]) if together else None
    return DerivativeJet(tensors[1][:N].T.copy(), derivative, PARAMETERS, several=several)


def symmetric(rng, order):
    """A symmetric array of so many axes, and one more for the equations."""
    found = rng.normal(size=(*[WIDTH] * order, N))
    for axis in range(1, order):
        others = [np.swapaxes(found, first, axis) for first in range(axis)]
        found = sum(others, found) / (axis + 1)
    return found


@pytest.fixture
def tensors():
    rng = np.random.default_rng(5)
    slope = np.zeros((WIDTH, N))
    slope[1, 1] = -1.0  # u' = (0, -v): a branch point at which the parameter does not drive the kernel
    return {1: slope, 2: symmetric(rng, 2), 3: symmetric(rng, 3)}


@pytest.mark.parametrize("together", [True, False])
def test_all_choices_of_directions_are_the_forms_one_by_one(tensors, together):
    rng, jet = np.random.default_rng(6), jet_of(tensors, together=together)
    jet.prepare(2, 3)
    assert (jet.terms(3) is not None) == together
    first, second, third = rng.normal(size=(2, WIDTH)), rng.normal(size=(3, WIDTH)), rng.normal(size=(2, WIDTH))
    found = combined(jet, first, second, third)
    assert found.shape == (2, 3, 2, N)
    for places in product(range(2), range(3), range(2)):
        alone = jet.form(*(rows[k] for rows, k in zip((first, second, third), places, strict=True)))
        assert found[places] == pytest.approx(alone, rel=1e-13, abs=1e-14)
    along = along_units(jet, first[0], second[1])
    assert along == pytest.approx(np.array([jet.form(first[0], second[1], unit) for unit in np.eye(WIDTH)]), abs=1e-14)


def test_a_branch_point_has_the_same_coefficients_either_way(tensors):
    one, other = (branch_point(jet_of(tensors, together=together)) for together in (True, False))
    for key in ("a01", "a02", "b11", "b20", "b30", "discriminant"):
        assert one.coefficients[key] == pytest.approx(other.coefficients[key], rel=1e-12, abs=1e-13)
    # A = diag(0, -1), no slope in p: q = p = e_1 and h = 0
    assert one.coefficients["b20"] == pytest.approx(tensors[2][0, 0, 0], rel=1e-12)
    assert one.coefficients["b11"] == pytest.approx(tensors[2][0, 2, 0], rel=1e-12)
    assert one.coefficients["a02"] == pytest.approx(tensors[2][2, 2, 0], rel=1e-12)
    # the state that x drives is second[0, 0] = (0, D^2F_2[q, q])
    driven = 3.0 * tensors[2][0, 1, 0] * tensors[2][0, 0, 1]
    assert one.coefficients["b30"] == pytest.approx(tensors[3][0, 0, 0, 0] + driven, rel=1e-12)
