"""Periodic orbits with jumps against closed forms: impacts, integrate-and-fire, maps made of events."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, fsolve

import contin
from contin.errors import InputError, NoSolutionError
from contin.model.model import Model

FIRE = Model(
    "fire", states={"v": 0}, parameters={"I": 1.5, "tau": 2.0}, equations={"v": "(I - v)/tau"},
    events=[{"when": "v - 1", "direction": "up", "set": {"v": 0}}],
)  # fmt: skip
R, OMEGA = 0.5, 2.0 * np.pi
TABLE = Model(
    "table", states={"x": 0, "v": 0.5}, parameters={"A": 0.03, "r": R}, equations={"x": "v", "v": "-1"},
    forcing={"period": "1"},
    events=[{"when": "x - A*sin(2*pi*t)", "direction": "down",
             "set": {"v": "-r*v + (1 + r)*2*pi*A*cos(2*pi*t)"}}],
)  # fmt: skip
FOLD = (1.0 - R) / (2.0 * (1.0 + R) * OMEGA)  # of the orbits of period 1: A w cos(phase) = (1 - r)/(1 + r) T/2


def jumping_map(**jumps):
    """A clock s with period 1, whose event maps the other states."""
    states = {"s": 0.0} | dict.fromkeys(jumps, 0.3)
    return Model(
        "map", states=states, parameters={"a": {"value": 1.5, "range": [0, 4]}},
        equations={"s": "1"} | dict.fromkeys(jumps, "0"),
        events=[{"when": "s - 1", "direction": "up", "set": {"s": 0} | jumps}],
    )  # fmt: skip


@pytest.fixture(scope="module")
def bouncing():
    start = contin.periodic_orbit(TABLE, {"x": 0.01, "v": 0.5}, {"A": 1.05 * FOLD})
    return contin.continuation(start, "A", (0.0, 0.07))


def test_integrate_and_fire_has_its_period_and_the_trivial_multiplier():
    orbit = contin.periodic_orbit(FIRE)
    assert orbit.events == (1,)
    branch = contin.continuation(orbit, "I", (1.01, 3.0))
    currents = branch.columns["I"]
    np.testing.assert_allclose(branch.columns["period"], 2.0 * np.log(currents / (currents - 1.0)), rtol=1e-10)
    np.testing.assert_allclose(branch.columns["v.max"], 1.0, rtol=1e-12)
    gone = 1.0 - 1.0 / currents  # exp(-T/tau); v = I (1 - exp(-t/tau))
    cycle = -np.log(gone)
    squares = currents**2 * (cycle - 2.0 * (1.0 - gone) + (1.0 - gone**2) / 2.0) / cycle
    np.testing.assert_allclose(branch.columns["norm"], np.sqrt(squares), rtol=1e-9)
    np.testing.assert_allclose(branch.columns["amplitude"], 0.5, rtol=1e-12)
    np.testing.assert_array_equal(branch.columns["frequency"], 1.0 / branch.columns["period"])
    np.testing.assert_array_equal(branch.orbit(0).multipliers, [1.0])
    assert [end.reason for end in branch.ends] == ["bound", "bound"]


@pytest.mark.seldom
def test_a_bouncing_ball_on_a_table_turns_and_doubles_where_it_must(bouncing):
    """du_+ = Dg X du is a product of two shears and impacts: determinant r^2, trace -1 + 1 at the doubling."""
    assert [p.label for p in bouncing.points] == ["LPC1", "PD1"]
    fold, flip = bouncing["LPC1"], bouncing["PD1"]
    assert fold.values["A"] == pytest.approx(FOLD, rel=1e-12)
    assert flip.values["A"] == pytest.approx(_flip(), rel=1e-10)
    for point in (fold, flip):
        assert len(point.eigenvalues) == 2
        assert np.prod(point.eigenvalues) == pytest.approx(R * R, rel=1e-9)
        assert abs(point.error) < 1e-10
    assert flip.normal_form["criticality"] == "supercritical"
    np.testing.assert_allclose(bouncing.columns["period"], 1.0, rtol=1e-9)


def _flip():
    """A at which the map of impacts (phase, velocity) has the multiplier -1, by differences of its closed form."""

    def trace(A):
        phase = np.arccos(FOLD / A)
        u = np.array([phase, 0.5])

        def back(u):
            phase, v = u
            x = A * np.sin(phase)
            height = lambda T: x + v * T - 0.5 * T * T - A * np.sin(phase + OMEGA * T)  # noqa: E731
            T = brentq(height, 0.8, 1.2, xtol=1e-15)
            return np.array([phase + OMEGA * (T - 1.0), -R * (v - T) + (1 + R) * A * OMEGA * np.cos(phase + OMEGA * T)])

        h = 1e-5
        columns = [(8 * (back(u + h * e) - back(u - h * e)) - back(u + 2 * h * e) + back(u - 2 * h * e)) / (12 * h)
                   for e in np.eye(2)]  # fmt: skip
        return np.trace(np.array(columns))

    return brentq(lambda A: trace(A) + 1.0 + R * R, 1.2 * FOLD, 1.8 * FOLD, xtol=1e-12)


def test_a_family_ends_where_its_orbit_grazes_the_table(bouncing):
    """The second family: h = h' = 0 within the flight, with the phase of the orbits of period 1."""
    end = next(e for e in bouncing.ends if e.reason == "grazing")
    assert "event 1 (x - A*sin(2*pi*t))" in end.text

    def equations(z):
        A, t = z
        phase = -np.arccos(FOLD / A)
        height = A * np.sin(phase) + 0.5 * t - 0.5 * t * t - A * np.sin(phase + OMEGA * t)
        return height, 0.5 - t - A * OMEGA * np.cos(phase + OMEGA * t)

    A, _ = fsolve(equations, [end.data["at"]["A"] * 1.001, 0.37], xtol=1e-12)
    assert end.data["at"]["A"] == pytest.approx(A, rel=1e-8)


def test_doubled_orbits_have_twice_the_period_and_the_events(bouncing):
    doubled = contin.continuation(bouncing["PD1"].switch(), "A", (0.0, 0.05))
    np.testing.assert_allclose(doubled.columns["period"], 2.0, rtol=1e-9)
    assert doubled.columns["unstable"][2] == 0
    assert doubled.ends[0].reason == "start"
    assert doubled.orbit(3).t[-1] == pytest.approx(2.0, rel=1e-9)
    simulated = contin.simulate(
        TABLE, {"x": doubled.orbit(3).columns["x"][0], "v": doubled.orbit(3).columns["v"][0]},
        {"A": float(doubled.columns["A"][3])}, time=1.0,
    )  # fmt: skip
    assert simulated.complete


def test_a_logistic_map_of_jumps_doubles_at_three():
    """x -> a x (1 - x): multiplier 2 - a, c = (P'')^2/4 + P'''/6 = a^2 at a = 3."""
    branch = contin.continuation(contin.periodic_orbit(jumping_map(x="a*x*(1 - x)")), "a", (1.2, 3.5))
    assert [p.label for p in branch.points] == ["PD1"]
    point = branch["PD1"]
    assert point.values["a"] == pytest.approx(3.0, abs=1e-10)
    c, error = point.normal_form["c_map"], point.normal_form["errors"]["c_map"]
    assert abs(c - 9.0) <= error < 1e-5
    np.testing.assert_allclose(np.sort(point.eigenvalues.real), [-1.0, 1.0], atol=1e-9)


@pytest.mark.seldom
def test_a_cubic_map_of_jumps_has_its_pitchfork_and_its_fold():
    """x -> a x - x^3: x = 0 loses stability at a = 1; x = a x + x^3 - x^5 folds at a = 3/4."""
    model = jumping_map(x="a*x + x^3 - x^5")
    rest = contin.continuation(contin.periodic_orbit(model, {"x": 0}, {"a": 0.9}), "a", (0.8, 1.2))
    assert [p.label for p in rest.points] == ["BPC1"]
    assert rest["BPC1"].values["a"] == pytest.approx(1.0, abs=1e-9)
    other = contin.continuation(rest["BPC1"].switch(), "a", (0.7, 1.1), settings={"max_step": 0.2})
    folds = [p.values["a"] for p in other.points if p.type == "LPC"]
    assert folds
    np.testing.assert_allclose(folds, 0.75, atol=1e-9)


def test_a_delayed_logistic_map_of_jumps_has_its_invariant_circle():
    """(x, y) -> (a x (1 - y), x): exp(+-i pi/3) at a = 2."""
    branch = contin.continuation(contin.periodic_orbit(jumping_map(x="a*x*(1 - y)", y="x")), "a", (1.3, 2.2))
    assert [p.label for p in branch.points] == ["NS1"]
    point = branch["NS1"]
    assert point.values["a"] == pytest.approx(2.0, abs=1e-9)
    assert np.abs(np.angle(point.eigenvalues[1:])).max() == pytest.approx(np.pi / 3.0, abs=1e-8)
    assert point.normal_form["criticality"] == "supercritical"


def test_an_oscillator_with_impacts_has_its_amplitude():
    """x'' - 2 d x' + x = 0 grows between impacts at x = -1, which take (1 - r) of the speed and add q."""
    model = Model(
        "impacts", states={"x": 0, "v": 1}, parameters={"d": 0.05, "r": 0.5, "q": 0.8},
        equations={"x": "v", "v": "2*d*v - x"},
        events=[{"when": "x + 1", "direction": "down", "set": {"v": "-r*v + q"}}],
    )  # fmt: skip
    d, r, q = 0.05, 0.5, 0.8
    w = np.sqrt(1.0 - d * d)

    def flown(v, T):
        c, s = np.exp(d * T) * np.cos(w * T), np.exp(d * T) * np.sin(w * T) / w
        return -(c - d * s) + s * v, (c + d * s) * v + s

    def closed(z):
        x, v = flown(*z)
        return x + 1.0, -r * v + q - z[0]

    orbit = contin.periodic_orbit(model)
    speed, period = fsolve(closed, [orbit.u[-1], orbit.period], xtol=1e-12)
    assert orbit.period == pytest.approx(period, rel=1e-10)
    branch = contin.continuation(orbit, "q", (0.75, 0.85))
    after = -r * flown(speed, period)[1] + q
    assert after == pytest.approx(speed)
    before = flown(speed, period)[1]
    slope = -r * np.exp(2.0 * d * period) * speed / before  # Liouville: det X = exp(2 d T), saltation r v+/v-
    row = int(np.argmin(np.abs(branch.columns["q"] - q)))
    assert branch.orbit(row).multipliers[1].real == pytest.approx(slope, rel=1e-8)


def izhikevich(c, d):
    return Model(
        "izhikevich", states={"v": -65, "u": -13}, parameters={"I": 10, "c": c, "d": d},
        equations={"v": "0.04*v^2 + 5*v + 140 - u + I", "u": "0.02*(0.2*v - u)"},
        events=[{"when": "v - 30", "direction": "up", "set": {"v": "c", "u": "u + d"}}],
    )  # fmt: skip


@pytest.mark.seldom
def test_spiking_begins_at_the_homoclinic_orbit_of_the_flow():
    """Izhikevich (2003), regular spiking: periods are those of simulations; the family ends at I = 3.774375, where the
    saddle v = -57.625 has a homoclinic orbit, whatever the reset."""
    branch = contin.continuation(contin.periodic_orbit(izhikevich(-65, 8)), "I", (3.5, 12), values={"I": [6.0]})
    end = next(e for e in branch.ends if e.reason == "homoclinic")
    assert abs(end.data["at"]["I"] - 3.774375) < 3.0 * end.data["error"] < 1e-5
    assert end.data["saddle"]["v"] == pytest.approx(-57.625, abs=1e-3)
    found = contin.simulate(izhikevich(-65, 8), parameters={"I": 6.0}, time=1500.0)
    assert np.diff([j.time for j in found.jumps])[-1] == pytest.approx(branch["UZ1"].values["period"], rel=1e-7)


def test_a_burst_is_one_orbit_with_five_events():
    orbit = contin.periodic_orbit(izhikevich(-50, 2))
    assert orbit.events == (1, 1, 1, 1, 1)
    found = contin.simulate(izhikevich(-50, 2), time=600.0)
    times = np.array([j.time for j in found.jumps])
    assert times[-1] - times[-6] == pytest.approx(orbit.period, rel=1e-6)
    assert "with 5 events" in str(orbit)


def test_what_has_no_orbit_with_jumps_is_told():
    with pytest.raises(NoSolutionError, match="no event happens"):
        contin.periodic_orbit(FIRE, parameters={"I": 0.5})
    with pytest.raises(NoSolutionError, match="infinitely many events"):
        contin.periodic_orbit(
            Model("ball", states={"x": 1, "v": 0}, parameters={"r": 0.8}, equations={"x": "v", "v": "-1"},
                  events=[{"when": "x", "direction": "down", "set": {"v": "-r*v"}}])
        )  # fmt: skip
    with pytest.raises(NoSolutionError, match="chaotic"):
        contin.periodic_orbit(jumping_map(x="a*x*(1 - x)"), parameters={"a": 3.9})
    with pytest.raises(InputError, match="from a simulation"):
        contin.periodic_orbit(FIRE, np.zeros((5, 1)), period=1.0)


def test_events_that_never_happen_are_told_as_such(monkeypatch):
    """A forced oscillator beside a wall that it never reaches: what is used up is the patience, not the method."""
    monkeypatch.setattr("contin.search.hybrid_orbit.BUDGET", 20_000)
    still = Model(
        "beside", states={"x": 0, "v": 0}, parameters={"w": 3.0},
        equations={"x": "v", "v": "-x - 0.1*v + 0.5*cos(w*t)"}, forcing={"period": "2*pi/w"},
        events=[{"when": "x - 1", "direction": "up", "set": {"v": "-v"}}],
    )  # fmt: skip
    with pytest.raises(NoSolutionError, match=r"no event happens .* Leave `events` out of the model"):
        contin.periodic_orbit(still, {"x": 0.0, "v": 0.0})
    with pytest.raises(NoSolutionError, match="no event happens from t = "):  # one impact, and rest
        contin.periodic_orbit(still, {"x": 0.9, "v": 2.0}, {"w": 9.0})


def test_spikes_between_the_samples_of_an_orbit_with_jumps_are_in_its_extremes_and_its_norm():
    """Van der Pol's equation at mu = 30, lifted to x = 2.2 at its right turn: y spikes for 1 % of the period."""
    model = Model(
        "lifted", states={"x": 2, "y": -0.1}, parameters={"mu": 30},
        equations={"x": "y", "y": "mu*(1 - x^2)*y - x"}, observables={"work": "x*y"},
        events=[{"when": "y", "direction": "down", "set": {"x": 2.2}}],
    )  # fmt: skip

    def rates(t, u):
        return [u[1], 30.0 * (1.0 - u[0] ** 2) * u[1] - u[0], u[0] ** 2 + u[1] ** 2]

    def returned(t, u):
        return u[1] if t > 1e-3 else -1.0

    returned.terminal, returned.direction = True, -1.0
    flight = solve_ivp(
        rates, (0.0, 90.0), [2.2, 0.0, 0.0], method="DOP853", rtol=1e-11, atol=1e-12, events=returned,
        dense_output=True,
    )  # fmt: skip
    times = (flight.t[:-1, None] + np.diff(flight.t)[:, None] * np.arange(20) / 20).ravel()
    x, y, _ = flight.sol(times)
    orbit = contin.periodic_orbit(model)
    found = contin.continuation(orbit, "mu", (30.0, 30.0001), settings={"steps": 1}).columns
    assert found["period"][0] == pytest.approx(flight.t[-1], rel=1e-9)
    assert found["y.max"][0] == pytest.approx(y.max(), rel=2e-6)
    assert found["y.min"][0] == pytest.approx(y.min(), rel=2e-6)
    assert found["work.max"][0] == pytest.approx((x * y).max(), rel=2e-6)
    assert found["norm"][0] == pytest.approx(np.sqrt(flight.y[2, -1] / flight.t[-1]), rel=1e-9)


def test_events_within_a_spike_between_samples_are_landed_on():
    """The same, and y jumps down where it rises through 30, twice in each spike: the orbit of three events closes."""
    model = Model(
        "clipped", states={"x": 2, "y": -0.1}, parameters={"h": 30},
        equations={"x": "y", "y": "30*(1 - x^2)*y - x"},
        events=[{"when": "y", "direction": "down", "set": {"x": 2.2}},
                {"when": "y - h", "direction": "up", "set": {"y": "0.8*y"}}],
    )  # fmt: skip
    orbit = contin.periodic_orbit(model)
    assert sorted(orbit.events) == [1, 2, 2]
    branch = contin.continuation(orbit, "h", (30.0, 30.0001), settings={"steps": 1})
    assert branch.columns["y.max"][0] == pytest.approx(30.0, rel=1e-10)
