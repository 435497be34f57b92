"""Three points of codimension two within one step of a curve: each is labelled, at its place, at any spacing."""

from __future__ import annotations

from dataclasses import replace

import pytest

import contin
from contin.continuation import trace
from contin.continuation.sentence import Sentence
from contin.model.model import Model

SPACINGS = (1e-1, 1e-2, 3e-3, 1e-3, 1e-4)


def folds(e: float) -> object:
    """x' = p + q x + G(x), G'' = x (x - e)(x + e): on the folds q = -G', p = x G' - G, cusps at x = -e, 0, e."""
    x = -1.0
    slope, value = x**4 / 4 - e**2 * x**2 / 2, x**5 / 20 - e**2 * x**3 / 6
    q = -slope + 0.05
    model = Model(
        "cusps", states={"x": {"value": x, "scale": 1}}, parameters={"p": -q * x - value, "q": q},
        equations={"x": f"p + q*x + x^5/20 - {e**2!r}*x^3/6"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "p", (-1, 1))
    return contin.continuation(line["LP1"].locus(("p", "q")), ("p", "q"), {"p": (-1, 1), "q": (-1, 1)})


def hopf_points(e: float) -> object:
    """Growth p, l1 = c = 10 q (q - e)(q + e) on p = 0: GH at q = -e, 0, e."""
    model = Model(
        "bautins", states={"x": {"value": 0, "scale": 1}, "y": {"value": 0, "scale": 1}},
        parameters={"p": -0.5, "q": -0.9}, definitions={"r": "x^2 + y^2", "c": f"10*q*(q - {e!r})*(q + {e!r})"},
        equations={"x": "p*x - y + c*x*r - x*r^2", "y": "x + p*y + c*y*r - y*r^2"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "p", (-1, 1))
    return contin.continuation(line["HB1"].locus(("p", "q")), ("p", "q"), {"p": (-1, 1), "q": (-1, 1)})


@pytest.mark.parametrize("e", SPACINGS)
def test_three_cusps_are_three_labels(e):
    curve = folds(e)
    assert [point.type for point in curve.points] == ["CP", "CP", "CP"]
    assert sorted(point.values["x"] for point in curve.points) == pytest.approx([-e, 0.0, e], abs=1e-7)


@pytest.mark.parametrize("e", SPACINGS)
def test_three_bautin_points_are_three_labels(e):
    curve = hopf_points(e)
    assert [point.type for point in curve.points] == ["GH", "GH", "GH"]
    assert sorted(point.values["q"] for point in curve.points) == pytest.approx([-e, 0.0, e], abs=1e-7)


def test_a_note_on_a_curve_does_not_silence_a_missing_label(monkeypatch):
    """Only what holds all along a curve (eigenvalues that stay critical) explains changes without labels."""
    depart = trace.depart
    notes = (Sentence("something was not told"),)
    monkeypatch.setattr(trace, "depart", lambda *given: replace(depart(*given), notes=notes))
    monkeypatch.setattr(trace, "unexplained", lambda *given: [1])
    curve = hopf_points(0.1)
    assert "something was not told" in curve.notes
    assert any(note.startswith("unstable is 0 beyond labelled points that change it") for note in curve.notes)
    assert curve.unexplained >= 1
