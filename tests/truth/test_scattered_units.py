"""Each state and each parameter in a unit of its own: labels, words, stability and numbers are those in ordinary ones.

Starts say little here: derivatives vanish at rest (by chance, or all up to the fourth), states are zero on the start's
branch and next to nothing beside the others in their units, orbits have states 1e18 apart.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pytest

import contin
from contin.model.model import Model
from tests.truth.unit_checks import Check, diagrams, line, simulated
from tests.truth.units import ORDINARY, Scattered, Units, Verbs, compare, summary

WIDE = (
    Scattered(time=1e-9, states=(1e9, 1e-6, 1e3, 1e-3), parameters=(1e-9, 1e6, 1e3, 1e-4, 1e9)),
    Scattered(time=1e9, states=(1e-9, 1e7, 1e-4, 1e12), parameters=(1e8, 1e-7, 1e-3, 1e12, 1e-12)),
    Scattered(time=1.0, states=(1e9, 1e-9, 1.0), parameters=(1.0,)),
    Scattered(time=1.0, states=(1.0, 1e9, 1e-9), parameters=(1.0,)),
    Scattered(time=1.0, states=(1e4, 1e-4, 1.0), parameters=(1.0,)),
)
HOOP = Model(  # a bead on a hoop that turns; at O = 1/2, the start, the third derivative at rest vanishes
    "hoop", states={"q": 0, "w": 0}, parameters={"O": {"value": 0.5, "range": [0.3, 2]}, "b": 0.3},
    equations={"q": "w", "w": "-b*w + sin(q)*(O^2*cos(q) - 1)"}, symmetries={"mirror": {"q": "-q", "w": "-w"}},
)  # fmt: skip
TRICRITICAL = Model(  # nothing up to the fourth derivative says how large x is
    "tricritical", states={"x": 0, "y": 0}, parameters={"p": {"value": -1, "range": [-1, 1]}, "k": 0.3},
    equations={"x": "y", "y": "p*x - x^5 - k*y"},
)  # fmt: skip
LASER = Model(  # Yamada's laser with an absorber (Dubbeldam and Krauskopf, Opt. Commun. 159 (1999) 325); J = 0: off
    "laser", states={"G": 4, "Q": 5.8, "J": 0.001},
    parameters={"A": {"value": 5, "range": [5, 9]}, "g": 0.05, "B": 5.8, "a": 1.8},
    equations={"G": "g*(A - G - G*J)", "Q": "g*(B - Q - a*Q*J)", "J": "(G - Q - 1)*J"},
)  # fmt: skip
TRUSS = Model(  # a shallow truss that snaps through, and a second state that no equation moves from zero
    "truss", kind="algebraic", states={"w": 0.01, "s": 0},
    parameters={"P": {"value": 0.01, "range": [-0.3, 0.3]}, "h": 0.4},
    equations={"w": "P - (h - w)*w*(2*h - w)/2 + 0.3*s", "s": "s*(0.2 - (h - w)^2/10) + s^3 - s*w/20"},
)  # fmt: skip
CHUA = Model(  # piecewise linear: orbits are shot
    "chua", states={"x": 1.2, "y": 0.1, "z": -1}, parameters={"al": {"value": 8, "range": [7.95, 8.02]}, "be": 14.286},
    equations={"x": "al*(y - x + 5/7*x + 1.5/7*(abs(x + 1) - abs(x - 1)))", "y": "x - y + z", "z": "-be*y"},
)  # fmt: skip


def pulses(verbs: Verbs) -> Mapping[str, Any]:
    """From off to on, and the pulses born at its Hopf point to their fold."""
    off = contin.continuation(contin.equilibrium(verbs.model), "A")
    on = contin.continuation(off["BP1"].switch(), "A")
    family = contin.continuation(on["HB1"].switch(), "A", settings={"steps": 40})
    found = [summary(verbs, branch, ("A",)) for branch in (off, on, family)]
    return {"points": [p for part in found for p in part["points"]], "stable": [part["stable"] for part in found]}


CHECKS: dict[str, tuple[Model, Check, tuple[Units, ...]]] = {
    "a bead on a hoop": (HOOP, diagrams(HOOP, "O", ("O",)), WIDE[:2]),
    "a tricritical point": (TRICRITICAL, line(TRICRITICAL, None, "p", ("p",)), (*WIDE[:2], Units(1e15, 1e12, 1e3))),
    "pulses of a laser": (LASER, pulses, WIDE),
    "a truss": (TRUSS, line(TRUSS, None, "P", ("P", "w")), WIDE[:2]),
    "orbits that are shot": (CHUA, simulated(CHUA, "al", ("al",), transient=60.0), WIDE[:1]),
}


@pytest.mark.parametrize("name", CHECKS)
@pytest.mark.seldom
def test_a_unit_for_each_state_and_parameter_changes_nothing(name):
    model, check, wide = CHECKS[name]
    ordinary = check(Verbs(model, ORDINARY))
    assert {str(u): found for u in wide if (found := compare(ordinary, check(Verbs(model, u)), {}))} == {}
