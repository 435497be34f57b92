"""How often an orbit visits a saddle: once, however often it is slow there before it goes away."""

from dataclasses import replace

import numpy as np
import pytest

import contin
from contin.model.model import Model
from contin.problems.orbits.ends.agreement import error_of_limit
from contin.problems.orbits.ends.distances import distances, extent_of
from contin.problems.orbits.ends.extrapolated import Limit
from contin.problems.orbits.ends.saddles import saddles_and_elsewhere, saddles_near
from contin.problems.orbits.ends.stays import stays, time_away
from contin.problems.orbits.march.slow_passage import slowest_points


@pytest.fixture(scope="module")
def beside_a_loop():
    """An orbit beside the homoclinic orbit x^2 (1 - x) = y^2 of Sandstede's system, its problem and sizes of states."""
    model = Model(
        "loop", states={"x": 0.66, "y": 0.0}, parameters={"p": 0.0},
        equations={"x": "-x + 2*y + x^2 + p*x*(2 - 3*x)", "y": "2*x - y - 3*x^2 + 3*x*y/2 - 2*p*y"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "p", (-1.0, 1.0))
    orbits = contin.continuation(line["HB1"].switch(), "p", (-1.0, 1.0), settings={"intervals": 60})
    problem = orbits.problem
    profile = problem.profile(orbits["HOM1"].z)
    return problem, profile, problem.state_sizes(profile)


def from_saddle(problem, profile, sizes):
    """How far each interval is from the saddle, in the orbit's extent."""
    gaps = distances(problem, np.zeros(2), profile.u[:-1], sizes) / extent_of(profile, sizes)
    return gaps.reshape(len(profile.h), -1).min(axis=1)


def passed_in(profile, times):
    """The same closed curve, whose intervals are passed in so many times the time."""
    spans = profile.h * times
    return replace(profile, h=spans / spans.sum(), period=profile.period * spans.sum())


def test_an_orbit_that_is_slow_twice_on_one_visit_visits_once(beside_a_loop):
    """Hindmarsh and Rose's neuron is slow near its saddle and again on the manifold that leads away from it."""
    problem, profile, sizes = beside_a_loop
    (saddle,) = saddles_near(problem, profile, sizes)
    assert saddle.visits == 1
    gaps = from_saddle(problem, profile, sizes)
    twice = passed_in(profile, np.where((gaps > 0.03) & (gaps < 0.08), 30.0, 1.0))
    assert len(slowest_points(problem, twice, sizes)) > 1
    (saddle,) = saddles_near(problem, twice, sizes)
    assert saddle.visits == 1


def test_a_period_of_two_turns_visits_twice(beside_a_loop):
    problem, profile, sizes = beside_a_loop
    h = np.concatenate([profile.h, profile.h]) / 2.0
    twice = replace(profile, u=np.vstack([profile.u, profile.u[1:]]), h=h, period=2.0 * profile.period)
    (saddle,) = saddles_near(problem, twice, sizes)
    assert saddle.visits == 2


def test_visits_that_do_not_become_longer_are_none_of_an_approach(beside_a_loop):
    """An orbit homoclinic to a saddle may pass by it once more on its way, as that of Terman's bursting neuron does."""
    problem, profile, sizes = beside_a_loop
    gaps = from_saddle(problem, profile, sizes)
    h = np.concatenate([profile.h, profile.h]) / 2.0
    twice = replace(profile, u=np.vstack([profile.u, profile.u[1:]]), h=h, period=2.0 * profile.period)
    near, turn = np.tile(gaps < 0.05, 2), np.repeat([1.0, 2.0], len(gaps))
    for longer, count in ((near & (turn == 1.0), 1), (near & (turn == 2.0), 1), (near, 2)):
        later = passed_in(twice, np.where(longer, 1.001, 1.0))
        (saddle,), elsewhere = saddles_and_elsewhere(problem, later, sizes, twice)
        assert saddle.visits == count
        assert not elsewhere
        assert sum(time for time, _ in stays(problem, saddle, later, sizes)) < later.period


def test_where_else_it_is_slow_is_told_and_the_time_away_tells_whether_that_grows(beside_a_loop):
    problem, profile, sizes = beside_a_loop
    gaps = from_saddle(problem, profile, sizes)
    there = np.arange(len(gaps)) == np.argmin(abs(gaps - 0.27))
    slow, slower = (passed_in(profile, np.where(there, times, 1.0)) for times in (100.0, 200.0))
    assert saddles_near(problem, slow, sizes) == []
    saddles, elsewhere = saddles_and_elsewhere(problem, slow, sizes)
    assert elsewhere
    assert len(saddles) == 1
    gained = slower.period - slow.period
    away = time_away(problem, saddles, slower, sizes) - time_away(problem, saddles, slow, sizes)
    assert away == pytest.approx(gained)


def test_an_approach_of_tens_of_thousands_of_rows_ends_with_its_error():
    """Steps of 0.02 of a period of 850: the limit 4e-4 away is known to 3 %, the nearest that is followed to is not."""
    limit = Limit(step=-4e-4, drift=1.5e-9, spiral=False, rate=0.0079, doubt=0.0)
    error = error_of_limit(limit, moved=-6e-8, gained=0.02, growth=0.0, width=4.0, failed=False, first=True)
    assert error == pytest.approx(3 * 1e-5)
    assert error_of_limit(limit, -6e-8, gained=2.0, growth=0.0, width=4.0, failed=False, first=True) is None
