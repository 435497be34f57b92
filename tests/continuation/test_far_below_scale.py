"""A parameter that becomes far smaller than its range and matters all the same: stability is that of the rows."""

import numpy as np
import pytest

import contin
from contin.model.model import Model


def test_eigenvalues_are_those_of_the_row_where_the_parameter_is_far_below_its_scale():
    """p (exp(5 x) - 1) = x: p -> 0 as x grows; the eigenvalue 1 - 5 p exp(5 x) tends to 1 - 5 x."""
    model = Model("tail", states={"x": 0.5}, parameters={"p": 0.05}, equations={"x": "x - p*(exp(5*x) - 1)"})
    start = contin.equilibrium(model, {"x": 0.5})
    branch = contin.continuation(start, "p", (-0.1, 0.8), settings={"steps": 60})
    assert [point.type for point in branch.points] == ["BP"]  # with x = 0 at p = 1/5
    x, p = branch.columns["x"], branch.columns["p"]
    assert p.min() < 1e-12
    away = np.abs(x) > 1e-3
    exact = x[away] / np.expm1(5.0 * x[away])
    assert np.abs(p[away] / exact - 1.0).max() < 1e-7
    values = 1.0 - 5.0 * exact * np.exp(5.0 * x[away])
    assert np.abs(branch.eigenvalues[away, 0].real / values - 1.0).max() < 1e-3
    assert branch.notes == ()


@pytest.mark.parametrize("size", [1e-9, 1e-15, 3e-17])
@pytest.mark.parametrize("beside", [1.0, 2e4])
def test_a_small_state_beside_a_large_one_that_is_not_coupled_keeps_its_size(size, beside):
    """As large as the length over which its equation bends, it is no rounding error: equilibria were invented."""
    model = Model(
        "small", states={"x": size, "y": beside}, parameters={"a": 1},
        equations={"x": f"{size!r}*(a - (x/{size!r})^2)", "y": f"{beside!r} - y"},
    )  # fmt: skip
    branch = contin.continuation(contin.equilibrium(model), "a", (-1, 2))
    assert [point.type for point in branch.points] == ["LP"]
    assert branch.columns["a"].min() > -1e-12
    np.testing.assert_allclose(np.square(branch.columns["x"] / size), branch.columns["a"], atol=1e-9)
    growing = Model(
        "growing", states={"x": 0.1 * size, "y": 0.5 * beside}, parameters={"a": 1},
        equations={"x": f"a*x*(1 - x/{size!r})", "y": f"{beside!r} - y"},
    )  # fmt: skip
    end = contin.simulate(growing, time=3.0, samples=2).columns["x"][-1]
    assert end / size == pytest.approx(0.1 * np.e**3 / (1.0 + 0.1 * (np.e**3 - 1.0)), rel=1e-8)


@pytest.mark.parametrize("kind", ["flow", "algebraic"])
def test_a_derivative_that_is_rounding_is_no_length(kind):
    """A two-bar truss of height 2, in which d^3 F_u/d u^3 vanishes at rest by chance: u had the size 2e8.

    Along u = 0 the bars have length L = (1 + y^2)^(1/2) and P = 2 (L0/L - 1) y, which turns where L^3 = L0 = 5^(1/2).
    """
    model = Model(
        "truss", kind=kind, states={"u": 0.0, "v": 0.0}, parameters={"P": 0.0, "h": 2.0},
        definitions={
            "L0": "sqrt(1 + h^2)",
            "F1": "1 - L0/sqrt((1 + u)^2 + (h - v)^2)", "F2": "1 - L0/sqrt((1 - u)^2 + (h - v)^2)",
        },
        equations={"u": "F1*(1 + u) - F2*(1 - u)", "v": "-(F1 + F2)*(h - v) - P"},
    )  # fmt: skip
    branch = contin.continuation(contin.equilibrium(model), "P", (-3.0, 3.0))
    rest = np.sqrt(5.0)
    length = rest ** (1.0 / 3.0)
    load = 2.0 * (rest / length - 1.0) * np.sqrt(length * length - 1.0)
    assert sorted(p.values["P"] for p in branch.points) == pytest.approx([-load, load], abs=1e-13)
    for point in branch.points:
        assert point.error < 1e-13
        assert point.normal_form["errors"]["a"] < 1e-7


def test_folds_are_found_however_far_the_state_falls_below_its_scale():
    """p = 6 - L + 0.3 sin(6 L), L = log10(x), turns where cos(6 L) = 5/9: two folds each time x falls by 10^(pi/3).

    From x = 10^6 on steps led over all of them below x = 1,000, with no word at the two near 85 and 181.
    """
    model = Model(
        "decades", states={"x": 1e6}, parameters={"p": 0.0}, equations={"x": "6 + 0.3*sin(6*log10(x)) - log10(x) - p"},
    )  # fmt: skip
    branch = contin.continuation(contin.equilibrium(model), "p", (0.0, 7.2))
    angle = np.arccos(5.0 / 9.0)
    logs = np.sort([(2.0 * np.pi * k + sign * angle) / 6.0 for k in range(-1, 6) for sign in (1.0, -1.0)])[::-1]
    logs = logs[(logs < 5.5) & (logs > -1.25)]
    assert [point.type for point in branch.points] == ["LP"] * len(logs)
    found = [point.values["p"] for point in branch.points]
    np.testing.assert_allclose(found, 6.0 - logs + 0.3 * np.sin(6.0 * logs), rtol=1e-11)
    np.testing.assert_allclose([point.values["x"] for point in branch.points], 10.0**logs, rtol=1e-5)
    assert branch.notes == ()
    assert branch.steps < 400  # 342


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3, 1e4])
def test_labels_do_not_depend_on_a_scale_that_is_far_too_large(scale):
    """Two folds a thousandth of the range apart (calcium model of Atri et al. 1993): at 1e4 both were left out.

    f2 = 0: h(c); f1 = 0: mu(c), which turns at the folds; there is a Hopf point where the trace vanishes.
    """
    states = {name: {"value": value, "scale": scale} for name, value in {"c": 0.2, "h": 0.6}.items()}
    h, release = "(0.49/(0.49 + c^2))", "16.2*(0.111 + 0.889*c/(0.7 + c))"
    model = contin.load({
        "contin": 1, "name": "calcium", "states": states, "parameters": {"mu": 0.2},
        "equations": {"c": f"mu*h*{release} - 2*c/(0.1 + c) + 0.02", "h": f"({h} - h)/2"},
    })  # fmt: skip
    branch = contin.continuation(contin.equilibrium(model), "mu", (0.01, 0.8))
    assert [point.type for point in branch.points] == ["HB", "LP", "LP", "HB"]
    c = np.linspace(0.02, 3.0, 2_000_001)
    open_part = 0.49 / (0.49 + c**2) * 16.2 * (0.111 + 0.889 * c / (0.7 + c))
    mu = (2.0 * c / (0.1 + c) - 0.02) / open_part
    turns = np.flatnonzero(np.diff(np.sign(np.diff(mu)))) + 1
    np.testing.assert_allclose([branch["LP1"].values["mu"], branch["LP2"].values["mu"]], mu[turns], rtol=1e-9)


@pytest.mark.seldom
def test_states_that_are_zero_to_rounding_are_not_measured_by_it():
    """Three metronomes near in-phase synchrony: v1 = v3 but for 1e-12, on which a metric of 1e-12 was founded."""
    model = contin.average(contin.load("metronomes/three"), form="cartesian")
    found = contin.diagram(model, "mu", (0.05, 8), start="in-phase", parameters={"beta": 0.8}, orbits=False)
    branch = found["in-phase/BP1"]
    assert [end.reason for end in branch.ends] == ["bound", "bound"]
    assert sorted(p.type for p in branch.points) == ["BP", "HB", "HB", "HB", "LP", "LP", "LP", "LP", "LP"]
