"""What cannot be told about a special orbit is a note of its branch, never silence."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from contin.normalforms import cycles
from tests.loci.orbits.test_codim_two import CIRCLE, SQUARE, twisted
from tests.truth.planted_orbits import SIMPLE, Hidden


def test_a_normal_form_that_cannot_be_computed_is_a_note(monkeypatch):
    def fails(linear):
        raise np.linalg.LinAlgError("a matrix is exactly singular")

    monkeypatch.setattr(cycles, "period_doubling", fails)
    core = next(core for core in SIMPLE if core.type == "PD")
    family = Hidden(core, 4, "plain", 1).family()
    assert family["PD1"].normal_form == {}
    assert any("PD: its normal form could not be computed" in note for note in family.notes)


@pytest.mark.seldom
def test_a_vanishing_coefficient_has_no_sign():
    """s' = p s - s^5: c = 0 at the period doubling."""
    core = next(core for core in SIMPLE if core.type == "PD")
    flat = replace(core, equations={**CIRCLE, **twisted(f"p - ({SQUARE})^2", "-1")})
    for n in (4, 5, 8):
        form = Hidden(flat, n, "rotated", n).family()["PD1"].normal_form
        assert form["criticality"] == "degenerate"
        assert abs(form["c"]) <= form["errors"]["c"]
