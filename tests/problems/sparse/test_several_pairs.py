"""Hopf points of large systems at which several equal pairs of eigenvalues cross together."""

import numpy as np
import pytest
from scipy import sparse

import contin

DECAYING = -np.arange(1.0, 31.0)
FIRST, LATER = 0.25, 0.6


def planted(copies):
    """`copies` planes whose pairs mu - 1/4 +- 2i cross together, coupled in third order, one more at mu = 0.6."""

    def residual(u, p):
        v = u[: 2 * copies + 2].reshape(-1, 2)
        growth = p["mu"] - np.array([*[FIRST] * copies, LATER])[:, None]
        square = (v * v).sum() + (v * v).sum(axis=1, keepdims=True)
        moved = (growth - square) * v + np.array([2.0, *[2.0] * (copies - 1), 3.0])[:, None] * v[:, ::-1] * [-1.0, 1.0]
        return np.concatenate([moved.ravel(), DECAYING * u[2 * copies + 2 :]])

    n = 2 * copies + 2 + len(DECAYING)
    full = sparse.csc_matrix(np.ones((n, n)))
    return contin.FunctionProblem(residual, np.zeros(n), {"mu": 0.0, "nu": 0.0}, sparsity=full)


@pytest.mark.parametrize("copies", [2, 3])
def test_they_are_one_label_without_the_coefficient_of_a_simple_one(copies):
    line = contin.continuation(planted(copies), "mu", (0.0, 0.8))
    several, simple = line.points
    assert [several.type, simple.type] == ["HB", "HB"]
    assert abs(several.values["mu"] - FIRST) <= several.error + 1e-14
    assert several.vectors["kernel"] == copies
    assert several.values["unstable"] == 0
    assert "l1" not in several.normal_form
    assert simple.values["unstable"] == 2 * copies
    assert simple.normal_form["l1"] < 0.0
    (note,) = line.notes
    assert "several pairs of eigenvalues cross at once" in note
    with pytest.raises(contin.InputError, match=f"{copies} pairs of eigenvalues that cross together"):
        contin.continuation(several.locus(), ("mu", "nu"), {"mu": (0.0, 0.8), "nu": (0.0, 1.0)})
    assert sorted(set(line.columns["unstable"])) == [0, 2 * copies, 2 * copies + 2]
