"""Functions that fill and return one array again and again give what functions that make new ones give."""

import numpy as np
import pytest
from scipy import sparse

import contin


def rates(u, p):
    x, y = u
    growth = p["mu"] - x * x - y * y
    return np.array([growth * x - y - 0.3 * x * y * y, growth * y + x + 0.2 * x * x])


def slopes(u, p):
    x, y = u
    growth = p["mu"] - x * x - y * y
    return np.array([
        [growth - 2 * x * x - 0.3 * y * y, -2 * x * y - 1 - 0.6 * x * y],
        [-2 * x * y + 1 + 0.4 * x, growth - 2 * y * y],
    ])  # fmt: skip


class Same:
    """A function whose values stand in one array of each type of numbers, or in one sparse matrix."""

    def __init__(self, function, matrix=False):
        self.function, self.matrix, self.kept = function, matrix, {}

    def __call__(self, u, p):
        value = self.function(u, p)
        if self.matrix:
            made = self.kept.setdefault("matrix", sparse.csc_matrix(np.ones((2, 2))))
            made.data[:] = value.T.ravel()
            return made
        made = self.kept.setdefault(value.dtype, np.empty_like(value))
        made[...] = value
        return made


@pytest.mark.parametrize("kind", ["values alone", "coloured", "dense Jacobian", "sparse Jacobian"])
def test_labels_and_orbits_have_the_same_bits(kind):
    found = []
    for once in (False, True):
        options = {
            "values alone": {},
            "coloured": {"sparsity": sparse.csc_matrix(np.ones((2, 2)))},
            "dense Jacobian": {"jacobian": Same(slopes) if once else slopes},
            "sparse Jacobian": {
                "jacobian": Same(slopes, True) if once else lambda u, p: sparse.csc_matrix(slopes(u, p))
            },
        }[kind]
        model = contin.FunctionProblem(Same(rates) if once else rates, np.zeros(2), {"mu": -0.5}, **options)
        line = contin.continuation(model, "mu", (-0.5, 0.3))
        family = contin.continuation(line["HB1"].switch(), "mu", (-0.1, 0.2), settings={"steps": 2, "intervals": 6})
        found.append((line["HB1"].normal_form["l1"], line.z.tobytes(), family.z.tobytes()))
    assert found[0] == found[1]
