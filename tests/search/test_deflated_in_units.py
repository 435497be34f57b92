"""Deflated continuation counts solutions whose states have different units: T3(x) = p, T3(y) = p has nine."""

import json

import numpy as np
import pytest

import contin
from contin.model.yaml_loader import load_model_text


def squares(a: float, b: float):
    """With x and y in units of a and b; T3 = 4 x^3 - 3 x is Chebyshev's polynomial, T3(cos t) = cos 3 t."""
    equations = {n: f"{u!r}*(p - 4*({n}/{u!r})^3 + 3*{n}/{u!r})" for n, u in (("x", a), ("y", b))}
    model = {
        "contin": 1, "name": "chebyshev", "states": {"x": 0, "y": 0}, "parameters": {"p": 0.5}, "equations": equations
    }  # fmt: skip
    return load_model_text(json.dumps(model))


@pytest.mark.parametrize(("a", "b"), [(1.0, 1.0), (1e6, 1e-6)])
def test_nine_solutions_are_counted_in_any_units(a, b):
    """Three were (solutions that differ in the smaller state alone were taken for one), and the note said so."""
    found = contin.deflated(squares(a, b), "p", (0.4, 0.6), samples=[0.5])
    assert list(found.notes) == ["p = 0.5: 9 solutions, 8 of them by deflation there"]
    rows = [[float(c[n][np.argmin(np.abs(c["p"] - 0.5))]) / u for n, u in (("x", a), ("y", b))]
            for c in (branch.columns for branch in found.branches)]  # fmt: skip
    roots = np.cos((np.arccos(0.5) + 2 * np.pi * np.arange(3)) / 3)
    exact = sorted((x, y) for x in roots for y in roots)
    np.testing.assert_allclose(sorted(map(tuple, np.round(rows, 6))), exact, atol=1e-3)
