"""An error in one curve, at one start or at one point of a phase diagram costs only that.

The Bogdanov-Takens form x' = y, y' = p + q x + x^2 - x y: folds on q^2 = 4 p, Hopf points on p = 0, q < 0.
"""

from importlib import import_module

import numpy as np
import pytest

import contin
from contin.loci.equilibria.equilibrium_locus import LocusProblem
from tests.problems.follow import model

TAKENS = model({"x": "y", "y": "p + q*x + x^2 - x*y"}, {"x": -1.0, "y": 0.0}, {"p": -0.5, "q": -0.5})
BOX = {"p": (-1.0, 0.5), "q": (-1.0, 1.0)}
SEARCH, SURVEY = (import_module(f"contin.diagram.phase.{name}") for name in ("search", "survey"))


def diagram(**options):
    return contin.phase(TAKENS, ("p", "q"), BOX, **{"orbits": False, **options})


def singular_values():
    return np.linalg.svd(np.full((2, 2), np.nan))


@pytest.mark.parametrize("chunks", [0, 2])
def test_an_error_on_the_hopf_curve_leaves_the_folds_and_the_regions_between_them(monkeypatch, chunks):
    march, done = LocusProblem.march, []

    def failing(self, *arguments):
        if self.locus == "HB":
            done.append(1)
            if len(done) > chunks:
                singular_values()
        return march(self, *arguments)

    monkeypatch.setattr(LocusProblem, "march", failing)
    monkeypatch.setattr(LocusProblem, "maximum_chunk", 5)
    found = diagram()
    (folds,) = [b for b in found.loci if b.locus == "LP"]
    p, q = folds.columns["p"], folds.columns["q"]
    np.testing.assert_allclose(q**2, 4 * p, atol=1e-8)
    assert (q.min(), q.max()) == pytest.approx((-1.0, 1.0))
    for branch in found.loci:
        if branch.locus == "HB":  # what there is of it is right
            np.testing.assert_allclose(branch.columns["p"], 0.0, atol=1e-8)
    assert any("an error inside contin at contin/" in n and "SVD did not converge" in n for n in found.notes)
    assert {r.total for r in found.regions} == {0, 2}
    assert sum(r.area for r in found.regions) == pytest.approx(1.0, abs=1e-6)
    assert found.region_at({"p": 0.4, "q": 0.0}).total == 0


@pytest.mark.seldom
def test_an_error_at_one_start_leaves_the_others(monkeypatch):
    whole, brought = diagram(), SEARCH.brought

    def failing(problem, start, *rest):
        return singular_values() if start[0][0] > 0 else brought(problem, start, *rest)

    monkeypatch.setattr(SEARCH, "brought", failing)
    found = diagram(start=[{"x": 1.0, "y": 0.0}, {"x": -1.0, "y": 0.0}])
    assert sorted(b.locus for b in found.loci) == sorted(b.locus for b in whole.loci)
    place = "start 1: an error inside contin at contin/diagram/phase/search.py:"
    assert any(note.startswith(place) for note in found.notes)


@pytest.mark.seldom
def test_an_error_in_the_trajectories_of_a_point_leaves_its_equilibria(monkeypatch):
    whole = diagram()
    monkeypatch.setattr(SURVEY, "reached", lambda *_: singular_values())
    found = diagram(orbits=True)
    assert {(r.total, r.stable) for r in found.regions} == {(r.total, r.stable) for r in whole.regions}
    assert any(note.startswith("states at p = ") and "contin/diagram/phase/survey.py:" in note for note in found.notes)


def test_an_error_in_cutting_the_box_leaves_the_curves(monkeypatch):
    monkeypatch.setattr(SURVEY, "arrangement", lambda *_: singular_values())
    found = diagram()
    assert sorted(b.locus for b in found.loci) == ["HB", "LP"]
    assert found.regions == ()
    assert any(note.startswith("the regions: an error inside contin at contin/") for note in found.notes)
