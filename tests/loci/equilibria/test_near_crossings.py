"""Curves in two parameters that nearly cross another one turn off beside it; where they cross, a note says so.

g = q^2 - p^2 - e: the curve g = 0 from (-2, 2) turns at (0, sqrt(e)), from one line to the other, and stays at q > 0.
Every one of them went on along its line, onto the other half of the hyperbola, from e = 1e-6 on without a word.
"""

import numpy as np
import pytest

import contin

G = "(q^2 - p^2 - e)"
CURVES = {
    "LP": ("flow", {"x": f"{G} - x^2"}, {"x": 1.1}),
    "BP, pitchforks": ("flow", {"x": f"x*{G} - x^3"}, {"x": 0}),
    "BP, transcritical": ("flow", {"x": f"x*({G} - x)", "y": "x - y"}, {"x": 0, "y": 0}),
    "BP, on a solution that moves": ("flow", {"x": "x*(q^2 - y^2 - e) - x^3", "y": "p - y"}, {"x": 0, "y": -1}),
    "BP, map": ("map", {"x": f"x + x*{G} - x^3"}, {"x": 0}),
    "HB": ("flow", {"x": f"-{G}*x - y - x*(x^2 + y^2)", "y": f"x - {G}*y - y*(x^2 + y^2)"}, {"x": 0, "y": 0}),
    "PD": ("map", {"x": f"-(1 - {G})*x + x^3"}, {"x": 0}),
    "NS": ("map", {"x": f"(1 - {G})*(0.6*x - 0.8*y)", "y": f"(1 - {G})*(0.8*x + 0.6*y)"}, {"x": 0, "y": 0}),
}


def curve(type_, e):
    kind, equations, start = CURVES[type_]
    model = contin.Model("beside", kind=kind, states=start, parameters={"p": -1, "q": 1.5, "e": e}, equations=equations)
    line = contin.continuation(contin.equilibrium(model), "p", (-2, 0))
    return contin.continuation(line[f"{type_[:2]}1"].locus(), ("p", "q"), {"p": (-2, 2), "q": (-2, 2)})


@pytest.mark.parametrize("gap", [1e-2, 1e-3, 1e-5, 1e-6])
@pytest.mark.parametrize("type_", list(CURVES))
def test_a_curve_turns_off_beside_another_one(type_, gap):
    found = curve(type_, gap * gap)
    p, q = found.columns["p"], found.columns["q"]
    np.testing.assert_allclose(q, np.sqrt(p * p + gap * gap), rtol=1e-6, atol=1e-9)
    assert {end.reason for end in found.ends} == {"bound"}
    assert p.max() - p.min() > 3.9
    assert len(p) < 120
    assert found.notes == ()


@pytest.mark.parametrize("e", [0.0, 1e-16])
@pytest.mark.parametrize("type_", list(CURVES))
def test_a_curve_that_another_one_crosses_goes_on_and_says_so(type_, e):
    """Or passes it at 1e-8 of the range: curves of Hopf points, and of NS of maps, went over without a word there."""
    found = curve(type_, e)
    np.testing.assert_allclose(found.columns["q"], -found.columns["p"], atol=2e-8 if e else 1e-12)
    assert any("another curve crosses this one" in note for note in found.notes)
    assert found.unexplained == 0


@pytest.mark.parametrize("longest", [None, 0.02, 0.005])
def test_no_curve_is_said_to_cross_one_that_nothing_crosses(longest):
    """A predator z invades where prey and its first predator are in balance; K moves these, and is not in its equation.

    The sign of a mixed coefficient of rounding was taken for a crossing, at another place with other steps.
    """
    equations = {
        "x": "x*(1 - x/K) - 5*x*y/(1 + 3*x)", "y": "5*x*y/(1 + 3*x) - 0.1*y*z/(1 + 2*y) - d*y",
        "z": "0.1*y*z/(1 + 2*y) - 0.01*z",
    }  # fmt: skip
    model = contin.Model("invaded", states={"x": 0.8, "y": 0.3, "z": 0.1}, parameters={"K": 1, "d": 0.4},
                         equations=equations)  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "K", (0.2, 2.5))
    settings = {} if longest is None else {"max_step": longest, "steps": 400}
    found = contin.continuation(line["BP1"].locus(), ("K", "d"), {"K": (0.2, 2.5), "d": (0.1, 1.2)}, settings=settings)
    x = found.columns["d"] / (5 - 3 * found.columns["d"])
    np.testing.assert_allclose(found.columns["K"], x / (1 - 0.125 * 5 / (1 + 3 * x)), rtol=1e-9)
    assert found.notes == ()
