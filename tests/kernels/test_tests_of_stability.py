"""The test functions count: their sign is the parity of a product over pairs, their zeros are Hopf points and flips."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contin.kernels.tests_of_stability import flow_tests, map_tests


def spectrum(rng, n, spread=1.0):
    values = []
    while len(values) < n:
        if n - len(values) >= 2 and rng.random() < 0.5:
            z = complex(*rng.normal(size=2)) * spread
            values += [z, z.conjugate()]
        else:
            values.append(complex(rng.normal() * spread))
    return np.array(values)


def measured(tests_of, values):
    tests = np.full(4, np.nan)
    re, im = values.real.copy(), values.imag.copy()
    rates = [np.full(len(values), np.abs(values).max())] if tests_of is flow_tests else []
    count = tests_of(re, im, *rates, tests)
    return count, tests[2], tests[3]


@given(n=st.integers(1, 12), seed=st.integers(0, 10**6))
def test_flow_sign_is_that_of_the_product_of_pairwise_sums(n, seed):
    """prod (l_i + l_j) is real; 'all stable' has the sign (-1)^(n(n-1)/2), which is made positive."""
    values = spectrum(np.random.default_rng(seed), n)
    count, pairs, flips = measured(flow_tests, values)
    assert count == np.sum(values.real > 0)
    product = np.prod([a + b for a, b in combinations(values, 2)]) if n > 1 else 1.0
    assert np.sign(pairs) == np.sign(product.real) * (-1) ** (n * (n - 1) // 2)
    assert abs(pairs) <= 1.0
    assert flips == 1.0


@given(n=st.integers(1, 12), seed=st.integers(0, 10**6))
def test_map_signs_are_those_of_the_products(n, seed):
    values = spectrum(np.random.default_rng(seed), n, 1.2)
    count, pairs, flips = measured(map_tests, values)
    assert count == np.sum(np.abs(values) > 1)
    wanted_flips = np.prod(values + 1).real
    assert np.sign(flips) == np.sign(wanted_flips)
    # 1 - m_i m_j, so that a stable fixed point has a positive product
    wanted_pairs = np.prod([1 - a * b for a, b in combinations(values, 2)]).real if n > 1 else 1.0
    assert np.sign(pairs) == np.sign(wanted_pairs)


@pytest.mark.parametrize("values", [[1j, -1j, -2.0], [3.0, -3.0, 1.0 + 1j, 1.0 - 1j]], ids=str)
def test_flow_test_vanishes_on_a_hopf_pair_and_on_a_neutral_saddle(values):
    assert measured(flow_tests, np.array(values, dtype=complex))[1] == 0.0


def test_map_tests_vanish_on_the_unit_circle():
    pair = np.exp(1j * np.array([0.7, -0.7]))
    assert abs(measured(map_tests, np.append(pair, 0.2))[1]) < 1e-15
    assert measured(map_tests, np.array([-1.0 + 0j, 0.3]))[2] == 0.0


@given(seed=st.integers(0, 10**6), factor=st.integers(-20, 20))
def test_flow_test_does_not_depend_on_the_unit_of_time(seed, factor):
    values = spectrum(np.random.default_rng(seed), 5)
    assert measured(flow_tests, values * 2.0**factor)[:2] == measured(flow_tests, values)[:2]


@given(seed=st.integers(0, 10**6), n=st.integers(2, 8))
def test_size_is_continuous_through_a_collision_on_the_real_axis(seed, n):
    """Two real eigenvalues meet and leave as a pair: the test function must not jump (that looks like an event)."""
    rest = spectrum(np.random.default_rng(seed), n)
    at = np.random.default_rng(seed + 1).normal()
    h = 1e-7
    real = measured(flow_tests, np.append([at + h, at - h], rest).astype(complex))
    pair = measured(flow_tests, np.append([at + 1j * h, at - 1j * h], rest))
    assert pair[1] == pytest.approx(real[1], rel=1e-4, abs=1e-5)
    assert np.sign(pair[1]) == np.sign(real[1])
