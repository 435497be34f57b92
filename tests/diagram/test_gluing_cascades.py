"""Cascades of homoclinic gluings: orbits of ever more loops are born without end, and a diagram follows the first."""

import pytest

import contin


@pytest.mark.seldom
def test_shimizu_and_moriokas_gluings_alternate_with_doublings_and_end():
    """x' = y, y' = x - a y - x z, z' = -b z + x^2 at b = .4: two mirror images glue at a = 1.2054, and on."""
    model = contin.Model(
        "morioka", states={"x": 1, "y": 0, "z": 1}, parameters={"a": 0.8, "b": 0.4},
        equations={"x": "y", "y": "x - a*y - x*z", "z": "-b*z + x^2"}, symmetries={"flip": {"x": "-x", "y": "-y"}},
    )  # fmt: skip
    diagram = contin.diagram(model, "a", (0.3, 1.5))
    longer = [sum(part[:2] == "PD" or part[:3] == "HOM" for part in b.name.split("/")) for b in diagram.branches]
    assert max(longer) == 3
    assert any("twice as many loops" in note for note in diagram.notes)
    assert not any("budget" in note for note in diagram.notes)
    assert diagram["start/HB1"]["HOM1"].values["a"] == pytest.approx(1.205391102, abs=1e-8)  # by shooting, too
