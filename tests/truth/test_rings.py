"""Every half of every branch leaves a branch point at which only high orders pick the branches, in any coordinates."""

import numpy as np
import pytest

from tests.diagram.crossings import solutions
from tests.truth.rings import Ring


def complaint(ring: Ring) -> str:
    """What is wrong with the ring's diagram; '' where all halves are there, each once, and symmetry maps them alike."""
    diagram = ring.diagram()
    failed = [f"{b.name}: {e.text}" for b in diagram for e in b.ends if e.reason == "corrector"]
    if failed:
        return f"halves of {failed} are lost"
    if diagram.notes and not all("budget" in note for note in diagram.notes):
        return f"{diagram.notes}"
    found = ring.cells_of(solutions(diagram, 0.95 * ring.far))
    if len(found) != 1 + 2 * ring.branches:
        return f"{len(found)} passages instead of {1 + 2 * ring.branches}"
    if min(np.abs(a - b).max() for k, a in enumerate(found) for b in found[:k]) < 1e-6:
        return "a branch is followed twice"
    for image in (np.roll(found, 1, axis=1), found[:, ::-1], -found):
        if any(np.abs(found - v).max(axis=1).min() > 1e-8 for v in image):
            return "an image of a solution is no solution of the diagram"
    return ""


CASES = [Ring(5, 1e-6, seed=1), pytest.param(Ring(8, 1e6, seed=2), marks=pytest.mark.long)]


@pytest.mark.parametrize("ring", CASES, ids=str)
@pytest.mark.seldom
def test_every_half_leaves_the_branch_point(ring):
    assert complaint(ring) == ""


@pytest.mark.long
def test_every_half_leaves_the_branch_point_of_rings_of_3_to_12_cells():
    rings = [
        Ring(n, 10.0**power, seed) for n in range(3, 13) for power in range(-6, 7, 3) for seed in (None, n, 100 + n)
    ]
    complaints = {str(ring): text for ring in rings if (text := complaint(ring))}
    assert complaints == {}
