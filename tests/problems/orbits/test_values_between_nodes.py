"""Values of functions inside the intervals of a mesh: sums over nodes, in whichever order of axes they run fastest."""

import numpy as np
import pytest

from contin.kernels.collocation_basis import basis, interpolation
from contin.problems.orbits.mesh.layout import Transfer, in_intervals


def intervals_of(u, m):
    return u[np.arange((len(u) - 1) // m)[:, None] * m + np.arange(m + 1)]


@pytest.mark.parametrize("m", [2, 4, 7])
@pytest.mark.parametrize("kind", [float, complex])
def test_values_in_intervals_are_the_scheme_s_sums_to_the_bit(m, kind):
    generator = np.random.default_rng(m)
    for count, n in ((1, 1), (7, 2), (120, 3)):
        u = generator.normal(size=(count * m + 1, n)).astype(kind)
        if kind is complex:
            u += 1j * generator.normal(size=u.shape)
        for matrix in (basis(m).values, basis(m).slopes, basis(m).top[None]):
            found = in_intervals(matrix, u)
            assert np.array_equal(found, np.einsum("cj,ijk->ick", matrix, intervals_of(u, m)))
            assert found.flags.c_contiguous


@pytest.mark.parametrize("m", [2, 4, 7])
def test_slopes_in_intervals_are_those_of_polynomials_of_the_scheme_s_degree(m):
    h = np.random.default_rng(3).uniform(0.5, 1.5, 9)
    h /= h.sum()
    transfer = Transfer.to_mesh(m, h, h)
    times = (np.cumsum(h) - h)[:, None] + h[:, None] * basis(m).nodes[:-1]
    times = np.append(times.ravel(), 1.0)
    found = in_intervals(basis(m).slopes, (times**m)[:, None])[..., 0] / h[:, None]
    inside = (np.cumsum(h) - h)[:, None] + h[:, None] * basis(m).gauss
    assert found == pytest.approx(m * inside ** (m - 1), abs=1e-11)
    assert transfer((times**m)[:, None])[:, 0] == pytest.approx(times**m, abs=1e-13)


@pytest.mark.parametrize("m", [2, 4, 7])
def test_weights_of_interpolation_are_lagrange_s(m):
    at = np.append(np.random.default_rng(5).uniform(size=50), [0.0, 1.0])
    nodes = basis(m).nodes
    exact = [[np.prod((x - np.delete(nodes, j)) / (nodes[j] - np.delete(nodes, j))) for j in range(m + 1)] for x in at]
    assert interpolation(m, at) == pytest.approx(np.array(exact), abs=1e-13)
    assert interpolation(m, at).sum(axis=1) == pytest.approx(np.ones(len(at)), abs=1e-13)
