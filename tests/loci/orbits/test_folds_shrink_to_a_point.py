"""Curves of folds of cycles end where the cycles shrink to a generalised Hopf point; no cusp is looked for there."""

import numpy as np

from contin.api import continuation, equilibrium
from contin.model.model import Model
from contin.problems.orbits.special_orbits.curve import OrbitCurve


def test_folds_of_cycles_end_at_their_generalised_hopf_point_without_a_search_for_cusps(monkeypatch):
    """A -> B -> C (Doedel and Heinemann 1983): where l1 = 0 on the curve of Hopf points.

    On the way there the test of cusps falls to zero, in shorter and shorter steps.
    """
    model = Model(
        "abc", states={"u": 0, "v": 0, "w": 0}, parameters={"D": 0, "a": 1, "be": 1.55, "B": 8, "s": 0.04},
        definitions={"E": "exp(w)"},
        equations={
            "u": "-u + D*(1 - u)*E", "v": "-v + D*E*(1 - u - s*v)", "w": "-w - be*w + D*B*E*(1 - u + a*s*v)",
        },
    )  # fmt: skip
    hopf = continuation(equilibrium(model), "D", (0.0, 0.5), settings={"stop_at": ["HB"]})["HB1"]
    box = {"D": (0.0, 0.5), "a": (0.5, 1.5)}
    points = [p.values for p in continuation(hopf.locus(), ("D", "a"), box).points if p.type == "GH"]
    family = continuation(hopf.switch(), "D", (0.0, 0.5), settings={"intervals": 30, "stop_at": ["LPC"]})
    calls, correct = [], OrbitCurve.correct

    def counted(self, *arguments, **options):
        calls.append(arguments[1])
        return correct(self, *arguments, **options)

    monkeypatch.setattr(OrbitCurve, "correct", counted)
    settings = {"intervals": 30, "step": 0.004, "max_step": 0.004, "steps": 100}
    curve = continuation(family["LPC1"].locus(("D", "a")), ("D", "a"), box, direction="up", settings=settings)
    assert curve.ends[-1].reason == "hopf"
    assert [point.type for point in curve.points if point.type == "CPC"] == []
    D, a = curve.columns["D"], curve.columns["a"]
    end = int(np.argmax(a))
    assert min(max(abs(D[end] - p["D"]), abs(a[end] - p["a"])) for p in points) < 1e-4
    assert len(calls) <= 15  # measured 11; a search for cusps takes a dozen more
