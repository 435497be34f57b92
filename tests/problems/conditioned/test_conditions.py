"""Solutions under conditions: closed forms, elliptic integrals, and independent runs without conditions."""

import re

import numpy as np
import pytest
from scipy.special import ellipk

import contin
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.model.relations import relations
from tests.cli.calls import call, results, run_file

CIRCLE = contin.Model(  # the circle r^2 = mu with angular velocity om + b mu
    name="circle", states={"x": 1, "y": 0}, parameters={"mu": 1, "om": 1, "b": -0.5},
    equations={
        "x": "x*(mu - x^2 - y^2) - y*(om + b*(x^2 + y^2))", "y": "y*(mu - x^2 - y^2) + x*(om + b*(x^2 + y^2))",
    },
)  # fmt: skip
BRUSSELATOR = contin.Model(
    name="brusselator", states={"x": 1, "y": 1}, parameters={"A": 1, "B": 1},
    equations={"x": "A - (B + 1)*x + x^2*y", "y": "B*x - x^2*y"}, observables={"product": "x*y"},
)  # fmt: skip


@pytest.fixture(scope="module")
def circle():
    return contin.periodic_orbit(CIRCLE, {"x": 1, "y": 0}, {"om": np.pi / 2 + 0.5})


def test_orbits_of_one_period_lie_on_the_level_set_of_the_period(circle):
    branch = contin.continuation(circle, "mu", (0.2, 2), conditions=["period = 4"], free=["om"])
    assert branch.free == ("om",)
    assert branch.parameters == ("mu",)
    np.testing.assert_allclose(branch.columns["om"], np.pi / 2 + 0.5 * branch.columns["mu"], atol=1e-9)
    np.testing.assert_allclose(branch.columns["period"], 4.0, atol=1e-10)


@pytest.mark.parametrize(("condition", "mu"), [
    ("x.max = 0.7", lambda c: 0.49), ("norm = 0.7", lambda c: 0.49), ("amplitude = 0.7", lambda c: 0.49),
    ("integral(x^2) = 2", lambda c: 4.0 / c["period"]), ("mean(x^2 + y^2)*b = -0.3", lambda c: 0.6),
])  # fmt: skip
def test_conditions_on_numbers_of_an_orbit_hold(circle, condition, mu):
    branch = contin.continuation(circle, "om", (1, 2.5), conditions=[condition], free=["mu"])
    np.testing.assert_allclose(branch.columns["mu"], mu(branch.columns), atol=1e-7)
    assert [end.reason for end in branch.ends] == ["bound", "bound"]


@pytest.mark.seldom
def test_two_conditions_take_two_parameters(circle):
    free, conditions = ["mu", "b"], ["norm = 1.2", "x.max*mu = b + 2.3"]
    branch = contin.continuation(circle, "om", (1, 3), conditions=conditions, free=free)
    np.testing.assert_allclose(branch.columns["mu"], 1.44, atol=1e-9)
    np.testing.assert_allclose(branch.columns["b"], 1.2 * 1.44 - 2.3, atol=1e-7)


def test_a_fold_of_cycles_is_found_on_orbits_of_one_amplitude():
    """mu = r^4 - b r^2 turns at b = 2 r^2."""
    rate = "(b*(x^2 + y^2) - (x^2 + y^2)^2 + mu)"
    model = contin.Model(
        name="subcritical", states={"x": 1, "y": 0}, parameters={"mu": -0.1, "b": 1},
        equations={"x": f"-y + x*{rate}", "y": f"x + y*{rate}"},
    )  # fmt: skip
    start = contin.periodic_orbit(model, {"x": 0.9, "y": 0})
    branch = contin.continuation(start, "b", (0.8, 2), conditions=["norm = 0.8"], free=["mu"])
    assert [p.type for p in branch.points] == ["LPC"]
    point = branch["LPC1"]
    assert abs(point.values["b"] - 1.28) <= max(point.error, 1e-10)
    assert point.values["mu"] == pytest.approx(-0.4096, abs=1e-9)
    free = contin.continuation(start, "mu", (-0.3, 0.2))["LPC1"]  # b of the normal form at mu = -b^2/4, another r
    assert free.values["mu"] == pytest.approx(-0.25, abs=1e-9)
    assert branch.columns["unstable"].max() == 1


def test_a_fold_of_the_conditioned_curve_is_one_in_words(circle):
    """The angular velocity om + b mu and b are given functions of mu, so om is one, with a minimum."""
    start = contin.periodic_orbit(CIRCLE, {"x": 1.3, "y": 0}, {"om": 2.5, "mu": 1.69, "b": -0.238})
    conditions = ["period*(2 + 0.4*(mu - 1.2)^2 + 0*om) = 2*pi", "b = 0.1 - 0.2*mu"]
    branch = contin.continuation(start, "om", (1, 3), conditions=conditions, free=["mu", "b"])
    # om = 2 + 0.4 (mu - 1.2)^2 - (0.1 - 0.2 mu) mu is smallest at mu = (0.96 + 0.1)/1.2
    mu = 1.06 / 1.2
    folds = [p for p in branch.points if p.type == "LP"]
    assert [p.normal_form["of"] for p in folds] == ["curve"]
    assert folds[0].values["om"] == pytest.approx(2 + 0.4 * (mu - 1.2) ** 2 - (0.1 - 0.2 * mu) * mu, abs=1e-9)
    assert any("fold of the curve" in note for note in branch.notes)


@pytest.mark.seldom
def test_the_backbone_of_a_conservative_oscillator_is_its_elliptic_integral():
    model = contin.Model(
        name="duffing", states={"x": 0, "v": 0}, parameters={"a": 1, "d": -0.5, "k": 1},
        equations={"x": "v", "v": "-x - k*x^3 + d*v"},
    )  # fmt: skip
    rest = contin.continuation(contin.equilibrium(model), "d", (-0.5, 0.5))
    family = contin.continuation(rest["HB1"].switch(), "d", (-0.5, 0.5), values={"x.max": [1]}, settings={"steps": 40})
    point = family["UZ1"]
    start = Seed(family.problem.with_active("a", point.z), np.append(point.z[:-1], 1.0))
    wide, periods = {"max_step": 0.2}, {"period": [5]}
    branch = contin.continuation(
        start, "a", (0.5, 2), conditions=["x.max = a"], free=["d"], values=periods, settings=wide
    )
    a = branch.columns["a"]
    period = 4 / np.sqrt(1 + a * a) * ellipk(a * a / (2 * (1 + a * a)))
    np.testing.assert_allclose(branch.columns["period"], period, atol=1e-8)
    np.testing.assert_allclose(branch.columns["d"], 0.0, atol=1e-10)
    point = branch["UZ1"]
    start = Seed(point.problem.with_active("k", point.z), np.append(point.z[:-1], 1.0))
    other = contin.continuation(start, "k", (0.5, 20), conditions=["period = 5"], free=["d"], settings=wide)
    height, k = other.columns["x.max"], other.columns["k"]
    np.testing.assert_allclose(k * height**2, k[0] * height[0] ** 2, rtol=1e-9)
    assert other.unexplained == 0, other.notes  # of d, rounding all along, nothing is asked


def test_equilibria_under_a_condition_keep_the_stability_at_fixed_parameters():
    """x = A, y = B/A: y = x^2/2 + 1/2 gives B = A (A^2 + 1)/2; the Hopf points B = 1 + A^2 are at A = 2."""
    start = contin.equilibrium(BRUSSELATOR)
    branch = contin.continuation(start, "A", (0.5, 3), conditions=["y = x^2/2 + 0.5"], free=["B"])
    a = branch.columns["A"]
    np.testing.assert_allclose(branch.columns["B"], a * (a * a + 1) / 2, atol=1e-8)
    assert [p.type for p in branch.points] == ["HB"]
    point = branch["HB1"]
    assert point.values["A"] == pytest.approx(2.0, abs=1e-9)
    fixed = contin.continuation(contin.equilibrium(BRUSSELATOR, parameters={"A": 2, "B": 4}), "B", (4, 6))["HB1"]
    assert point.normal_form["l1"] == pytest.approx(fixed.normal_form["l1"], abs=1e-9)
    assert list(np.unique(branch.columns["unstable"])) == [0, 2]


def test_a_fold_of_equilibria_and_one_of_their_curve_are_told_apart():
    """x' = q - x^2 with p = x + q: the curve is p = x + x^2, which turns at x = -1/2; equilibria fold at x = 0."""
    model = contin.Model(name="line", states={"x": 1}, parameters={"p": 2, "q": 1}, equations={"x": "q - x^2"})
    branch = contin.continuation(contin.equilibrium(model), "p", (-1, 3), conditions=["p = x + q"], free=["q"])
    folds = {p.normal_form.get("of", "equilibria"): p for p in branch.points}
    assert len(branch.points) == 2
    assert folds["equilibria"].values["p"] == pytest.approx(0.0, abs=1e-9)
    assert folds["equilibria"].normal_form["a"] == pytest.approx(-1.0, abs=1e-9)
    assert folds["curve"].values["p"] == pytest.approx(-0.25, abs=1e-12)
    assert folds["curve"].values["x"] == pytest.approx(-0.5, abs=1e-7)


def test_a_period_doubling_under_a_condition_is_that_of_the_family_through_it_and_has_its_branches():
    model = contin.Model(
        name="roessler", states={"x": 0, "y": 0, "z": 0}, parameters={"a": -0.1, "b": 0.2, "c": 2.5},
        equations={"x": "-y - z", "y": "x + a*y", "z": "b + z*(x - c)"},
    )  # fmt: skip
    rest = contin.continuation(contin.equilibrium(model), "a", (-0.2, 0.4))
    family = contin.continuation(rest["HB1"].switch(), "a", (-0.2, 0.22), values={"a": [0.2]})
    point = family["UZ1"]
    start = Seed(family.problem.with_active("c", point.z), np.append(point.z[:-1], 2.5))
    branch = contin.continuation(start, "c", (2.5, 2.9), conditions=["period = 5.74"], free=["a"])
    assert [p.type for p in branch.points] == ["PD"]
    doubling = branch["PD1"]
    locus = contin.continuation(doubling.locus(("c", "a")), ("c", "a"), {"c": (2.6, 2.8), "a": (0.2, 0.22)})
    order = np.argsort(locus.columns["c"])
    on = np.interp(doubling.values["c"], locus.columns["c"][order], locus.columns["a"][order])
    assert on == pytest.approx(doubling.values["a"], abs=1e-5)
    doubled = contin.continuation(doubling.switch(), "c", (2.6, 2.8))
    assert doubled.columns["period"].max() > 11.0


@pytest.mark.parametrize(("conditions", "free", "message"), [
    (["period = 4"], [], "1 condition and 0 free parameters"),
    (["period == 4"], ["om"], "one `="),
    (["x = 4"], ["om"], "x has a value everywhere on the interval"),
    (["x(start) = 0.5"], ["om"], "autonomous flow may begin anywhere"),
    (["period = 4"], ["mu"], "mu varies in this run already"),
    (["period = 4"], ["zz"], "no parameter 'zz'"),
    (["3 = 4"], ["om"], "contains `period`"),
    (["x.max = 1e9"], ["om"], "no orbit near the start meets the conditions"),
])  # fmt: skip
def test_what_is_wrong_is_said(circle, conditions, free, message):
    with pytest.raises(InputError, match=message):
        contin.continuation(circle, "mu", (0.2, 2), conditions=conditions, free=free)


def test_short_forms_are_the_functionals_that_they_stand_for():
    short = relations(CIRCLE, ["amplitude + x.max*y.min = norm"], True)[0]
    long = relations(CIRCLE, ["(max(x) - min(x))/2 + max(x)*min(y) = sqrt(mean(x^2 + y^2))"], True)[0]
    assert short.residual is long.residual


@pytest.mark.parametrize("condition", ["x.max = 2", "period = 4", "mean(x^2) = 1"])
def test_a_condition_of_orbits_on_a_state_of_rest_is_told_as_one(condition):
    with pytest.raises(InputError, match=r"is one of periodic orbits, but the start is at rest.*\(x, y\)"):
        contin.continuation(contin.equilibrium(BRUSSELATOR), "A", (0.5, 3), conditions=[condition], free=["B"])


def test_a_run_under_conditions_may_start_from_an_extremum(tmp_path):
    """r' = r (m - r^2), m = 1 - (p - 2)^2/4 + q: the largest radius is at p = 2; those of 1 have q = (p - 2)^2/4."""
    model = {
        "contin": 1, "name": "hill", "states": {"x": 0.9, "y": 0}, "parameters": {"p": 1.5, "q": 0},
        "definitions": {"g": "1 + q - (p - 2)^2/4 - x^2 - y^2"}, "equations": {"x": "x*g - y", "y": "y*g + x"},
    }  # fmt: skip
    both = {"parameter": "p", "range": [1, 3]}
    hill = {"name": "hill", "as": "orbit", "extrema": ["x.max"], **both}
    level = {"name": "level", "from": "hill.EX1", "free": ["q"], "conditions": ["x.max = 1"], **both}
    path = run_file(tmp_path, model, hill, level, outputs={"json": "out.json"})
    assert call("run", path, "--quiet") == 0
    columns = results(tmp_path / "out.json")["branches"][1]["columns"]
    assert len(columns["p"]) > 5
    np.testing.assert_allclose(columns["q"], (np.array(columns["p"]) - 2.0) ** 2 / 4.0, atol=1e-7)


@pytest.mark.parametrize(
    ("condition", "words"),
    [
        ("x.maxx = 1", "x has no 'maxx' on an orbit: did you mean 'max'?"),
        ("x.top = 1", "there are x.max, x.min, x.amplitude"),
        ("z.max = 1", "z is no state or observable; they are x, y"),
        ("np.sin(x.max) = 1", "functions stand without their library"),
    ],
)
def test_a_part_that_no_orbit_has_is_answered_with_those_it_has(condition, words):
    model = contin.Model(
        "circle", states={"x": 1, "y": 0}, parameters={"m": 1},
        equations={"x": "x*(m - x^2 - y^2) - y", "y": "y*(m - x^2 - y^2) + x"},
    )  # fmt: skip
    with pytest.raises(contin.ContinError, match=re.escape(words)):
        relations(model, [condition], on_orbits=True)
