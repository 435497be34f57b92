"""Numbers and arrays through Python: the same bits whether few or many values are asked for."""

import math

import numpy as np
import pytest

from contin.machine import elementary
from contin.machine.elementary import functions
from tests.machine.elementary.sampled import BINARY, arguments, compiled
from tests.machine.elementary.test_accuracy import SPECIAL

NAMES = "acos asin atan atan2 cos cosh exp exp2 expm1 hypot log log1p log10 log2 pow sin sinh tan tanh".split()


def same(a, b) -> bool:
    return np.array_equal(np.asarray(a).view(np.int64)[~np.isnan(a)], np.asarray(b).view(np.int64)[~np.isnan(b)])


@pytest.mark.parametrize("name", NAMES)
def test_few_and_many_values_have_the_same_bits(name, monkeypatch):
    special = [(x, y) for x in SPECIAL for y in SPECIAL] if name in BINARY else [(x,) for x in SPECIAL]
    columns = [np.array(column) for column in zip(*[*special, *arguments(name, 20)], strict=True)]
    function = getattr(elementary, name)
    by_code = np.array([compiled(name)(*given) for given in zip(*(c.tolist() for c in columns), strict=True)])
    for few in (0, 10**9):
        monkeypatch.setattr(functions, "FEW", few)
        assert same(function(*columns), by_code)
        assert same(np.array([function(*given) for given in zip(*(c.tolist() for c in columns), strict=True)]), by_code)


def test_shapes_and_kinds_are_those_of_the_arguments():
    grid = np.arange(6.0).reshape(2, 3)
    assert elementary.pow(grid, 2.0).shape == (2, 3)
    assert elementary.pow(2.0, grid.T).shape == (3, 2)
    assert elementary.sin(grid[:, ::2]).tolist() == [[elementary.sin(x) for x in row] for row in grid[:, ::2].tolist()]
    assert type(elementary.exp(1.0)) is float
    assert type(elementary.exp(np.float64(1.0))) is np.float64
    assert elementary.exp(np.zeros((0, 3))).shape == (0, 3)


def test_complex_exponentials_turn():
    z = elementary.exp(np.array([1j * math.pi, 0.5 + 2j]))
    assert z == pytest.approx(np.exp([1j * math.pi, 0.5 + 2j]), rel=1e-15)
    assert elementary.exp(2j) == pytest.approx(np.exp(2j), rel=1e-15)
    assert elementary.angle(z[1]) == pytest.approx(2.0, rel=1e-15)
