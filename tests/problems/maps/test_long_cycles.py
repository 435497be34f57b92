"""Multipliers of long cycles, whose product the map's determinant gives in closed form: det^k, 1e-34 for Henon's 64."""

from __future__ import annotations

import numpy as np
import pytest

import contin
from contin.lowering import compile_system
from contin.systems import iterate as iterates


def henon():
    return contin.Model(
        "henon", kind="map", states={"x": 0.6, "y": 0.2}, parameters={"a": 0.2, "b": 0.3},
        equations={"x": "1 - a*x^2 + y", "y": "b*x"},
    )  # fmt: skip


def test_small_multipliers_of_doubled_cycles_keep_their_digits_and_cost_no_search(monkeypatch):
    """Rounding errors of the large one changed the sign of the small one, and each change was looked into."""
    calls = []
    jacobian = iterates.IteratedSystem.jacobian
    monkeypatch.setattr(iterates.IteratedSystem, "jacobian", lambda *a: calls.append(1) or jacobian(*a))
    found = contin.diagram(henon(), "a", (0.2, 1.4))
    assert [len(branch.points) for branch in found.branches] == [1] * 7
    assert len(calls) < 5000
    for branch in found.branches:
        k = 2 ** branch.name.count("PD")
        for row in {*range(0, len(branch), 5), *(point.index for point in branch.points)}:
            values = branch.eigenvalues[row]
            logarithm = np.log(np.abs(values)).sum() - k * np.log(0.3)
            assert abs(logarithm) < 1e-6 * k, (branch.name, row)


@pytest.mark.parametrize("k", [1, 2, 3, 7])
def test_compiled_iterates_are_those_by_the_chain_rule(k):
    system = iterates.iterate(compile_system(henon()), k)
    u, p = np.array([0.3, -0.1]), np.array([1.2, 0.3])
    value, slopes = system.jacobian(u, p)
    x, product = u, np.eye(2)
    for _ in range(k):
        product = np.array([[-2 * 1.2 * x[0], 1.0], [0.3, 0.0]]) @ product
        x = np.array([1 - 1.2 * x[0] ** 2 + x[1], 0.3 * x[0]])
    np.testing.assert_allclose(value, x, rtol=1e-13)
    np.testing.assert_allclose(np.atleast_2d(slopes)[:, :2], product, rtol=1e-12, atol=1e-14)
    step = 1e-6
    ahead, behind = (system.value(u, p + np.array([s * step, 0.0])) for s in (1.0, -1.0))
    np.testing.assert_allclose(np.atleast_2d(slopes)[:, 2], (ahead - behind) / (2 * step), rtol=1e-6, atol=1e-8)

