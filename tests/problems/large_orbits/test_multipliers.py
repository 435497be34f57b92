"""Multipliers by Arnoldi's method with restarts: what has not converged is not taken for the leading ones."""

import numpy as np
import pytest
from scipy.sparse.linalg import ArpackNoConvergence

from contin.problems.large_orbits import multipliers

VALUES = np.concatenate([[1.5, -1.2, 0.95], 0.8 * np.random.default_rng(1).uniform(-1.0, 1.0, 97)])


def test_all_outside_a_circle_are_found():
    values, vectors = multipliers._restarted(lambda w: VALUES * w, np.ones(100))
    assert np.allclose(values[:3], VALUES[:3], rtol=1e-9)
    assert np.allclose(np.abs(vectors[:, 0]), np.eye(100)[0], atol=1e-8)


@pytest.mark.parametrize("fails", [2, 99])
def test_what_does_not_converge_is_tried_in_larger_spaces_and_then_not_known(fails, monkeypatch):
    rooms, eigs = [], multipliers.eigs

    def failing(operator, **options):
        rooms.append(options["ncv"])
        if len(rooms) <= fails:
            raise ArpackNoConvergence("no", np.array([0.3 + 0j]), np.ones((100, 1), complex))
        return eigs(operator, **options)

    monkeypatch.setattr(multipliers, "eigs", failing)
    values, _ = multipliers._restarted(lambda w: VALUES * w, np.ones(100))
    assert rooms == [20, 28, 56]
    if fails == 2:
        assert np.allclose(values[:3], VALUES[:3], rtol=1e-9)
    else:
        assert np.isnan(values).all()  # such rows are not called stable, and a note says which
