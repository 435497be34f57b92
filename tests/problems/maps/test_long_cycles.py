"""Multipliers of long cycles, whose product the map's determinant gives in closed form: det^k, 1e-34 for Henon's 64."""

from __future__ import annotations

import numpy as np
import pytest

import contin
from contin.continuation.outcome import Rejected, Verified
from contin.continuation.sample import Frame, Sample
from contin.lowering import compile_system
from contin.problems.maps.unrolled import sharper
from contin.simulate.natural import natural_metric
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


def beside_a_fast_state(states, equations, rate):
    """The map with a state that grows by `rate` a step along what it had, which is coupled both ways and stays zero."""
    name = next(iter(states))
    own = {key: f"{text} + w" for key, text in equations.items()}
    return {**states, "w": 0.0}, {**own, "w": f"{rate}*w + w*{name}"}


def test_fold_and_doubling_of_a_three_cycle_are_exact_beside_a_multiplier_of_1e10():
    """Places were known to 1e-5 only: the third iterate's rounding errors are 1e10 times the map's."""
    states, equations = beside_a_fast_state({"x": 0.149}, {"x": "r*x*(1 - x)"}, 3000)
    model = contin.Model("logistic", kind="map", states=states, parameters={"r": 3.84}, equations=equations)
    start = contin.equilibrium(model, {"x": 0.149}, {"r": 3.84}, period=3)
    branch = contin.continuation(start, "r", (3.82, 3.845))
    fold, doubling = branch["LP1"], branch["PD1"]
    assert abs(fold.z[-1] - (1.0 + np.sqrt(8.0))) <= fold.error < 1e-12
    assert abs(doubling.z[-1] - 3.8414990075435078) <= doubling.error + 1e-15
    assert doubling.error < 1e-12


def test_points_that_the_iterate_cannot_place_are_found_in_all_points_of_the_cycle():
    """x' = y, y' = z, z' = M + .7 x + .7 y - z^2: on its two-cycle NS at M = 1439/19600 and PD at M = 1.495."""
    model = contin.Model(
        "delayed", kind="map", states={"x": 0.0, "y": 0.0, "z": 0.0}, parameters={"M": 0.0},
        equations={"x": "y", "y": "z", "z": "M + 0.7*x + 0.7*y - z^2"},
    )  # fmt: skip
    cycles = contin.diagram(model, "M", (-0.1, 1.4951))["start/PD1"]
    for label, place, unstable in (("NS1", 1439 / 19600, 0), ("PD1", 1.495, 1)):
        point = cycles[label]
        beside = point.z + 1e-5 * np.cos(np.arange(len(point.z)))
        near = Sample(beside, point.tangent, np.empty(4), 0, point.eigenvalues)
        lost = Rejected("lost in rounding", suspect=True)
        found = sharper(cycles.problem, lost, point.type, near, Frame(point.scale))
        assert isinstance(found, Verified)
        assert abs(found.z[-1] - place) <= found.error < 1e-12
        assert found.unstable == unstable
        np.testing.assert_allclose(found.z, point.z, rtol=1e-12)
        assert found.normal_form["criticality"] == point.normal_form["criticality"]


def test_states_that_are_zero_at_one_point_of_a_cycle_have_their_sizes_at_the_others():
    """A clock 0 -> 1/3 -> 2/3 -> 0 that turns (x, y) with it: f^3(0) is of the size 1e-16, which is no state's size."""
    model = contin.Model(
        "clock", kind="map", states={"x": 0, "y": 0, "z": 0}, parameters={"r": 0.4},
        definitions={"u": "(1 + r)*(x - 0.3*z)", "v": "0.5*(y + 0.7*z)", "w": "1/3 + z - 4.5*z*(z - 1/3)"},
        equations={"x": "0.6*u - 0.8*v + 0.3*w", "y": "0.8*u + 0.6*v - 0.7*w", "z": "w"},
    )  # fmt: skip
    start = contin.equilibrium(model, {"x": 0, "y": 0, "z": 0}, period=3)
    sizes = natural_metric(start.system, np.zeros(3), start.p).states
    assert np.max(np.abs(start.u)) < 1e-14
    np.testing.assert_allclose(sizes, [0.2, 1.4 / 3.0, 2.0 / 3.0], rtol=1e-12)
