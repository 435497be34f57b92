"""Meshes of orbits: interpolation between them, correction after a change, and when there is none."""

from math import ceil

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from contin import api
from contin.continuation.sample import Frame, Sample
from contin.continuation.settings import Settings
from contin.model.model import Model
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.problems.orbits.linearised.linear import OrbitLinear
from contin.problems.orbits.mesh.adaption import choose_mesh, estimate
from contin.problems.orbits.mesh.layout import Profile, Transfer, node_times

BOUNDS = (-0.5, 1.0)


@pytest.fixture(scope="module")
def born():
    """The Hopf point of x' + i y' = (r - s + i (1 + s / 2)) (x + i y), s = x^2 + y^2: cycles turn at constant speed."""
    model = Model(
        "stuart", states={"x": 0, "y": 0}, parameters={"r": -0.5}, definitions={"s": "x^2 + y^2"},
        equations={"x": "(r - s)*x - (1 + 0.5*s)*y", "y": "(1 + 0.5*s)*x + (r - s)*y"},
    )  # fmt: skip
    return api.continuation(api.equilibrium(model), "r", BOUNDS)["HB1"]


@pytest.mark.parametrize("m", [2, 4, 7])
def test_transfer_is_exact_for_polynomials_of_the_scheme_s_degree(m):
    generator = np.random.default_rng(m)
    old, new = (h / h.sum() for h in (generator.uniform(0.5, 2.0, 7), generator.uniform(0.5, 2.0, 11)))
    p, q = np.polynomial.Polynomial(generator.normal(size=m + 1)), np.polynomial.Polynomial([1.0, -2.0])
    values = np.stack([p(node_times(old, m)), q(node_times(old, m))], axis=1)
    at = node_times(new, m)
    np.testing.assert_allclose(Transfer.to_mesh(m, old, new)(values), np.stack([p(at), q(at)], axis=1), atol=1e-12)
    assert at[0] == 0.0
    assert at[-1] == 1.0
    np.testing.assert_allclose(at[m:-1:m], np.cumsum(new)[:-1], rtol=1e-14)


def test_a_march_corrects_an_origin_that_was_interpolated(born):
    family = api.continuation(born.switch(), "r", BOUNDS, values={"r": [0.5]})
    problem = family.problem
    exact = problem.profile(next(p for p in family.points if p.type == "UZ").z)
    guess = exact.on_mesh(np.full(9, 1.0 / 9.0)).vector()
    scale = problem.initial_scale(guess, BOUNDS)
    origin = Sample(guess, problem.tangents(guess, scale)[0], np.zeros(4), 0, np.empty(0, complex))
    chunk = problem.march(origin, None, 0.0, Frame(scale), 1e-3, 2, BOUNDS, Settings(), None)

    def residual(z):
        return float(np.abs(OrbitLinear(problem, z, scale, guess).residual).max())

    assert residual(guess) > 1e-6
    assert residual(chunk.z[0]) < 1e-10
    assert len(chunk) == 3
    again = problem.march(chunk.sample(0), None, 0.0, Frame(scale), 1e-3, 2, BOUNDS, Settings(), None)
    np.testing.assert_array_equal(again.z[0], chunk.z[0])  # on the family already: left as it is
    # a whole Newton step at the origin and chord iterations on it; then as many a step
    assert again.evaluations <= 1 + 2 * 2


def test_an_even_mesh_of_fixed_size_is_kept_where_the_orbit_turns_at_constant_speed(born, monkeypatch):
    marches = []
    march = OrbitProblem.march

    def counted(self, *arguments):
        marches.append(march(self, *arguments))
        return marches[-1]

    monkeypatch.setattr(OrbitProblem, "march", counted)
    settings = {"intervals": 12, "step": 0.006, "max_step": 0.006, "steps": 300}
    family = api.continuation(born.switch(), "r", BOUNDS, settings=settings)
    lengths = np.array([family.problem.profile(z).h for z in family.z])
    np.testing.assert_allclose(lengths, 1.0 / 12.0, rtol=1e-12)
    assert family.steps > 100
    assert len(marches) <= ceil(family.steps / 120) + 3  # the states outgrow their sizes, too
    assert family.effort["evaluations"] <= 2.1 * family.steps + 10


def test_states_that_almost_die_out_are_resolved_relative_to_their_own_size():
    """Rosenzweig and MacArthur's prey falls to 1e-20 of its largest number: the period, against logarithms of both."""
    capacity, mortality = 30.0, 0.5
    model = Model(
        "chase", states={"x": 1, "y": 0.5}, parameters={"K": 2.0, "m": mortality},
        equations={"x": "x*(1 - x/K) - x*y/(1 + x)", "y": "y*(x/(1 + x) - m)"},
    )  # fmt: skip
    line = api.continuation(api.equilibrium(model), "K", (1.5, capacity))
    cycles = api.continuation(line["HB1"].switch(), "K", (1.5, capacity))
    assert cycles.ends[1].reason == "bound"
    assert cycles.columns["x.min"][-1] < 1e-18 * cycles.columns["x.max"][-1]

    def logarithms(t, z):
        x, y = np.exp(z)
        return [1.0 - x / capacity - y / (1.0 + x), x / (1.0 + x) - mortality]

    def upwards(t, z):
        return z[0]

    upwards.direction = 1
    flow = solve_ivp(logarithms, (0, 700), [0.5, -2.0], method="DOP853", rtol=1e-12, atol=1e-12, events=upwards)
    returns = flow.t_events[0]
    assert cycles.columns["period"][-1] == pytest.approx(returns[-1] - returns[-2], rel=1e-8)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_state_that_is_zero_up_to_rounding_has_no_part_in_the_mesh(sign):
    """As of a frame that keeps an imaginary part at zero: noise of one sign made errors of 1e3, and useless meshes."""
    h = np.full(30, 1.0 / 30.0)
    t = 2.0 * np.pi * node_times(h, 4)
    circle = np.stack([np.cos(t), np.sin(t)], axis=1)
    noise = sign * 10.0 ** np.random.default_rng(3).uniform(-31.0, -22.0, len(t))
    noise[-1] = noise[0]
    alone = Profile(4, circle, 1.0, h, 0.0)
    beside = Profile(4, np.column_stack([circle, noise]), 1.0, h, 0.0)
    assert estimate(beside, np.ones(3))[0] == estimate(alone, np.ones(2))[0]
    meshes = choose_mesh(alone, np.ones(2), 1e-7, None), choose_mesh(beside, np.ones(3), 1e-7, None)
    np.testing.assert_array_equal(meshes[1].h, meshes[0].h)
    small = estimate(beside, np.array([1.0, 1.0, 1e-22]))  # of a state of its own, with that size, it does count
    assert small[0] > 1e-3
