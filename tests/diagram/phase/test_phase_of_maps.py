"""Phase diagrams of maps: fixed points, cycles, and curves of both."""

import numpy as np
import pytest

import contin
from contin.diagram.phase.cycles import is_one, is_shorter
from contin.problems.maps.cycle import CycleProblem
from contin.systems.iterate import iterate
from tests.problems.follow import model

BOX = {"a": (0.2, 1.0), "b": (0.0, 0.4)}


@pytest.fixture(scope="module")
def henon():
    """x' = 1 - a x^2 + y, y' = b x: doublings on a = 3 (1 - b)^2/4, then on a = (1 - b)^2 + (1 + b)^2/4."""
    return contin.phase(contin.load("henon"), ("a", "b"), BOX)


@pytest.mark.seldom
def test_cycles_of_the_henon_map_have_their_regions_and_areas(henon):
    stable = {}
    for region in henon.regions:
        steps = tuple(sorted(s.steps for s in region.states if s.unstable == 0))
        stable[steps] = stable.get(steps, 0.0) + region.area
    b = np.linspace(0.0, 0.4, 4001)
    first, second = ((np.clip(a, 0.2, 1.0) - 0.2) / 0.8 for a in (0.75 * (1 - b) ** 2, (1 - b) ** 2 + (1 + b) ** 2 / 4))
    assert stable[(1,)] == pytest.approx(np.mean(first), rel=1e-3)
    assert stable[(2,)] == pytest.approx(np.mean(second - first), rel=2e-3)


def test_words_name_fixed_points_and_cycles(henon):
    assert henon.region_at({"a": 0.3, "b": 0.2}).words == "1 fixed point, stable"
    assert henon.region_at({"a": 0.7, "b": 0.3}).words == "1 fixed point, unstable, 1 stable cycle"


def test_the_curve_on_which_a_cycle_doubles_is_the_closed_form():
    diagram = contin.diagram(contin.load("henon"), "a", (0.0, 1.0))
    point = diagram["start/PD1"]["PD1"]
    curve = contin.continuation(point.locus(("a", "b")), ("a", "b"), BOX)
    a, b = curve.columns["a"], curve.columns["b"]
    assert a == pytest.approx((1 - b) ** 2 + (1 + b) ** 2 / 4, abs=1e-9)
    assert np.ptp(b) == pytest.approx(0.2)  # from a = 1 to the upper edge
    assert set(curve.columns["period"]) == {2.0}


def test_isolated_cycles_are_found_by_iteration():
    """x' = a x (1 - x): cycles of period 3 are born in a fold at a = 1 + sqrt(8), far from every other branch."""
    logistic = model({"x": "a*x*(1 - x) + q"}, {"x": 0.5}, {"a": 3.83, "q": 0.0}, kind="map")
    diagram = contin.phase(logistic, ("a", "q"), {"a": (3.8, 3.84), "q": (-1e-4, 1e-4)})
    region = diagram.region_at({"a": 3.835, "q": 0.0})
    assert [s.steps for s in region.states if s.unstable == 0] == [3]
    folds = [b for b in diagram.loci if b.locus == "LP"]
    at = [np.interp(0.0, b.columns["q"][np.argsort(b.columns["q"])], np.sort(b.columns["a"])) for b in folds]
    assert min(abs(np.array(at) - (1 + np.sqrt(8)))) < 1e-6


def test_a_cycle_is_one_with_its_shifts_and_is_no_fixed_point():
    system = contin.api.compiled(contin.load("henon"))
    fixed = contin.equilibrium(contin.load("henon"), parameters={"a": 0.7}).problem("a")
    problem = CycleProblem(fixed.__class__(iterate(system, 2), fixed.base, fixed.active, fixed.angle_periods))
    s, q = 0.7 / 0.7, 0.49 / 0.49 - 1 / 0.7  # sum and product of the two values of x
    x, y = np.roots([1.0, -s, q])
    z = np.array([x, 0.3 * y, y, 0.3 * x, 0.7])
    assert np.abs(problem.linearise(z)[0]).max() < 1e-14
    assert is_one(problem, z, problem.shifted(z, 1)[:-1])
    assert not is_shorter(problem, z)
    assert is_shorter(problem, np.array([x, y, x, y, 0.7]))
