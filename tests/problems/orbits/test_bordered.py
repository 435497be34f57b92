"""Null vectors of singular sparse matrices, whatever borders they are begun with."""

import numpy as np
import pytest
from scipy import sparse

from contin.problems.orbits.linearised.bordered import Bordered


def singular(kind, seed):
    """A matrix of rank n - 1 and its null vectors x and y: M x = 0, y^* M = 0."""
    generator = np.random.default_rng(seed)
    n = 30

    def draw(*shape):
        values = generator.normal(size=shape)
        return values + 1j * generator.normal(size=shape) if kind is complex else values

    matrix, x, y = draw(n, n), draw(n), draw(n)
    x, y = x / np.linalg.norm(x), y / np.linalg.norm(y)
    matrix -= np.outer(matrix @ x, x.conj())
    matrix -= np.outer(y, y.conj() @ matrix)
    return sparse.csc_matrix(matrix), x, y


def parallel(a, b):
    return abs(np.vdot(a, b)) / np.linalg.norm(a) / np.linalg.norm(b)


@pytest.mark.parametrize("kind", [float, complex])
@pytest.mark.parametrize("start", ["random", "near", "orthogonal", "of another size"])
def test_null_vectors_do_not_depend_on_the_borders_that_were_begun_with(kind, start):
    matrix, x, y = singular(kind, 3)
    tilt = np.random.default_rng(4).normal(size=(2, x.size)) * 0.02
    beside = [v - np.vdot(w, v) * w for v, w in zip(tilt, (y, x), strict=True)]
    like = {
        "random": None,
        "near": tuple((v + d)[:, None] / np.linalg.norm(v + d) for v, d in zip((y, x), tilt, strict=True)),
        "orthogonal": tuple(d[:, None] / np.linalg.norm(d) for d in beside),
        "of another size": (np.ones((5, 1)), np.ones((5, 1))),
    }[start]
    if start == "orthogonal":  # the bordered matrix is singular but for rounding: the next borders are right again
        like = tuple(v + 1e-3 * w[:, None] for v, w in zip(like, (y, x), strict=True))
    v, g, w = Bordered.of(matrix, 1, like).solve()
    assert parallel(v[:, 0], x) == pytest.approx(1.0, abs=1e-10)
    assert parallel(w[:, 0], y) == pytest.approx(1.0, abs=1e-10)
    assert abs(g[0, 0]) < 1e-9
    assert np.linalg.norm(matrix @ v) < 1e-9
    assert np.linalg.norm(w.conj().T @ matrix) < 1e-9


def test_borders_that_serve_are_kept_and_others_are_not():
    matrix, x, y = singular(float, 5)
    near, far = (y[:, None], x[:, None]), (np.eye(30)[:, :1], np.eye(30)[:, 1:2])
    assert Bordered.of(matrix, 1, near).c is near[1]
    assert Bordered.of(matrix, 1, far).c is not far[1]
