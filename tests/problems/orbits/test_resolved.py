"""Multipliers of the parts of equations, by Liouville's formula where it applies, and folds in canard explosions."""

import numpy as np
import pytest

from contin import api
from contin.model.model import Model
from contin.problems.orbits.linearised.independent_parts import by_parts
from contin.problems.orbits.linearised.linear import OrbitLinear


def trimmed(row):
    return row[np.argmax(~np.isnan(row)) :]


def test_formula_gives_the_multiplier_of_the_stuart_landau_cycle():
    """r' = r (p - r^2), phase 1 + r^2 / 2: multiplier exp(-2 p T), T = 2 pi / (1 + p / 2)."""
    model = Model(
        "rotating", states={"x": 0, "y": 0}, parameters={"p": -0.5}, definitions={"s": "x^2 + y^2", "w": "1 + s/2"},
        equations={"x": "(p - s)*x - w*y", "y": "w*x + (p - s)*y"},
    )  # fmt: skip
    line = api.continuation(api.equilibrium(model), "p", (-0.5, 2.0))
    family = api.continuation(line["HB1"].switch(), "p", (-0.5, 2.0))
    for row in (len(family) // 2, -1):
        p = family.columns["p"][row]
        exact = np.exp(-4.0 * np.pi * p / (1.0 + p / 2.0))
        z = trimmed(family.z[row])
        assert by_parts(OrbitLinear(family.problem, z, np.ones_like(z), z))[0] == pytest.approx(exact, rel=1e-6)
        assert family.eigenvalues[row][1].real == pytest.approx(exact, rel=1e-3)  # a chord


@pytest.mark.seldom
def test_both_canard_explosions_of_the_fitzhugh_nagumo_equations_fold_once():
    """(v, w, I) -> (-v, 2 a / b - w, 2 a / b - I) maps the equations to themselves, so the folds lie mirrored.

    Multipliers reach 1e9 and 1e-60 on the way; their product of matrices resolves neither.
    """
    model = Model(
        "nerve", states={"v": -1.2, "w": -0.6}, parameters={"I": 0.0, "eps": 0.016},
        equations={"v": "v - v^3/3 - w + I", "w": "eps*(v + 0.7 - 0.8*w)"},
    )  # fmt: skip
    line = api.continuation(api.equilibrium(model), "I", (0.0, 2.0))
    family = api.continuation(line["HB1"].switch(), "I", (0.0, 2.0))
    assert [p.type for p in family.points] == ["LPC", "LPC"]
    assert not family.notes  # dp/ds is 1e-7 in an explosion: more than the errors of solved orbits, not of rows
    one, two = family.points
    assert one.values["I"] + two.values["I"] == pytest.approx(1.75, abs=2.0 * (one.error + two.error))
    assert max(one.error, two.error) < 1e-6
    assert one.values["period"] == pytest.approx(two.values["period"], rel=1e-3)
    unstable = family.columns["unstable"]
    assert np.all(unstable[1 : one.index] == 1)
    assert np.all(unstable[one.index + 1 : two.index] == 0)
    assert np.all(unstable[two.index + 1 : -1] == 1)
    assert np.nanmax(np.abs(family.eigenvalues[:, 1])) > 1e9
    assert family.ends[1].reason == "hopf"


@pytest.mark.parametrize(
    ("eps", "slaved"),
    [
        (0.02, "10*(v - u)"),
        *(pytest.param(eps, follows, marks=pytest.mark.long) for eps in (0.02, 0.016) for follows in ("-u", "v - u")),
    ],
)
@pytest.mark.seldom
def test_a_slaved_state_takes_no_fold_from_a_canard_explosion(eps, slaved):
    """The monodromy matrix is block triangular, with couplings of 1e20 and more beside multipliers of order 1."""
    nerve = {"v": "v - v^3/3 - w + I", "w": "eps*(v + 0.7 - 0.8*w)", "u": slaved}
    model = Model("nerve", states={"v": -1.2, "w": -0.6, "u": 0.0}, parameters={"I": 0.0, "eps": eps}, equations=nerve)
    line = api.continuation(api.equilibrium(model), "I", (0.0, 2.0))
    family = api.continuation(line["HB1"].switch(), "I", (0.0, 2.0))
    assert [p.type for p in family.points] == ["LPC", "LPC"]
    one, two = family.points
    assert one.values["I"] + two.values["I"] == pytest.approx(1.75, abs=2.0 * (one.error + two.error))
    assert not family.unexplained


@pytest.mark.parametrize("longest", [0.04, 0.02])
def test_the_coefficient_of_a_fold_where_the_parameter_hardly_moves_is_right_to_its_error(longest):
    """|dp/ds| < 1e-5 around it. Reference: 120 and 200 intervals, -178.0950082(4) and -178.0950080(2)."""
    model = Model(
        "bursting", states={"x": -1.5, "y": -0.5, "z": 0.0}, parameters={"p": -1.0}, equations={
            "x": "x - x^3/3 - y - 0.259*z + p", "y": "0.1057*(x + 0.7 - 0.959*y - 0.188*z)",
            "z": "0.23768*(1.385*(x + 1.069) - z - 0.091*y)",
        },
    )  # fmt: skip
    line = api.continuation(api.equilibrium(model), "p", (-4.0, 4.0))
    settings = {"max_step": longest, "steps": 120}
    family = api.continuation(line["HB1"].switch(), "p", (0.44, 0.51), settings=settings)
    fold = family["LPC2"]
    assert fold.values["p"] == pytest.approx(0.50372079815592, abs=fold.error)
    assert fold.normal_form["b"] == pytest.approx(-178.095008, abs=fold.normal_form["errors"]["b"])
    assert fold.normal_form["errors"]["b"] < 1e-3


def test_parts_have_their_own_multipliers():
    """r' = r (p - r^2), phase 1, drives a rotating pair and a single state: growth rates -2 p, -0.1 +- 3 i and -0.2.

    Another pair drives the circle and rests.
    """
    model = Model(
        "driving", states=dict.fromkeys(("x", "y", "a", "b", "c", "d", "e"), 0.0), parameters={"p": -0.5},
        definitions={"s": "x^2 + y^2"},
        equations={
            "x": "(p - s)*x - y + d", "y": "x + (p - s)*y", "a": "-0.1*a - 3*b + x", "b": "3*a - 0.1*b",
            "c": "a*x - 0.2*c", "d": "-0.3*d - e", "e": "d - 0.3*e",
        },
    )  # fmt: skip
    line = api.continuation(api.equilibrium(model), "p", (-0.5, 0.05))
    family = api.continuation(line["HB1"].switch(), "p", (-0.5, 0.05))
    z = trimmed(family.z[-1])
    found = by_parts(OrbitLinear(family.problem, z, np.ones_like(z), z))
    rates = np.array([-0.1, -0.1 + 3.0j, -0.1 - 3.0j, -0.2, -0.3 + 1.0j, -0.3 - 1.0j])
    expected = np.exp(2.0 * np.pi * rates)  # p = 0.05: the rate along the radius is -0.1
    assert len(found) == 6
    for value in expected:
        assert np.min(np.abs(found - value)) < 1e-5 * abs(value)
