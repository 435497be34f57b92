"""Formulas by shapes are the formulas: values, slopes and forms agree with those compiled one by one."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from contin.lowering.alike import Alike
from tests.lowering.systems import compiled, equations

STATES = [f"x{k}" for k in range(6)]
TERMS = [
    "a*{0}*{1}", "sin({0} - {1})", "{0}^3", "exp(-{0}^2)*{1}", "{c}*{0}", "({0} - {c})/(1 + {1}^2)", "b*{0}*{0}",
    "{0}^{c}", "{0}/(1 - exp(-{0}))", "2*{0} - 0.5*{1}", "a", "tanh({0} + {c}*{1})",
]  # fmt: skip
FORMULAS = st.lists(
    st.tuples(
        st.sampled_from(TERMS), st.sampled_from(STATES), st.sampled_from(STATES), st.sampled_from(["0.3", "17.5", "2"])
    ).map(lambda t: t[0].format(t[1], t[2], c=t[3])),
    min_size=1,
    max_size=3,
).map(" + ".join)


@settings(max_examples=8, deadline=None)
@given(st.lists(FORMULAS, min_size=6, max_size=6), st.integers(0, 1000))
@pytest.mark.seldom
def test_shapes_give_the_values_and_derivatives_of_the_formulas(texts, seed):
    rng = np.random.default_rng(seed)
    rights = dict(zip(STATES, texts, strict=True))
    system, alike = compiled(rights, ["a", "b"]), Alike(equations(rights, ["a", "b"]).equations, STATES, ["a", "b"])
    u, p = rng.uniform(0.5, 1.5, 6), rng.uniform(0.5, 1.5, 2)
    value, matrix = system.jacobian(u, p)
    np.testing.assert_allclose(alike.value(u, p), value, rtol=1e-13, atol=1e-13)
    sparse = np.zeros((6, 6))
    rows, columns = alike.pattern
    sparse[rows, columns] = alike.slopes(u, p)
    assert len(set(zip(rows.tolist(), columns.tolist(), strict=True))) == len(rows)
    np.testing.assert_allclose(sparse, matrix[:, :6], rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(alike.parameter_slopes(u, p), matrix[:, 6:], rtol=1e-12, atol=1e-12)
    directions = [rng.normal(size=8) for _ in range(3)]
    for order in (1, 2, 3):
        form = system.derivative(u, p, *directions[:order])
        np.testing.assert_allclose(alike.form(u, p, directions[:order]), form, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("n", [10, 1000])
def test_a_chain_has_three_shapes_whatever_its_length_and_whatever_its_constants(n):
    names = [f"u{k}" for k in range(n)]
    inner = {names[k]: f"{names[k - 1]} - 2*{names[k]} + {names[k + 1]} + {17.25 + k}*p" for k in range(1, n - 1)}
    rights = {names[0]: "u1 - 2*u0 + p", **inner, names[-1]: f"{names[-2]} - 2*{names[-1]}"}
    alike = Alike(equations(rights, ["p"]).equations, names, ["p"])
    assert len(alike.shapes) == 3
    assert len(alike.pattern[0]) == 3 * n - 2
    out = alike.value(np.ones(n), np.array([2.0]))
    np.testing.assert_allclose(out[1:-1], 2.0 * (17.25 + np.arange(1, n - 1)))
