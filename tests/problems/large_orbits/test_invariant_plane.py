"""Invariant planes of a monodromy matrix, next to the trivial multiplier and where two multipliers are one."""

from types import SimpleNamespace

import numpy as np
import pytest

from contin.problems.large_orbits.invariant_plane import Across, plane_near

OTHERS = [0.5, -0.3, 0.2]
AT_ONE, AT_MINUS_ONE = np.array([[1.0, 0.7], [0.0, 1.0]]), np.array([[-1.0, 0.7], [0.0, -1.0]])
TURNING, REAL = np.array([[0.6, -0.8], [0.8, 0.6]]), np.array([[-2.0, 0.1], [0.0, -0.5]])


def planted(block, tilt=0.0):
    """M with M v = v, the block's multipliers and `OTHERS`; its basis turns with `tilt`, and v."""
    generator = np.random.default_rng(3)
    basis, turn = np.linalg.qr(generator.normal(size=(6, 6)))[0], generator.normal(size=(6, 6))
    basis = basis + tilt * turn
    inner = np.diag([1.0, 0.0, 0.0, *OTHERS])
    inner[1:3, 1:3] = block
    inner[0, 2] = 0.4
    M = basis @ inner @ np.linalg.inv(basis)
    sweeps = SimpleNamespace(monodromy=lambda w: M @ w, transposed=lambda w: M.T @ w)
    return M, Across(sweeps, basis[:, 0]), basis[:, 1:3]


@pytest.mark.parametrize("block", [AT_ONE, AT_MINUS_ONE, TURNING, REAL], ids=["1:1", "1:2", "complex", "real"])
def test_product_of_two_multipliers_and_its_rate(block):
    _, across, plane = planted(block)
    found = plane_near(across, plane + 1e-2 * np.random.default_rng(1).normal(size=plane.shape))
    assert found.product == pytest.approx(np.linalg.det(block), abs=1e-12)
    h, other = 1e-5, np.array([[0.3, -0.2], [0.5, 0.9]])  # the block changes, and the basis turns
    ends = [planted(block + side * h * other, side * h) for side in (1.0, -1.0)]
    dM, dv = (ends[0][0] - ends[1][0]) / (2 * h), (ends[0][1].velocity - ends[1][1].velocity) / (2 * h)
    carried = np.column_stack([dM @ across.projected(v) for v in found.right.T])
    rate = found.rate(across.change(found.right, carried, dv))
    assert rate == pytest.approx(np.trace(np.linalg.solve(block, other)), abs=1e-7)


def test_no_plane_is_a_none():
    _, across, plane = planted(TURNING)
    broken = Across(SimpleNamespace(monodromy=lambda w: np.nan * w, transposed=None), across.velocity)
    assert plane_near(broken, plane) is None
