"""The second look at regions: what it finds where a curve is missing, and letters that stand for one set of states."""

import numpy as np
import pytest

import contin
from contin import api
from contin.diagram.phase import search
from contin.diagram.phase.checks import Plane, alike, checked
from contin.diagram.phase.orbit_checks import orbits_checked
from contin.diagram.phase.plane import Face
from contin.diagram.phase.states import State

BOX = {"p": (-1.0, 1.0), "q": (-1.0, 1.5)}
SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


@pytest.fixture(scope="module")
def cusp():
    return contin.Model("cusp", states={"x": 0.5}, parameters={"p": 0.0, "q": 0.0}, equations={"x": "p + q*x - x^3"})


def plane_of(model):
    problem = api.equilibrium(model).problem("p")
    return Plane(problem, ("p", "q"), np.array([-1.0, -1.0]), np.array([2.0, 2.5]))


def test_a_box_without_its_folds_is_found_out(cusp):
    """Everything as one region: the upper state of the wedge ends at a fold on some of the ways across."""
    plane, point = plane_of(cusp), np.array([0.5, 0.9])
    upper = np.array([np.sqrt(1.25)])
    outcome = checked(plane, Face(SQUARE, (), 1.0, point), point, [(upper, 0), (-upper, 0)], "A1")
    assert outcome.followed == 6
    ends = [plane.followed(upper, point, np.array([x, 0.9])) for x in (0.05, 0.95)]
    assert ends[0] is None  # p = -0.9: beyond the fold
    assert float(ends[1][0]) == pytest.approx(max(np.roots([-1.0, 0.0, 1.25, 0.9]).real), abs=1e-9)
    assert 0 < len(outcome.disagreed) < 6


def test_states_are_alike_where_one_continues_to_the_other(cusp):
    plane = plane_of(cusp)
    a, b = np.array([0.9, 0.4]), np.array([0.9, 0.2])
    real = [np.roots([-1.0, 0.0, -1.0 + 2.5 * y, 0.8]) for _, y in (a, b)]
    here, there = (np.array([r[np.abs(r.imag) < 1e-9].real[0]]) for r in real)
    assert alike(plane, a, b, [here], [there])
    assert not alike(plane, a, b, [here], [-there])


def test_regions_of_the_cusp_are_checked_and_fill_the_box(cusp):
    diagram = contin.phase(cusp, ("p", "q"), BOX, orbits=False)
    assert diagram.check.followed >= 6
    assert diagram.check.disagreed == ()
    assert sum(r.area for r in diagram.regions) == pytest.approx(1.0, abs=1e-6)
    assert "0 disagreed" in str(diagram)
    assert diagram.as_data()["check"] == {"followed": diagram.check.followed, "orbits": 0, "disagreed": 0}
    corners = [{"p": p, "q": q} for p in (-0.999, 0.999) for q in (-0.999, 1.499)]
    assert all(diagram.region_at(corner) is not None for corner in corners)


def test_one_letter_is_one_set_of_states():
    """x' = p - x^2 twice, far apart: one stable state of two on either side, but not the same one."""
    model = contin.Model(
        "apart", states={"x": 0.5}, parameters={"p": 0.25, "q": 0.0},
        equations={"x": "(p - 0.1)*(p + 0.1) - (x - 3*p)^2"},
    )  # fmt: skip
    diagram = contin.phase(model, ("p", "q"), {"p": (-1.0, 1.0), "q": (0.0, 1.0)}, start=[{"x": 1.0}], orbits=False)
    sides = [r for r in diagram.regions if r.total == 2]
    assert len({r.name for r in sides}) == len(sides)


BAUTIN = {
    "x": "(m + n*(x^2 + y^2) - (x^2 + y^2)^2)*x - y", "y": "(m + n*(x^2 + y^2) - (x^2 + y^2)^2)*y + x",
}  # fmt: skip


def test_a_box_without_the_curves_at_which_orbits_end_is_found_out():
    """r' = r (m + n r^2 - r^4): an orbit where m > 0, or n > 0 and m > -n^2/4; everything as one region."""
    model = contin.Model("bautin", states={"x": 0.0, "y": 0.0}, parameters={"m": 0.3, "n": 0.5}, equations=BAUTIN)
    rest = api.equilibrium(model, {"x": 0.0, "y": 0.0})
    plane = Plane(rest.problem("m"), ("m", "n"), np.array([-0.6, -1.0]), np.array([1.0, 2.5]))
    radius = np.sqrt((0.5 + np.sqrt(0.25 + 1.2)) / 2.0)
    angle = np.linspace(0.0, 2.0 * np.pi, 101)
    orbit = api.periodic_orbit(model, radius * np.array([np.cos(angle), np.sin(angle)]).T, period=2.0 * np.pi)
    seed = orbit.seed("m")
    state = State({}, 0, seed.z[:0], 1, (seed.problem, seed.z))
    point = np.array([0.9, 0.6])
    whole = orbits_checked(plane, Face(SQUARE, (), 1.0, point), point, [state], "A1")
    assert whole.led == 2
    assert len(whole.disagreed) >= 1
    assert all("comes to rest" in text for text in whole.disagreed)
    strip = np.array([[0.65, 0.02], [0.98, 0.02], [0.98, 0.98], [0.65, 0.98]])  # m > 0
    inside = orbits_checked(plane, Face(strip, (), 0.3, point), point, [state], "A1")
    assert (inside.led, inside.disagreed) == (2, ())


@pytest.mark.parametrize("places", [0, 4])
@pytest.mark.seldom
def test_lines_through_what_is_found_wrong_lead_to_the_curve_that_was_missed(places, monkeypatch):
    """Rest loses its stability at d = 0, a < 0, which a search in the first parameter alone does not see."""
    monkeypatch.setattr(search, "AGAIN", places)
    seeds, run, explored = search.LociSearch.seeds, search.LociSearch.run, []

    def half_blind(self, axis, value):
        return [] if axis == 1 and not explored else seeds(self, axis, value)

    monkeypatch.setattr(search.LociSearch, "seeds", half_blind)
    monkeypatch.setattr(search.LociSearch, "run", lambda self: explored.append(run(self)))
    wells = contin.Model(
        "wells", states={"x": 1.0, "y": 0.0}, parameters={"a": 1.0, "d": 0.2},
        equations={"x": "y", "y": "a*x - x^3 - d*y + 3/10*x^2*y"},
    )  # fmt: skip
    found = contin.phase(wells, ("a", "d"), {"a": (-1.0, 2.0), "d": (-0.3, 0.5)}, orbits=False)
    stable = sum(region.area for region in found.regions if region.total == 1 and region.stable)
    assert (stable == pytest.approx(5 / 24, abs=1e-5)) == bool(places)
    assert bool(found.check.disagreed) == (not places)
    assert sum(locus.locus == "HB" for locus in found.loci) == (2 if places else 1)
