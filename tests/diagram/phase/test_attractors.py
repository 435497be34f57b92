"""Stable states that no branch from the start leads to: trajectories settle on them, and regions are named by them."""

from unittest import mock

import numpy as np
import pytest

import contin
from contin.diagram.phase import attractors
from contin.diagram.phase.attractors import reached
from contin.diagram.phase.states import State
from contin.lowering import compile_system
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.search import orbit_by_simulation as by_simulation
from contin.simulate import trajectory
from tests.problems.follow import model

BOX = {"c": (0.2, 1.2), "b": (0.3, 1.4)}


@pytest.fixture(scope="module")
def langford():
    """Langford (1979), without the term that breaks its rotation symmetry. In r = |(x, y)| and z it is a planar system.

    Orbits are at z = b, r^2 = (c + a b - b^3/3)/(1 + b/4), a = 0.95, for all of the box, with determinant
    2 r^2 (1 + b/4) > 0 and trace a - b^2 - r^2/4: a torus bifurcation where that vanishes. Its Hopf points, z = b on
    the upper branch of equilibria c + a z - z^3/3 = 0, are at b > 1.7, outside the box.
    """
    equations = {
        "x": "(z - b)*x - 3.5*y",
        "y": "3.5*x + (z - b)*y",
        "z": "c + 0.95*z - z^3/3 - (x^2 + y^2)*(1 + 0.25*z)",
    }
    form = model(equations, {"x": 0.0, "y": 0.0, "z": 1.8}, {"c": 0.3, "b": 0.7})
    return contin.phase(form, ("c", "b"), BOX)


def trace(c, b):
    return 0.95 - b**2 - 0.25 * (c + 0.95 * b - b**3 / 3) / (1 + 0.25 * b)


@pytest.mark.seldom
def test_the_curve_of_tori_is_found_though_no_hopf_point_is_in_the_box(langford):
    (curve,) = [locus for locus in langford.loci if locus.locus == "NS"]
    np.testing.assert_allclose(trace(curve.columns["c"], curve.columns["b"]), 0.0, atol=1e-8)
    assert [end.reason for end in curve.ends] == ["bound", "bound"]


@pytest.mark.parametrize("seed", range(12))
def test_the_orbit_is_stable_where_the_trace_is_negative(langford, seed):
    c, b = np.random.default_rng(seed).uniform([0.2, 0.3], [1.2, 1.4])
    assert langford.region_at({"c": c, "b": b}).stable_orbits == int(trace(c, b) < 0.0)


def test_beyond_it_there_is_an_attractor_without_a_period(langford):
    beyond = langford.region_at({"c": 0.9, "b": 0.6})
    assert (beyond.stable, beyond.stable_orbits, beyond.aperiodic) == (0, 0, 1)
    assert beyond.words == "1 equilibrium, unstable, an aperiodic attractor"


def test_the_equilibrium_that_is_far_from_the_start_is_named_where_it_exists(langford):
    # c + 0.95 z - z^3/3 has three roots where c < 2/3 0.95^(3/2); the lowest one, z < 0 < b, is stable
    fold = 2 / 3 * 0.95**1.5
    for c in (fold - 0.05, fold + 0.05):
        assert langford.region_at({"c": c, "b": 1.2}).stable == int(c < fold)


def test_an_attractor_without_a_period_is_followed_for_long_once():
    """Lorenz (1963) at r = 28: of two trajectories the first is followed until it is plain that it never settles.

    A later search that knows of it spends less than a tenth of the time, whichever trajectories it starts.
    """
    equations = {"x": "10*(y - x)", "y": "r*x - y - x*z", "z": "x*y - 8/3*z"}
    system = compile_system(model(equations, {"x": 1.0, "y": 1.0, "z": 20.0}, {"r": 28.0}))
    problem = EquilibriumProblem(system, np.array([28.0]), 0)
    starts = [np.array([1.0, 2.0, 20.0]), np.array([-5.0, -6.0, 25.0])]
    times = []

    def counted(*args, **kwargs):
        times.append(args[3])
        return whole(*args, **kwargs)

    whole = trajectory.integrate
    with mock.patch.object(attractors, "integrate", counted), mock.patch.object(by_simulation, "integrate", counted):
        first = attractors.reached(problem, [], 28.0, starts)
        long = sum(times)
        times.clear()
        again = attractors.reached(problem, [], 28.0, starts[::-1], wild=first.wild)
    assert (first.aperiodic, again.aperiodic) == (1, 1)
    assert first.seeds == again.seeds == ()
    assert len(again.wild) == 1
    assert sum(times) < 0.1 * long


def test_a_trajectory_that_turns_ever_faster_is_given_up():
    """x + i y turns at the rate of its size and grows slowly, so a time scale of its start takes ever more steps."""
    equations = {"x": "0.02*x - y*(1 + x^2 + y^2)", "y": "x*(1 + x^2 + y^2) + 0.02*y + 0*r"}
    system = compile_system(model(equations, {"x": 1.0, "y": 0.0}, {"r": 0.0}))
    problem = EquilibriumProblem(system, np.array([0.0]), 0)
    allowed = []

    def counted(*args, **kwargs):
        allowed.append(kwargs.get("budget"))
        return whole(*args, **kwargs)

    whole = trajectory.integrate
    with mock.patch.object(attractors, "integrate", counted), mock.patch.object(by_simulation, "integrate", counted):
        found = attractors.reached(problem, [], 0.0, [np.array([0.05, 0.0])])
    assert (found.seeds, found.rests, found.aperiodic) == ((), (), 0)
    assert max(budget or 0 for budget in allowed) <= 400_000


def test_trajectories_leave_rest_and_invariant_axes_behind():
    """Predators and prey, of which only total rest is known: starts spread by the natural sizes of the states."""
    model = contin.Model(
        "bazykin", states={"x": 0.5, "y": 0.3}, parameters={"a": 0.32, "d": 0.3},
        equations={"x": "x - x*y/(1 + a*x) - 0.01*x^2", "y": "-y + x*y/(1 + a*x) - d*y^2"},
    )  # fmt: skip
    nothing = contin.equilibrium(model, {"x": 0.0, "y": 0.0})
    problem = nothing.problem("a")
    rest = State({}, 1, np.zeros(2))
    found = reached(problem, [rest], 0.32).seeds
    at = [seed.z[:2] for seed in found if seed.problem.kind == "equilibrium"]
    assert any(np.allclose(u, (100.0, 0.0), rtol=1e-6) for u in at)  # along the axis, from beside rest
    assert any(u.min() > 1.0 for u in at)  # both


def test_regions_in_which_nothing_stable_was_found_are_named():
    model = contin.Model("fold", states={"x": -0.5}, parameters={"p": -0.25, "q": 0.0}, equations={"x": "p + q + x^2"})
    diagram = contin.phase(model, ("p", "q"), {"p": (-1.0, 1.0), "q": (-0.5, 0.5)})
    bare = [f"{r.name}{r.number + 1}" for r in diagram.regions if not r.stable]
    assert len(bare) == 1
    assert any(note.startswith(f"no stable state was found in the regions {bare[0]}:") for note in diagram.notes)
