"""Scalars of successive extrema and their derivatives: x + a + b + c on the sphere x^2 + a^2 + b^2 + c^2 = 1.

With k equal unknowns y, the sum is k y + sqrt(1 - k y^2): at its maximum its second derivative is -k (k + 1)^(3/2).
"""

from __future__ import annotations

from math import sqrt

import numpy as np
import pytest

import contin
from contin.loci.augmented.elimination import differenced
from contin.loci.augmented.equilibria import EquilibriumBase
from contin.loci.augmented.of_extrema import of_solutions
from contin.model.model import Model

BOX = {"a": (-1, 1), "b": (-1, 1)}


def sphere():
    return Model(
        "sphere", kind="algebraic", states={"x": 0.8}, parameters={"a": 0.6, "b": 0.0, "c": 0.0},
        equations={"x": "x^2 + a^2 + b^2 + c^2 - 1"}, observables={"total": "x + a + b + c"},
    )  # fmt: skip


@pytest.fixture(scope="module")
def great_circle():
    start = contin.equilibrium(sphere(), {"x": 0.8})
    return contin.continuation(start, "a", (-0.9, 0.9), extrema=["total"])


def test_the_curvature_at_successive_extrema_is_that_of_the_closed_form_to_its_error(great_circle):
    found = contin.continuation(great_circle["EX1"].locus(("a", "b")), ("a", "b"), BOX, extrema=["total"])
    assert found.points
    for point in found.points:
        form = point.normal_form
        exact = -6.0 * sqrt(3.0) * (1.0 if form["kind"] == "maximum" else -1.0)
        assert abs(form["curvature"] - exact) <= form["errors"]["curvature"] < 1e-7


def test_derivatives_of_the_scalars_are_exact_and_need_the_equations_at_three_places(great_circle, monkeypatch):
    seed = of_solutions(great_circle.problem, great_circle["EX1"], ("a", "b"))
    scale = np.array([0.7, 0.5, 2.0])
    scalars = seed.problem.near(seed.z, scale).scalars
    scalars(seed.z + 0.1)  # the answer is none of the call before
    places = []
    linearise = EquilibriumBase.linearise

    def counted(base, z, *rest):
        places.append(z)
        return linearise(base, z, *rest)

    monkeypatch.setattr(EquilibriumBase, "linearise", counted)
    scalars(seed.z)
    along = [scalars.along(seed.z, unit)[0] for unit in scale * np.eye(3)]
    assert len(places) == 3
    again = [differenced(scalars, seed.z, unit, scale)[0] for unit in np.eye(3)]
    assert np.allclose(along, again, rtol=0.0, atol=1e-7 * np.abs(again).max())
    x, _, a = seed.z  # the scalar is s (x - a), w being s (-a, 0, x) in (x, b, a)
    assert x == pytest.approx(a, abs=1e-9)
    assert along[0] / scale[0] == pytest.approx(-along[2] / scale[2], rel=1e-8)
    assert abs(along[1]) < 1e-9 * abs(along[0])
