"""Connecting orbits are found whichever of two parameters is named first."""

from __future__ import annotations

import numpy as np
import pytest

import contin
from contin.model.model import Model

SADDLE = {"x": 0, "y": 0}


def plane(m: float) -> Model:
    """Sandstede's equations in the plane: with m = 0 a loop of x^2 (1 - x) = y^2 whatever a is."""
    return Model(
        "plane", states=SADDLE, parameters={"a": 0.3, "m": m},
        equations={
            "x": "a*x + y - a*x^2 + m*x*(2 - 3*x)", "y": "x + a*y - 3/2*x^2 - 3/2*a*x*y - 2*m*y",
        },
    )  # fmt: skip


@pytest.mark.parametrize("m", [0.0, 0.01])
def test_a_loop_that_the_first_parameter_does_not_move_is_found_by_the_second(m):
    """It was not found: Newton's method, and the homotopy, had the first parameter alone to move."""
    loops = contin.continuation(
        contin.connection(plane(m), SADDLE), ("a", "m"), {"a": (0.2, 0.4), "m": (-0.5, 0.5)}
    )  # fmt: skip
    assert [end.reason for end in loops.ends] == ["bound", "bound"]
    np.testing.assert_allclose(loops.columns["m"], 0.0, atol=1e-9)
    assert loops.columns["a"].min() == pytest.approx(0.2)
    assert loops.columns["a"].max() == pytest.approx(0.4)
    np.testing.assert_allclose(loops.columns["x.max"], 1.0, atol=1e-6)
