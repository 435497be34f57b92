"""Phase diagrams with periodic orbits: normal forms whose regions are known, and the averaged pair of metronomes."""

import numpy as np
import pytest

import contin
from contin.search.orbit_by_simulation import orbit_by_simulation
from tests.problems.follow import model


@pytest.fixture(scope="module")
def bautin():
    """|w|^2 = s: orbits where p + q s - s^2 = 0; Hopf points on p = 0, folds of orbits on p = -q^2/4 with q > 0."""
    growth = "(p + q*(x^2 + y^2) - (x^2 + y^2)^2)"
    form = model({"x": f"x*{growth} - y", "y": f"y*{growth} + x"}, {"x": 0.0, "y": 0.0}, {"p": -0.5, "q": 0.5})
    return contin.phase(form, ("p", "q"), {"p": (-0.5, 0.5), "q": (-1.0, 1.0)})


@pytest.mark.seldom
def test_the_bautin_form_has_its_three_regions_and_their_areas(bautin):
    assert sorted(b.locus for b in bautin.loci) == ["HB", "LPC"]
    kinds = {(r.stable, r.stable_orbits, r.orbits): r for r in bautin.regions}
    assert set(kinds) == {(1, 0, 0), (0, 1, 1), (1, 1, 2)}
    assert kinds[1, 1, 2].area == pytest.approx(1 / 12 / 2, rel=1e-3)  # the integral of q^2/4 from 0 to 1
    assert kinds[0, 1, 1].area == pytest.approx(0.5, rel=1e-3)
    assert kinds[1, 1, 2].words == "1 equilibrium, stable, 1 stable orbit"


@pytest.mark.parametrize("seed", range(12))
def test_orbits_of_the_bautin_form_are_the_positive_roots(bautin, seed):
    p, q = np.random.default_rng(seed).uniform([-0.5, -1.0], [0.5, 1.0])
    roots = [s.real for s in np.roots([-1.0, q, p]) if abs(s.imag) < 1e-12 and s.real > 0.0]
    region = bautin.region_at({"p": p, "q": q})
    assert (region.orbits, region.stable_orbits) == (len(roots), sum(q - 2 * s < 0.0 for s in roots))


def test_without_orbits_only_the_equilibria_divide_the_box():
    growth = "(p + q*(x^2 + y^2) - (x^2 + y^2)^2)"
    form = model({"x": f"x*{growth} - y", "y": f"y*{growth} + x"}, {"x": 0.0, "y": 0.0}, {"p": -0.5, "q": 0.5})
    diagram = contin.phase(form, ("p", "q"), {"p": (-0.5, 0.5), "q": (-1.0, 1.0)}, orbits=False)
    assert [b.locus for b in diagram.loci] == ["HB"]
    assert sorted(r.words for r in diagram.regions) == ["1 equilibrium, stable", "1 equilibrium, unstable"]


@pytest.mark.seldom
def test_the_cycle_of_the_bogdanov_takens_form_lives_between_hopf_and_homoclinic_curve():
    """x' = y, y' = p + q x + x^2 - x y: Hopf points p = 0, q < 0; homoclinic orbits p = -6/25 q^2 + O(q^3)."""
    form = model({"x": "y", "y": "p + q*x + x^2 - x*y"}, {"x": -1.0, "y": 0.0}, {"p": -0.5, "q": -0.5})
    diagram = contin.phase(form, ("p", "q"), {"p": (-0.3, 0.1), "q": (-0.5, 0.2)})
    (loops,) = [b for b in diagram.loci if b.locus == "HOM"]
    between = [r for r in diagram.regions if r.stable_orbits == 1]
    assert [(r.stable, r.total) for r in between] == [(0, 2)]
    # area = integral of 6/25 q^2 (1 + O(q)) from -1/2 to 0, of the box
    assert between[0].area * 0.4 * 0.7 == pytest.approx(6 / 25 / 24, rel=0.1)
    rows = np.argsort(loops.columns["q"])
    border = np.interp(-0.3, loops.columns["q"][rows], loops.columns["p"][rows])
    for side in (1.0, -1.0):  # a simulation agrees with the border
        at = np.array([border + 0.004 * side, -0.3])
        region = diagram.region_at({"p": at[0], "q": at[1]})
        assert region.stable_orbits == (1 if side > 0 else 0)
    system = contin.api.compiled(form)
    orbit = orbit_by_simulation(system, np.array([0.0, 0.01]), np.array([border + 0.004, -0.3]), np.zeros(2))
    assert orbit.period > 2 * np.pi


@pytest.mark.seldom
def test_a_short_curve_of_homoclinic_orbits_leads_from_its_bogdanov_takens_point_to_the_folds():
    """The forced oscillator, averaged (Holmes and Rand 1978), with r = x^2 + y^2: folds g^2 = r ((1 - r)^2 + s^2),
    (1 - r)(1 - 3 r) + s^2 = 0, and Hopf points r = 1/2, s^2 > 1/4 meet at s = g = 1/2. The homoclinic orbits from there
    soon become those of a saddle-node: their curve ends on the folds.
    """
    square = "(x^2 + y^2)"
    form = model(
        {"x": f"x - s*y - x*{square}", "y": f"s*x + y - y*{square} - g"}, {"x": 0.0, "y": 0.0}, {"s": 0.5, "g": 0.2}
    )
    diagram = contin.phase(form, ("s", "g"), {"s": (0.4, 0.65), "g": (0.4, 0.65)})
    (loops,) = [b for b in diagram.loci if b.locus == "HOM"]
    (end,) = [p for p in loops.points if p.type == "NCH"]
    s, g = end.values["s"], end.values["g"]
    folds = [r for r in np.roots([3.0, -4.0, 1.0 + s**2]) if np.isreal(r)]
    assert min(abs(np.sqrt(r * ((1 - r) ** 2 + s**2)) - g) for r in np.real(folds)) < 1e-8
    assert loops.columns["s"].min() == pytest.approx(0.5, abs=0.01)  # the first loop is a small one
    assert not any("homoclinic" in note for note in diagram.notes)
    between = [r for r in diagram.regions if (r.stable, r.stable_orbits) == (1, 1)]
    assert [r.total for r in between] == [3]


@pytest.mark.long  # every day: its regions in docs/metronomes/open_questions.py (check_regions)
def test_every_beating_state_of_the_averaged_pair_has_its_region():
    """At beta = 0.8 the small beats live from 4.4699 to the Hopf points, the large ones from 3.2093, the turning ones
    from 0.7153 on; curves through these values by shooting in the equations of the amplitudes. Total rest and the
    anti-phase state, which no curve leads to from the in-phase one, are stable throughout: trajectories find them."""
    slow = contin.average(contin.load("metronomes/pair"), form="stokes")
    box = {"mu": (3.0, 5.0), "beta": (0.78, 0.82)}
    diagram = contin.phase(slow, ("mu", "beta"), box, start="in-phase", parameters={"mu": 5, "beta": 0.8})
    assert sorted(b.locus for b in diagram.loci) == ["BP", "HB", "HOM", "LPC"]
    stable = {}  # equilibria, orbits: with mirror images
    for mu in (3.1, 3.8, 4.5, 4.6, 4.9):
        region = diagram.region_at({"mu": mu, "beta": 0.8})
        stable[mu] = region.stable, region.stable_orbits
    assert stable == {3.1: (2, 1), 3.8: (2, 2), 4.5: (2, 3), 4.6: (4, 1), 4.9: (3, 1)}
    for locus, value in (("HOM", 4.469914868654), ("LPC", 3.2092895356)):
        (curve,) = [b for b in diagram.loci if b.locus == locus]
        rows = np.argsort(curve.columns["beta"])
        beta, mu = (curve.columns[name][rows] for name in ("beta", "mu"))
        near = np.argsort(np.abs(beta - 0.8))[:5]
        assert np.polynomial.Polynomial.fit(beta[near] - 0.8, mu[near], 4)(0.0) == pytest.approx(value, abs=2e-5)


@pytest.mark.long
def test_stable_states_of_the_averaged_pair_are_those_that_random_starts_settle_on():
    """Equilibria and orbits, mirror images counted, that 500 random starts of the amplitude equations (Dormand-Prince,
    written for this) settled on at each point. The turning orbits end at the fold through (1.887, 0.85907)."""
    slow = contin.average(contin.load("metronomes/pair"), form="stokes")
    box = {"mu": (0.05, 8.0), "beta": (0.5, 0.9)}
    diagram = contin.phase(slow, ("mu", "beta"), box, start=["in-phase", "anti-phase"])
    settled = {
        (0.92, 0.877): (2, 0), (0.92, 0.84): (2, 1), (1.1127, 0.8927): (2, 0), (0.1946, 0.6323): (2, 2),
        (0.4423, 0.8373): (2, 1), (3.2854, 0.8491): (2, 2), (3.9825, 0.8373): (2, 3), (4.0967, 0.8373): (4, 1),
        (6.583, 0.7892): (3, 1), (5.5993, 0.8772): (3, 0), (2.638, 0.6323): (2, 0), (0.091, 0.8373): (4, 0),
    }  # fmt: skip
    for (mu, beta), expected in settled.items():
        region = diagram.region_at({"mu": mu, "beta": beta})
        assert (region.stable, region.stable_orbits) == expected, (mu, beta)
    curves = [b for b in diagram.loci if b.locus == "LPC"]
    turning = [np.column_stack([b.columns["mu"], b.columns["beta"]]) for b in curves]
    assert min(np.hypot(*((rows - [1.887, 0.85907]) / [8.0, 0.4]).T).min() for rows in turning) < 0.05


@pytest.mark.long
def test_regions_beside_a_symmetric_bogdanov_takens_point():
    """x'' = m x + n x' - x^3 - x^2 x': beside the origin, homoclinic loops on n = 4 m/5, folds of large orbits on
    n = 0.752 m, Hopf points on n = m (Carr, Applications of Centre Manifold Theory, 1981, section 4.2). A line of the
    search passes through the origin, where the branch point is doubly degenerate."""
    form = model({"x": "y", "y": "m*x + n*y - x^3 - x^2*y"}, {"x": 0, "y": 0}, {"m": -1, "n": -1},
                 symmetries={"flip": {"x": "-x", "y": "-y"}})  # fmt: skip
    size = 0.02
    diagram = contin.phase(form, ("m", "n"), {"m": (-size, size), "n": (-size, size)})
    slopes = {"HOM": 0.8, "LPC": 0.752}
    for locus, slope in slopes.items():
        (curve,) = [b for b in diagram.loci if b.locus == locus]
        ends = curve.columns["n"][[0, -1]] / curve.columns["m"][[0, -1]]
        assert ends[np.argmax(curve.columns["m"][[0, -1]])] == pytest.approx(slope, abs=3e-3)
    area = {}
    for region in diagram.regions:
        key = region.stable, region.total, region.stable_orbits
        area[key] = area.get(key, 0.0) + region.area
    assert area[1, 1, 0] == pytest.approx(0.25, abs=2e-3)
    assert area[0, 1, 1] == pytest.approx(0.25, abs=2e-3)
    assert area[0, 3, 1] == pytest.approx(0.125, abs=2e-3)
    assert area[2, 3, 1] == pytest.approx((1 - 0.752) / 8, abs=2e-3)
    assert area[2, 3, 0] == pytest.approx((2 + 0.752) / 8, abs=2e-3)


@pytest.mark.parametrize("declared", [False, pytest.param(True, marks=pytest.mark.long)])
@pytest.mark.seldom
def test_a_hopf_curve_that_turns_back_onto_itself_at_a_symmetric_point_bounds_regions(declared):
    """x' = y, y' = m x + n y - x^3 - x^2 y: Hopf points of (+-sqrt m, 0) on m = n > 0, followed from one to the other.

    In the plane the curve comes back the way it went, at Bogdanov-Takens' point in between two rows. It cuts the box:
    no equilibrium is stable in n > max(m, 0), and the outer cycle is (Guckenheimer and Holmes 1983, section 7.3).
    """
    half_turn = {"half-turn": {"x": "-x", "y": "-y"}} if declared else {}
    equations = {"x": "y", "y": "m*x + n*y - x^3 - x^2*y"}
    form = model(equations, {"x": 0.1, "y": 0.0}, {"m": -0.5, "n": 0.2}, symmetries=half_turn)
    diagram = contin.phase(form, ("m", "n"), {"m": (-1.0, 1.0), "n": (-1.0, 1.0)})
    restless = [r for r in diagram.regions if (r.stable, r.stable_orbits) == (0, 1)]
    areas = {r.total: r.area for r in restless}
    assert areas == {1: pytest.approx(1 / 4, rel=1e-6), 3: pytest.approx(1 / 8, rel=1e-6)}
    for m, n, stable, cycles in ((0.7, 0.65, 2, 1), (0.7, 0.75, 0, 1), (0.7, 0.5, 2, 0)):
        region = diagram.region_at({"m": m, "n": n})
        assert (region.stable, region.stable_orbits) == (stable, cycles)


@pytest.mark.seldom
def test_a_curve_of_planar_orbits_in_space_is_known_again():
    """z' = m - z^2 - x^2 - y^2 - z^3/5, w' = (z - r + 2i) w: cycles |w|^2 = m - r^2 - r^3/5 on z = r, torus at r = 0.

    z rests on all orbits: what is left of its extent is rounding, and is no mark of an orbit.
    """
    equations = {"x": "(z - r)*x - 2*y", "y": "2*x + (z - r)*y", "z": "m - z^2 - x^2 - y^2 - 0.2*z^3"}
    form = model(equations, {"x": 0.01, "y": 0.0, "z": 0.3}, {"m": 0.2, "r": 0.1})
    diagram = contin.phase(form, ("m", "r"), {"m": (-0.2, 0.8), "r": (-0.8, 0.8)})
    assert [b.locus for b in diagram.loci].count("NS") == 1


@pytest.mark.seldom
def test_trajectories_start_where_the_equations_have_values():
    """u' = a/(1 + v^n) - u and v' likewise have no values for negative states; P/N has none at N = 0."""
    toggle = model({"u": "a/(1 + v^n) - u", "v": "a/(1 + u^n) - v"}, {"u": 3.0, "v": 0.1}, {"a": 4.0, "n": 2.0})
    hunters = {"N": "N*(1 - N) - P*N/(0.1 + N)", "P": "s*P*(1 - h*P/N)"}
    ratio = model(hunters, {"N": 0.3, "P": 0.3}, {"s": 0.1, "h": 0.8})
    for form, box in ((toggle, {"a": (0.5, 6.0), "n": (1.0, 4.0)}), (ratio, {"s": (0.01, 0.4), "h": (0.6, 1.6)})):
        diagram = contin.phase(form, tuple(box), box)
        assert not diagram.notes
        assert not diagram.check.disagreed
