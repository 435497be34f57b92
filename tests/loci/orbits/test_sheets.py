"""A curve of folds of which two stretches lie beside each other in both parameters: no step leads across."""

from __future__ import annotations

import numpy as np

import contin

NAMES, BOX = ("mu", "tau"), {"mu": (0.001, 2.0), "tau": (0.05, 20.0)}
CALCIUM = {  # Atri, Amundson, Clapham and Sneyd (1993)
    "contin": 1, "name": "calcium", "states": {"c": {"value": 0.2, "scale": 1}, "h": {"value": 0.6, "scale": 1}},
    "parameters": {
        "mu": 0.2, "b": 0.111, "kf": 16.2, "k1": 0.7, "k2": 0.7, "kg": 0.1, "ga": 2, "tau": 2, "be": 0.02,
    },
    "equations": {
        "c": "kf*mu*h*(b + (1 - b)*c/(k1 + c)) - ga*c/(kg + c) + be",
        "h": "(k2^2/(k2^2 + c^2) - h)/tau",
    },
}  # fmt: skip


def test_folds_lead_from_one_generalised_hopf_point_over_their_cusp_to_the_other():
    line = contin.continuation(contin.equilibrium(contin.load(CALCIUM)), "mu", (0.01, 0.8))
    hopf = contin.continuation(line["HB1"].locus(NAMES), NAMES, BOX)
    first, second = hopf["GH1"], hopf["GH2"]
    folds = contin.continuation(first.locus(NAMES), NAMES, BOX)
    assert [p.type for p in folds.points] == ["CPC"]
    assert folds.ends[1].reason == "hopf"
    last = [float(folds.columns[name][-1]) for name in NAMES]
    np.testing.assert_allclose(last, [second.values[name] for name in NAMES], rtol=1e-3)
    chords = np.hypot(np.diff(folds.columns["mu"]) / 2.0, np.diff(folds.columns["tau"]) / 20.0)
    assert chords.max() <= 0.05 / np.cos(np.radians(15.0))  # the longest step, and how far a chord may turn from it


def test_the_coefficient_of_a_cusp_does_not_depend_on_the_metric():
    """It was -.0021 +- .0001 for -.1161 in scales of 1,000: beside large entries the shear passed for none."""
    forms = [_cusp(scale) for scale in (1e-1, 1.0, 1e3)]
    for a in forms:
        assert a["errors"]["c"] < 0.02 * abs(a["c"])
        for b in forms:
            assert abs(a["c"] - b["c"]) <= a["errors"]["c"] + b["errors"]["c"]


def _cusp(scale: float) -> dict:
    model = CALCIUM | {"states": {n: {**given, "scale": scale} for n, given in CALCIUM["states"].items()}}
    line = contin.continuation(contin.equilibrium(contin.load(model)), "mu", (0.01, 0.8))
    hopf = contin.continuation(line["HB1"].locus(NAMES), NAMES, BOX, settings={"stop_at": ("GH",)})
    (bautin,) = [p for p in hopf.points if p.type == "GH"][:1]
    folds = contin.continuation(bautin.locus(NAMES), NAMES, BOX, settings={"stop_at": ("CPC",)})
    return dict(folds["CPC1"].normal_form)
