"""Branches that a symmetry makes of computed ones are told apart in the units of each state."""

import numpy as np
import pytest

import contin


def exchange(x: float, y: float) -> contin.Model:
    """Two cells in units x and y; of the symmetries one changes the sign of x alone."""
    return contin.Model(
        "cells", states={"x": {"value": 0.0, "scale": x}, "y": {"value": 0.0, "scale": y}},
        parameters={"p": {"value": -0.5, "range": [-0.5, 1.5]}},
        equations={
            "x": f"p*x - x^3/{x * x!r}", "y": f"(p - 0.5)*y - y^3/{y * y!r} - 0.1*y*x^2/{x * x!r}",
        },
        symmetries={"left": {"x": "-x", "y": "y"}, "right": {"x": "x", "y": "-y"}},
    )  # fmt: skip


@pytest.mark.parametrize(("x", "y"), [(1.0, 1.0), (1e-15, 1e-15), (1e-9, 1e3), (1e6, 1e-6)])
def test_every_image_is_there_in_any_units(x, y):
    diagram = contin.diagram(exchange(x, y), "p")
    at = 1.2
    found = set()
    for branch in diagram:
        p = branch.z[:, -1]
        for k in np.flatnonzero((p[:-1] - at) * (p[1:] - at) <= 0.0):
            row = branch.z[k if abs(p[k] - at) < abs(p[k + 1] - at) else k + 1]
            found.add((int(np.sign(round(row[0] / x, 3))), int(np.sign(round(row[1] / y, 3)))))
    assert found == {(a, b) for a in (-1, 0, 1) for b in (-1, 0, 1)}
