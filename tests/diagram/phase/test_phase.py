"""Phase diagrams of systems whose regions are known."""

import networkx as nx
import numpy as np
import pytest

import contin
from contin.errors import InputError
from tests.problems.follow import model

CUSP = model({"x": "p + q*x - x^3"}, {"x": 0.0}, {"p": 0.0, "q": -0.5})
CUSP_BOX = {"p": (-1.0, 1.0), "q": (-1.0, 1.5)}
TAKENS = model({"x": "y", "y": "p + q*x + x^2 - x*y"}, {"x": -1.0, "y": 0.0}, {"p": -0.5, "q": -0.5})
TAKENS_BOX = {"p": (-1.0, 0.5), "q": (-1.0, 1.0)}


@pytest.fixture(scope="module")
def cusp():
    return contin.phase(CUSP, ("p", "q"), CUSP_BOX)


@pytest.fixture(scope="module")
def takens():
    return contin.phase(TAKENS, ("p", "q"), TAKENS_BOX, orbits=False)


def test_the_cusp_has_a_bistable_wedge_of_the_right_size(cusp):
    assert sorted((r.stable, r.total) for r in cusp.regions) == [(1, 1), (2, 3)]
    wedge = next(r for r in cusp.regions if r.total == 3)
    # |p| < 2 (q/3)^(3/2): its area is the integral of 4 (q/3)^(3/2) = 4 3^(-3/2) (2/5) q^(5/2)
    exact = 4 * 3**-1.5 * 0.4 * 1.5**2.5 / (2.0 * 2.5)
    assert wedge.area == pytest.approx(exact, rel=1e-3)
    assert [p.type for b in cusp.loci for p in b.points] == ["CP"]


@pytest.mark.parametrize("seed", range(20))
def test_regions_of_the_cusp_have_as_many_equilibria_as_the_cubic_has_roots(cusp, seed):
    p, q = np.random.default_rng(seed).uniform([-1.0, -1.0], [1.0, 1.5])
    roots = np.roots([-1.0, 0.0, q, p])
    region = cusp.region_at({"p": p, "q": q})
    assert region.total == int(np.sum(np.abs(roots.imag) < 1e-9))


def test_the_bogdanov_takens_form_has_its_regions_and_neighbours(takens):
    # x^2 + q x + p = 0; Hopf points on p = 0, q < 0. No state; saddle and stable; saddle and unstable, twice
    kinds = sorted((r.total, r.stable) for r in takens.regions)
    assert kinds == [(0, 0), (2, 0), (2, 1)]
    graph = takens.graph
    assert isinstance(graph, nx.Graph)
    names = {b.name: b.locus for b in takens.loci}
    for i, j, data in graph.edges(data=True):
        change = abs(graph.nodes[i]["states"] - graph.nodes[j]["states"])
        assert ("LP" in {names[c] for c in data["curves"]}) == (change == 2)
    assert sum(r.area for r in takens.regions) == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("seed", range(20))
def test_stability_in_the_bogdanov_takens_form_is_that_of_the_jacobian(takens, seed):
    p, q = np.random.default_rng(seed).uniform([-1.0, -1.0], [0.5, 1.0])
    roots = [x.real for x in np.roots([1.0, q, p]) if abs(x.imag) < 1e-12]
    jacobians = [np.array([[0.0, 1.0], [q + 2 * x, -x]]) for x in roots]
    stable = sum(bool(np.all(np.linalg.eigvals(a).real < 0)) for a in jacobians)
    region = takens.region_at({"p": p, "q": q})
    assert (region.total, region.stable) == (len(roots), stable)


@pytest.mark.seldom
def test_images_under_a_symmetry_are_counted_and_their_curves_drawn_once():
    flip = model({"x": "p*x + q*x^3 - x^5"}, {"x": 0.0}, {"p": -0.5, "q": 0.5}, symmetries={"flip": {"x": "-x"}})
    diagram = contin.phase(flip, ("p", "q"), {"p": (-1.0, 1.0), "q": (-1.0, 1.0)})
    assert sorted(b.locus for b in diagram.loci) == ["BP", "LP"]
    # folds p = -q^2/4 with q > 0: five states between them and the pitchforks p = 0
    assert sorted((r.total, r.stable) for r in diagram.regions) == [(1, 1), (3, 2), (5, 3)]
    assert {p.type for b in diagram.loci for p in b.points} == {"DP"}


def test_a_diagram_without_curves_is_one_region():
    diagram = contin.phase(model({"x": "p + q - x"}, {"x": 0.0}, {"p": 0.0, "q": 0.0}), ("p", "q"), CUSP_BOX)
    assert diagram.loci == ()
    (region,) = diagram.regions
    assert region.words == "1 equilibrium, stable"


def test_the_report_and_the_picture_name_regions_and_points(cusp):
    text = str(cusp)
    assert "cusp at p = " in text
    assert "2 of 3 equilibria stable" in text
    figure = cusp.plot()
    (axes,) = figure.axes
    written = {t.get_text(): t for t in axes.texts}
    assert {r.name for r in cusp.regions} | {"CP"} == set(written)
    explained = [t.get_text() for legend in figure.legends for t in legend.get_texts()]
    for region in cusp.regions:
        assert f"{region.name}  {region.words}" in explained
        place = dict(zip(("p", "q"), written[region.name].get_position(), strict=True))
        assert cusp.region_at(place).name == region.name
    assert (axes.get_xlim(), axes.get_ylim()) == (CUSP_BOX["p"], CUSP_BOX["q"])


@pytest.mark.parametrize("pair", [("p", "p"), ("p",)])
def test_a_phase_diagram_needs_two_parameters(pair):
    with pytest.raises(InputError, match="two parameters"):
        contin.phase(CUSP, pair, CUSP_BOX)


WHOLE = pytest.param({"mu": (0.05, 8), "beta": (0.05, 1)}, {"TZ", "DP", "BT", "CP", "ZH", "GH"}, marks=pytest.mark.long)


@pytest.mark.parametrize(("box", "points"), [({"mu": (2, 8), "beta": (0.4, 1)}, set()), WHOLE])
@pytest.mark.seldom
def test_the_diagram_of_the_averaged_pair(box, points):
    """Points of codimension two lie at small mu, in the whole box."""
    slow = contin.average(contin.load("metronomes/pair"), form="stokes")
    diagram = contin.phase(
        slow, ("mu", "beta"), box, start=["in-phase", "anti-phase"], parameters={"mu": 8, "beta": 0.8}, orbits=False
    )
    above = diagram.region_at({"mu": 4.0, "beta": 0.97})  # beta > 3 a^2/(16 pi b): total rest only
    assert (above.total, above.stable) == (1, 1)
    both = diagram.region_at({"mu": 7.0, "beta": 0.9})
    assert (both.total, both.stable) == (5, 3)  # rest, in-phase and anti-phase, and unstable small partners of these
    below = diagram.region_at({"mu": 4.0, "beta": 0.5})  # mu < mu_c: in-phase has lost its stability
    assert (below.total, below.stable) == (7, 2)
    for i, j in diagram.graph.edges:  # a fold or a pitchfork changes the number of states by two or four
        assert abs(diagram.regions[i].total - diagram.regions[j].total) in (0, 2, 4, 6)
    places = {p.type for b in diagram.loci for p in b.points}
    assert points <= places
    assert sum("imaginary all along" in note for note in diagram.notes) == 2  # one for each of the two lines


@pytest.mark.parametrize("form", [pytest.param("stokes", marks=pytest.mark.long), "polar"])  # stokes: above
@pytest.mark.seldom
def test_the_pair_has_the_same_states_in_every_form(form):
    """Rest is one state, stable everywhere; amplitudes are no states of their own with their signs turned."""
    slow = contin.average(contin.load("metronomes/pair"), form=form)
    box = {"mu": (2.0, 8.0), "beta": (0.8, 1.2)}
    diagram = contin.phase(slow, ("mu", "beta"), box, start=["in-phase", "anti-phase"], orbits=False)
    counts = {(r.total, r.stable): r.area for r in diagram.regions}
    assert set(counts) == {(7, 2), (7, 4), (5, 3), (1, 1)}
    assert sum(counts.values()) == pytest.approx(1.0, abs=1e-5)
    assert diagram.check.followed > 5
    assert diagram.check.disagreed == ()


@pytest.mark.seldom
def test_curves_that_end_at_a_point_and_come_back_cut_the_plane_there():
    """Two coupled pitchforks: branch points of the states that a symmetry exchanges lie on m = 3 k and m = -k.

    x = y = sqrt(m) is stable for m > -k, x = -y = sqrt(m - 2 k) for m > 3 k; both curves end at m = k = 0 (where the
    kernel has two dimensions) and come back as those of the mirror images.
    """
    coupled = model(
        {"x": "m*x - x^3 - k*(x - y)", "y": "m*y - y^3 - k*(y - x)"}, {"x": 0.1, "y": 0.1}, {"m": -1.0, "k": 0.2}
    )
    found = contin.phase(coupled, ("m", "k"), {"m": (-1.0, 2.0), "k": (-1.0, 1.0)}, orbits=False)
    regions = sorted((region.stable, region.total, round(region.area, 5)) for region in found.regions)
    parts = [(1, 1, 5 / 24), (2, 3, 1 / 8), (2, 3, 1 / 6), (2, 5, 1 / 18), (2, 5, 1 / 12), (4, 9, 13 / 36)]
    assert regions == [(stable, total, round(area, 5)) for stable, total, area in parts]


@pytest.mark.seldom
def test_a_branch_with_a_row_on_a_line_in_the_other_parameter_is_followed_along_it():
    """x'' = a x - x^3 - d x' + 0.3 x^2 x': rest loses its stability at d = 0, where a < 0, and only there.

    With orbits, states where two lines cross are labelled values: rows that lie on the other line to the digit.
    """
    wells = model({"x": "y", "y": "a*x - x^3 - d*y + 3/10*x^2*y"}, {"x": 1.0, "y": 0.0}, {"a": 1.0, "d": 0.2})
    found = contin.phase(wells, ("a", "d"), {"a": (-1.0, 2.0), "d": (-0.3, 0.5)})
    alone = sorted((region.stable, round(region.area, 5)) for region in found.regions if region.total == 1)
    assert alone == [(0, round(1 / 8, 5)), (1, round(5 / 24, 5))]
