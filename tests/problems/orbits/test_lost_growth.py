"""Growth within an interval of the mesh: multipliers known from an integral, and what collocation makes of them."""

import numpy as np
import pytest

import contin
from contin.problems.orbits.linearised.lost_growth import lost_growth
from contin.problems.orbits.mesh.layout import trimmed


def family(rate: float, c: float, forced: bool = False):
    """x^2 + y^2 = 1 (or forced), w = 0: w' = (c + rate (cos t + cos 2t / 2)) w, multiplier exp(2 pi c)."""
    growth = f"(c + {rate!r}*(x + (x^2 - y^2)/2))*w"
    states, equations = {"x": 1.0, "y": 0.0, "w": 0.0}, {"x": "x - y - x*(x^2 + y^2) + w", "y": "x + y - y*(x^2 + y^2)"}
    forcing = {"period": "2*pi"} if forced else None
    if forced:
        states, equations = {"v": 0.0, "w": 0.0}, {"v": "-v + w"}
        growth = f"(c + {rate!r}*(cos(t) + cos(2*t)/2))*w"
    model = contin.Model(
        "growth", states=states, parameters={"c": c}, equations={**equations, "w": growth}, forcing=forcing
    )
    orbit = contin.periodic_orbit(model)
    return contin.continuation(orbit, "c", (c - 0.01, c + 0.01), settings={"steps": 1, "intervals": 40})


@pytest.mark.parametrize(("rate", "c"), [(30.0, 0.2), (200.0, 0.05)])
def test_unstable_orbits_that_come_out_as_stable_have_a_note(rate, c):
    found = family(rate, c)
    assert np.exp(2.0 * np.pi * c) > 1.3  # the multiplier
    assert np.abs(found.orbit(1).multipliers[1:]).max() < 1e-3  # what the mesh makes of it
    assert any("orbits that are called stable need not be near c = " in note for note in found.notes)


def test_forced_ones_too():
    found = family(200.0, 0.05, forced=True)
    assert any("called stable need not be" in note for note in found.notes)


@pytest.mark.parametrize(("rate", "c"), [(3.0, -0.2), (10.0, 0.02)])
def test_growth_that_the_mesh_follows_has_none(rate, c):
    found = family(rate, c)
    assert np.abs(found.orbit(1).multipliers[1:]).max() == pytest.approx(
        np.exp(2.0 * np.pi * found.columns["c"][1]), rel=1e-3
    )
    assert not found.notes


def test_what_is_lost_is_the_growth_less_that_of_the_gauss_method():
    """w' = c w along a circle on N equal intervals of m points: N (z - log |R(z)|), z = 2 pi c/N, and R for m = 4."""
    found = family(0.0, 60.0)
    problem, z = found.problem, trimmed(found.z[1])
    profile = problem.profile(z)
    assert profile.m == 4
    growth = profile.period * profile.h * found.columns["c"][1]
    top, bottom = (1.0 + s * growth / 2 + 3 * growth**2 / 28 + s * growth**3 / 84 + growth**4 / 1680 for s in (1, -1))
    assert lost_growth(problem, z, 1) == pytest.approx(float(np.sum(growth - np.log(top / bottom))), rel=1e-9)


def test_a_fold_of_cycles_among_canards_whose_second_1_is_lost_has_a_note():
    """A curve of folds that begins at a generalised Hopf point, among canards of two coupled relaxation oscillators.

    Its first row had as many eigenvalues as the orbit has unknowns, so that of no row they were looked at.
    """
    model = contin.Model(
        "pair", states={"v": -1.2, "w": -0.6, "V": -1.2, "W": -0.6}, parameters={"p": -1.0, "q": 0.2},
        equations={
            "v": "v - v^3/3 - w + p + q*(V - v)", "w": "0.143*(v + 0.256 - 0.56*w)",
            "V": "V - V^3/3 - W + 0.835*p + 0.33*(v - V)", "W": "0.218*(V + 0.296 - 0.741*W + 0.049*v)",
        },
    )  # fmt: skip
    names, box = ("p", "q"), {"p": (-2, 3), "q": (-0.5, 1)}
    line = contin.continuation(contin.equilibrium(model, start="auto"), "p", (-1.1, -0.3))
    hopf = contin.continuation(line["HB1"].locus(), names, box)
    folds = contin.continuation(hopf["GH1"].locus(names), names, box, settings={"steps": 40})
    second = np.min(np.abs(folds.eigenvalues[:, 1:] - 1.0), axis=1)
    assert folds.eigenvalues.shape == (len(folds), 4)
    assert second[:15].max() < 1e-4
    assert second.max() > 0.1
    assert any("one that is known comes out as" in note for note in folds.notes)
