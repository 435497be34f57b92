"""Notes on a whole curve in two parameters: which of them explain changes of `unstable`, and which do not."""

from __future__ import annotations

import numpy as np
import pytest

import contin
from contin.loci.equilibria.equilibrium_locus import LocusProblem

WORDS = "something is so all along the curve"
CUSP = {
    "name": "cusp", "states": {"x": 2.0}, "parameters": {"p": 6.0, "q": 1.0}, "equations": {"x": "p + q*x - x^3"},
}  # fmt: skip


@pytest.fixture(scope="module")
def fold():
    line = contin.continuation(contin.equilibrium(contin.load(CUSP)), "p", (-6, 6), settings={"stop_at": ("LP",)})
    return line["LP1"]


@pytest.mark.parametrize(("kind", "noted"), [("shortcomings", True), ("remarks", False)])
def test_only_eigenvalues_that_stay_critical_explain_changes_without_a_label(fold, monkeypatch, kind, noted):
    """What was not computed accurately is no reason for a change: both have their notes."""

    def changed(self, z, unstable, eigenvalues):
        return unstable + (np.arange(len(z)) >= len(z) // 2)

    monkeypatch.setattr(LocusProblem, "recounted", changed)
    monkeypatch.setattr(LocusProblem, "remarks", lambda *given: ())
    monkeypatch.setattr(LocusProblem, kind, lambda *given: (WORDS,))
    curve = contin.continuation(fold.locus(("p", "q")), ("p", "q"), {"p": (-6, 6), "q": (0.5, 1.5)})
    assert not curve.points
    assert WORDS in curve.notes
    assert any("without a label that explains it" in note for note in curve.notes) is noted
    assert curve.unexplained == int(noted)
