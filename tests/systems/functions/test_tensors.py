"""All derivatives of order 2 and 3 at a point, from as few pure ones as there are."""

from itertools import permutations
from math import comb

import numpy as np
import pytest

import contin
from contin.systems.functions.tensors import contracted, second, third


@pytest.mark.parametrize("n", [1, 2, 4])
def test_symmetric_forms_come_back_from_as_many_pure_ones_as_they_have_entries(n):
    rng, calls = np.random.default_rng(n), []
    for order, build in ((2, second), (3, third)):
        form = rng.normal(size=(n,) * order + (n,))
        axes = range(order)
        form = sum(form.transpose(*each, order) for each in permutations(axes))
        calls.clear()

        def pure(v, form=form, order=order):
            calls.append(v)
            return contracted(form, (v,) * order)

        np.testing.assert_allclose(build(pure, n), form, atol=1e-12 * np.abs(form).max())
        assert len(calls) == comb(n + order - 1, order)


@pytest.mark.parametrize("size", [1.0, 1e6])
def test_tensors_of_a_function_are_its_forms_in_any_units(size):
    def f(u, p):
        x, y, z = u[0] / size, u[1], u[2]
        return np.array([size * x * y * z + size * x**3, np.exp(y) * x + p["a"] * z**2, x * x * y - np.sin(z)])

    system = contin.FunctionProblem(f, [0.3 * size, 0.7, -0.2], {"a": 1.3}).system()
    u, p, rng = np.array([0.3 * size, 0.7, -0.2]), np.array([1.3]), np.random.default_rng(3)
    for order in (2, 3):
        d = [(rng.normal(size=3) + 1j * rng.normal(size=3)) * [size, 1.0, 1.0] for _ in range(order)]
        expected = system.derivative(u, p, *(np.append(v, 0.0) for v in d))
        found = contracted(system.tensor(u, p, order), tuple(d))
        np.testing.assert_allclose(found / [size, 1, 1], expected / [size, 1, 1], rtol=1e-9)
