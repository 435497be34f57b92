"""Phase diagrams of piecewise-smooth flows: curves of orbits by shooting, against quadrature of the radius."""

import numpy as np
import pytest

import contin
from contin.loci.shooting.shot_locus import ShotLocusProblem
from tests.problems.shooting.bent import BENT, JUMPING, TOUCHED, gain, orbits

BOX = {"b1": (-0.5, 0.3), "b2": (-0.6, 1.4)}


@pytest.fixture(scope="module")
def bent():
    return contin.phase(BENT, ("b1", "b2"), BOX)


@pytest.mark.seldom
def test_its_folds_are_followed_by_shooting_across_the_touching_orbit(bent):
    (folds,) = [b for b in bent.loci if b.locus == "LPC"]
    assert isinstance(folds.problem, ShotLocusProblem)
    b1, b2, y = (folds.columns[name] for name in ("b1", "b2", "y.max"))
    assert b2.max() == pytest.approx(1.4)
    inside = b2 < TOUCHED
    np.testing.assert_allclose(b1[inside], -(b2[inside] ** 2) / 4.0, atol=1e-8)
    row = int(np.argmax(b2))
    assert gain(b1[row], 1.4, y[row]) == pytest.approx(0.0, abs=1e-8)


@pytest.mark.parametrize("seed", range(8))
def test_its_regions_have_the_orbits_that_the_return_map_has(bent, seed):
    b1, b2 = np.random.default_rng(seed).uniform([-0.5, 0.0], [0.1, 1.4])
    region = bent.region_at({"b1": b1, "b2": b2})
    assert (region.orbits, region.stable_orbits) == orbits(b1, b2)
    assert region.stable == int(b1 < 0.0)


@pytest.mark.seldom
def test_orbits_beyond_sliding_ones_are_found_by_simulation_and_what_is_missing_is_said():
    """The family from the Hopf point ends where orbits slide; for b1 > 0 trajectories settle on an orbit beyond."""
    diagram = contin.phase(JUMPING, ("b1", "b2"), BOX)
    region = diagram.region_at({"b1": 0.15, "b2": 1.0})
    assert (region.orbits, region.stable_orbits) == (1, 1)
    (note,) = [text for text in diagram.notes if text.startswith("families of orbits could not be followed")]
    assert "the solution slides along it" in note
