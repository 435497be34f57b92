"""Curves of special orbits by shooting: closed forms of piecewise-smooth flows, and agreement with collocation."""

from math import pi, tanh

import numpy as np
import pytest
from scipy.optimize import brentq

import contin
from contin import api
from contin.errors import InputError
from contin.loci.shooting.shot_locus import ShotLocusProblem
from contin.model.model import Model
from tests.problems.shooting.oscillators import bautin_family, forced_family, forced_orbit, half_turn, relays_in_phase
from tests.problems.shooting.test_families import IN_PHASE, PERIODS


def curve(point, names, first, second, **options):
    return api.continuation(point.locus(), names, dict(zip(names, (first, second), strict=True)), **options)


@pytest.mark.seldom
def test_folds_of_the_bautin_form_end_at_its_generalised_hopf_point():
    """r' = b1 r + b2 r^3 - r^5: orbits fold on b1 = -b2^2/4, b2 > 0."""
    folds = curve(bautin_family()["LPC1"], ("b1", "b2"), (-1, 1), (-0.5, 2))
    np.testing.assert_allclose(folds.columns["b1"], -(folds.columns["b2"] ** 2) / 4.0, atol=1e-10)
    np.testing.assert_allclose(folds.columns["period"], 2 * pi / 1.3, rtol=1e-10)
    assert {end.reason for end in folds.ends} == {"bound", "hopf"}
    assert not folds.points
    assert folds.effort["evaluations"] <= 4.0 * folds.steps  # measured 3.0


def test_the_equations_jacobian_is_their_derivative():
    """For every type, at a point beside the curve, against differences of the residual; with crossings and without."""
    pair, tori = relays_in_phase("c", 1.3, 1.55, c=1.4), relays_in_phase("e", -0.15, 0.1)
    cases = ((pair["BPC1"], ("c", "d")), (tori["NS1"], ("e", "d")), (bautin_family()["LPC1"], ("b1", "b2")))
    for point, names in cases:
        (seed,) = point.locus(names)
        problem, z = seed.problem, seed.z.copy()
        scale = problem.initial_scale(z, (-1.0, 1.0))
        where = problem.curve.unknowns(z)
        keep = where[problem.curve.orbits.n :]  # single states of symmetric orbits: the order of crossings changes
        if point.type == "LPC":
            keep = where
        z[keep] += 1e-3 * scale[keep] * np.sin(np.arange(keep.size) + 1.0)
        problem = problem.settled(z, scale)
        found = problem.curve.linearise(z, scale)
        for place in keep:
            step = np.zeros(z.size)
            step[place] = 1e-5 * scale[place]
            ends = [problem.curve.linearise(z + side * step, scale).residual for side in (1.0, -1.0)]
            column = found.jacobian[:, int(np.flatnonzero(where == place)[0])]
            size = max(1.0, float(np.abs(column).max()))
            np.testing.assert_allclose((ends[0] - ends[1]) / 2e-5, column, atol=1e-3 * size)


@pytest.mark.parametrize("segments", [pytest.param(None, marks=pytest.mark.long), 3])
@pytest.mark.seldom
def test_period_doublings_of_the_roessler_system_pass_through_published_points(segments):
    """Points of AUTO-07p (NTST 50, EPSL 1e-10), b = 2; by one segment and by several."""
    line = api.continuation(api.equilibrium(contin.load("classics/roessler"), None, {"a": 0.2}), "a", (0.0, 0.5))
    settings = {"method": "shooting"} | ({} if segments is None else {"intervals": segments})
    family = api.continuation(line["HB1"].switch(), "a", (0.0, 0.35), settings=settings)
    doublings = curve(family["PD1"], ("c", "a"), (3.9, 7.1), (0.05, 0.5), values={"c": [5, 6, 7]})
    found = {round(p.values["c"]): p.values["a"] for p in doublings.points if p.type == "UZ"}
    assert found == pytest.approx({5: 0.2634689961, 6: 0.2202132777, 7: 0.1903102199}, abs=2e-10)


@pytest.mark.seldom
def test_folds_of_an_orbit_with_two_formulas_lie_where_its_return_map_says():
    """(r^2)' = al - r^2 for y > 0, be r^4 for y < 0, each for a time pi: r^2 -> A + E r^2 -> its Moebius image.

    With E = exp(-pi) and A = al (1 - E) the quadratic for r^2 has a double root where al be = tanh(pi/4)/pi.
    """
    model = Model(
        "halves", states={"x": 1.0, "y": 0.0}, parameters={"al": 1.0, "be": 0.1},
        definitions={"R": "x^2 + y^2", "g": "(al - R)/(2*R) if y > 0 else be*R/2"},
        equations={"x": "x*g - y", "y": "y*g + x"},
    )  # fmt: skip
    family = api.continuation(api.periodic_orbit(model), "be", (0.05, 0.4))
    folds = curve(family["LPC1"], ("al", "be"), (0.2, 3), (0.05, 1))
    np.testing.assert_allclose(folds.columns["al"] * folds.columns["be"], tanh(pi / 4) / pi, rtol=1e-9)
    assert folds.columns["al"].min() < 0.22
    assert folds.columns["al"].max() > 2.9


@pytest.mark.seldom
def test_two_relays_in_phase_branch_along_a_known_curve():
    """They cross the surface together, in either order; the half-turn of their difference has the eigenvalue 1."""
    branching = curve(relays_in_phase("c", 1.3, 1.55, c=1.4)["BPC1"], ("c", "d"), (0.2, 6), (0.05, 0.5))
    for c, d in zip(branching.columns["c"], branching.columns["d"], strict=True):
        trace, determinant = half_turn(c, d)
        # rows end at a Newton correction of 1e-9; where two cross together corrections shrink slowly (2e-8 was seen)
        assert abs(trace) == pytest.approx(1.0 + determinant, abs=2e-7)
    assert np.ptp(branching.columns["d"]) > 0.44
    np.testing.assert_allclose(branching.columns["x1.max"], branching.columns["x2.max"], rtol=1e-7)


def test_two_relays_in_phase_lose_stability_to_a_torus_along_a_known_line():
    """The determinant of the difference's half-turn is 1 where e = -d/2; R4 where its trace is +-sqrt(2)."""
    tori = curve(relays_in_phase("e", -0.15, 0.1)["NS1"], ("e", "d"), (-0.5, 0.5), (0.15, 0.3))
    d = tori.columns["d"]
    np.testing.assert_allclose(tori.columns["e"], -d / 2.0, atol=1e-9)
    traces = np.array([half_turn(0.9, x, -x / 2.0)[0] for x in d])
    np.testing.assert_allclose(tori.columns["cos.theta"], traces**2 / 2.0 - 1.0, atol=1e-7)
    assert [p.label for p in tori.points] == ["R41"]
    resonance = brentq(lambda x: half_turn(0.9, x, -x / 2.0)[0] ** 2 - 2.0, 0.2, 0.3, xtol=1e-14)
    assert tori["R41"].values["d"] == pytest.approx(resonance, abs=1e-9)
    assert tori["R41"].error < 1e-8


def test_period_doublings_of_the_forced_bilinear_oscillator_are_those_of_exact_pieces():
    doublings = curve(forced_family()["PD1"], ("w", "k"), (2, 3), (1, 12))
    np.testing.assert_allclose(doublings.columns["period"] * doublings.columns["w"], 2 * pi, rtol=1e-12)
    for row in (0, len(doublings) // 2, -1):
        w, k = float(doublings.columns["w"][row]), float(doublings.columns["k"][row])
        u, doubling = forced_orbit(doublings.z[row][:2], w, k)
        np.testing.assert_allclose(u, doublings.z[row][:2], atol=1e-8)
        assert doubling == pytest.approx(0.0, abs=1e-7)


@pytest.mark.seldom
def test_in_phase_metronomes_branch_along_a_curve_through_known_points():
    mu = IN_PHASE[0.8, 0.01]
    orbit = api.periodic_orbit(contin.load("metronomes/pair"), "in-phase", {"beta": 0.8, "eps": 0.01, "mu": mu + 0.5})
    family = api.continuation(orbit, "mu", (mu - 0.5, mu + 0.7))
    branching = curve(family["BPC1"], ("mu", "beta"), (2, 14), (0.29, 0.85), values={"beta": [0.3]})
    found = branching["UZ1"].values
    assert found["mu"] == pytest.approx(IN_PHASE[0.3, 0.01], abs=1e-8)
    assert found["period"] == pytest.approx(PERIODS[0.3, 0.01], abs=1e-8)


def test_what_has_no_curve_says_so():
    model = Model(
        "driven", states={"x": 0.0}, parameters={"k": 1.0, "w": 1.0}, equations={"x": "-k*x + cos(w*t)"},
        forcing={"period": "2*pi/w"},
    )  # fmt: skip
    family = api.continuation(api.periodic_orbit(model, method="shooting"), "k", (0.5, 2), values={"k": [1.5]})
    with pytest.raises(InputError, match="UZ of orbits by shooting has no curve"):
        family["UZ1"].locus(("k", "w"))


def test_folds_born_at_a_bautin_point_of_a_piecewise_flow_are_followed_by_shooting():
    """The orbits never reach the wall at x = 3, but a flow with switches has no orbits by collocation: b1 = -b2^2/4."""
    model = Model(
        "walled", states={"x": 0.0, "y": 0.0}, parameters={"b1": -0.5, "b2": 0.5}, definitions={"r": "x^2 + y^2"},
        equations={"x": "b1*x - y + b2*x*r - x*r^2 - (x - 3 if x > 3 else 0)", "y": "x + b1*y + b2*y*r - y*r^2"},
    )  # fmt: skip
    box = {"b1": (-0.3, 0.3), "b2": (-0.9, 0.9)}
    line = api.continuation(api.equilibrium(model), "b1", (-0.6, 0.6))
    hopf = api.continuation(line["HB1"].locus(("b1", "b2")), ("b1", "b2"), box)
    (seed,) = hopf["GH1"].locus(("b1", "b2"))
    folds = api.continuation(seed, ("b1", "b2"), box)
    assert isinstance(folds.problem, ShotLocusProblem)
    assert folds.locus == "LPC"
    np.testing.assert_allclose(folds.columns["b1"], -(folds.columns["b2"] ** 2) / 4, atol=1e-8)
    assert folds.columns["b2"].max() == pytest.approx(0.9)
    assert folds.points == ()
