"""Maps: fixed points and cycles against closed forms."""

import mpmath
import numpy as np
import pytest

import contin
from contin import api
from contin.errors import InputError
from contin.systems.iterate import iterate

WIDE = (2.5, 4.0)


def logistic(**more):
    return contin.Model(
        "logistic", kind="map", states={"x": 0.6}, parameters={"r": 2.5}, equations={"x": "r*x*(1 - x)"}, **more
    )


def henon():
    return contin.Model(
        "henon", kind="map", states={"x": 0.6, "y": 0.2}, parameters={"a": 0.2, "b": 0.3},
        equations={"x": "1 - a*x^2 + y", "y": "b*x"},
    )  # fmt: skip


def delayed_logistic():
    return contin.Model(
        "delayed", kind="map", states={"x": 0.4, "y": 0.4}, parameters={"a": 1.8},
        equations={"x": "a*x*(1 - y)", "y": "x"},
    )  # fmt: skip


def labels(branch):
    return [point.label for point in branch.points]


def test_logistic_map_has_its_transcritical_point_at_1_and_its_flip_at_3():
    line = api.continuation(api.equilibrium(logistic()), "r", (0.5, 4.0))
    assert labels(line) == ["BP1", "PD1"]
    assert line["BP1"].values["r"] == pytest.approx(1.0, abs=1e-13)
    assert line["BP1"].normal_form["kind"] == "transcritical"
    flip = line["PD1"]
    assert flip.values["r"] == pytest.approx(3.0, abs=1e-13)
    assert abs(flip.values["r"] - 3.0) <= flip.error < 1e-11
    assert flip.normal_form["c"] == pytest.approx(9.0, rel=1e-10)  # B = -2 r, C = 0: c = B^2/(2 (1 - (-1)))/2
    assert flip.normal_form["criticality"] == "supercritical"
    np.testing.assert_allclose(flip.eigenvalues, [-1.0], atol=1e-10)
    x, r = line.columns["x"], line.columns["r"]
    np.testing.assert_allclose(x, 1.0 - 1.0 / r, atol=1e-9)
    np.testing.assert_allclose(line.eigenvalues[:, 0].real, 2.0 - r, atol=1e-8)


def test_two_cycles_of_the_logistic_map_follow_their_closed_form():
    line = api.continuation(api.equilibrium(logistic()), "r", WIDE)
    cycle = api.continuation(line["PD1"].switch(), "r", WIDE)
    assert cycle.parent is not None
    assert (cycle.parent.label, cycle.kind) == ("PD1", "fixed-point")
    assert [e.reason for e in cycle.ends] == ["start", "bound"]
    r, x = cycle.columns["r"], cycle.columns["x"]
    root = np.sqrt((r + 1) * np.maximum(r - 3, 0))
    expected = np.minimum(np.abs(x - (r + 1 + root) / (2 * r)), np.abs(x - (r + 1 - root) / (2 * r)))
    np.testing.assert_allclose(expected[1:], 0.0, atol=1e-10)  # row 0 is the flip, where the root has rounding errors
    multiplier = 4 + 2 * r - r**2
    np.testing.assert_allclose(cycle.eigenvalues[:, 0].real, multiplier, atol=1e-7)
    np.testing.assert_array_equal(cycle.columns["period"], 2.0)
    assert cycle["PD1"].values["r"] == pytest.approx(1 + np.sqrt(6), abs=1e-12)


def doubling_value(period, x, r):
    """Parameter at which the cycle of this period near (x, r) has multiplier -1, by Newton with 50 digits."""
    mpmath.mp.dps = 50

    def equations(x, r):
        y, slope = x, mpmath.mpf(1)
        for _ in range(period):
            slope *= r * (1 - 2 * y)
            y = r * y * (1 - y)
        return y - x, slope + 1

    return float(mpmath.findroot(equations, (mpmath.mpf(x), mpmath.mpf(r)))[1])


def test_the_cascade_of_the_logistic_map_is_followed_to_period_64():
    point = api.continuation(api.equilibrium(logistic()), "r", WIDE)["PD1"]
    values = [point.values["r"]]
    for k in range(1, 7):
        branch = api.continuation(point.switch(), "r", WIDE)
        assert labels(branch) == ["PD1"]
        assert branch.ends[1].reason == "bound"
        assert branch.steps < 80
        point = branch["PD1"]
        assert point.values["period"] == 2**k
        exact = doubling_value(2**k, point.values["x"], point.values["r"])
        assert abs(point.values["r"] - exact) <= point.error + 2.0 * np.spacing(exact)  # which is rounded itself
        assert point.error < 1e-12
        values.append(point.values["r"])
    gaps = np.diff(values)
    assert gaps[-2] / gaps[-1] == pytest.approx(4.669201609, abs=2e-3)  # Feigenbaum 1978


def test_period_three_of_the_logistic_map_is_born_at_a_fold_at_1_plus_root_8():
    start = api.equilibrium(logistic(), {"x": 0.149}, {"r": 3.84}, period=3)
    assert str(start).startswith("point x = 0.149")
    cycle = api.continuation(start, "r", (3.5, 3.9))
    fold = cycle["LP1"]
    assert fold.values["r"] == pytest.approx(1 + np.sqrt(8), abs=1e-12)
    assert fold.values["period"] == 3
    assert [p.type for p in cycle.points].count("LP") == 1
    window = [p.values["r"] for p in cycle.points if p.type == "PD"]
    assert window == [pytest.approx(doubling_value(3, 0.149, 3.8415), abs=1e-12)]


@pytest.mark.parametrize("b", [0.3, -0.2, 0.9])
def test_henon_map_has_its_fold_flip_and_second_flip_at_their_closed_forms(b):
    start = api.equilibrium(henon(), {"x": 0.6, "y": 0.6 * b}, {"a": 0.2 * (1 - b) ** 2, "b": b})
    line = api.continuation(start, "a", (-0.5, 2.0), direction="up")
    assert line["PD1"].values["a"] == pytest.approx(3 * (1 - b) ** 2 / 4, abs=1e-12)
    down = api.continuation(start, "a", (-1.0, 0.5), direction="down", settings={"steps": 60})
    assert down["LP1"].values["a"] == pytest.approx(-((1 - b) ** 2) / 4, abs=1e-12)
    doubled = api.continuation(line["PD1"].switch(), "a", (-0.5, 2.0))
    second = (1 - b) ** 2 + (1 + b) ** 2 / 4
    assert doubled["PD1"].values["a"] == pytest.approx(second, abs=1e-11)
    for row in range(len(doubled)):  # the product of the multipliers of a 2-cycle is det^2 = b^2
        assert np.prod(doubled.eigenvalues[row]).real == pytest.approx(b**2, rel=1e-8)


def test_delayed_logistic_map_has_a_neimark_sacker_point_at_2():
    line = api.continuation(api.equilibrium(delayed_logistic()), "a", (1.1, 2.6))
    assert labels(line) == ["NS1"]
    point = line["NS1"]
    assert point.values["a"] == pytest.approx(2.0, abs=1e-13)
    assert point.normal_form["theta"] == pytest.approx(np.pi / 3, abs=1e-12)
    assert point.normal_form["criticality"] == "supercritical"  # Kuznetsov, 3rd ed., example 4.2: an invariant circle
    assert point.values["unstable"] == 0
    np.testing.assert_allclose(np.abs(point.eigenvalues), 1.0, atol=1e-12)


def test_odd_cubic_map_has_pitchfork_and_symmetric_cycles():
    cubic = contin.Model(
        "cubic", kind="map", states={"x": 0.0}, parameters={"mu": 0.0}, equations={"x": "mu*x - x^3"},
        symmetries={"flip": {"x": "-x"}},
    )  # fmt: skip
    rest = api.continuation(api.equilibrium(cubic), "mu", (-2.5, 2.5))
    assert labels(rest) == ["PD1", "BP1"]
    assert rest["PD1"].values["mu"] == pytest.approx(-1.0, abs=1e-13)
    assert rest["PD1"].normal_form["criticality"] == "subcritical"
    assert rest["BP1"].normal_form["kind"] == "pitchfork"
    assert rest["BP1"].normal_form["criticality"] == "supercritical"
    side = api.continuation(rest["BP1"].switch(), "mu", (-2.5, 2.5))
    np.testing.assert_allclose(side.columns["x"] ** 2, np.maximum(side.columns["mu"] - 1, 0), atol=1e-9)
    assert side["PD1"].values["mu"] == pytest.approx(2.0, abs=1e-12)
    symmetric = api.continuation(rest["PD1"].switch(), "mu", (-2.5, 2.5))
    np.testing.assert_allclose(symmetric.columns["x"] ** 2, symmetric.columns["mu"] + 1, atol=1e-9)


def test_a_bubble_of_two_cycles_ends_where_it_joins_the_fixed_point_again():
    bubble = contin.Model(
        "bubble", kind="map", states={"x": 0.6}, parameters={"p": -0.9},
        equations={"x": "(3.2 - p^2)*x*(1 - x)"},
    )  # fmt: skip
    line = api.continuation(api.equilibrium(bubble), "p", (-1.0, 1.0))
    np.testing.assert_allclose([q.values["p"] for q in line.points], [-np.sqrt(0.2), np.sqrt(0.2)], atol=1e-12)
    cycle = api.continuation(line["PD1"].switch(), "p", (-1.0, 1.0))
    assert cycle.points == ()
    assert cycle.ends[1].reason == "joined"
    assert cycle.ends[1].data["at"] == pytest.approx(np.sqrt(0.2), abs=1e-10)
    assert cycle.symmetries != ()


def test_user_functions_give_the_same_cascade():
    problem = contin.FunctionProblem(lambda u, p: p["r"] * u * (1 - u), [0.6], {"r": 2.5}, kind="map", states=["x"])
    line = api.continuation(problem, "r", WIDE)
    cycle = api.continuation(line["PD1"].switch(), "r", WIDE)
    assert line["PD1"].values["r"] == pytest.approx(3.0, abs=1e-12)
    assert cycle["PD1"].values["r"] == pytest.approx(1 + np.sqrt(6), abs=1e-10)


@pytest.mark.parametrize("times", [2, 3, 6])
def test_derivatives_of_iterates_are_those_of_the_composed_formulas(times):
    from contin.lowering import compile_system
    from contin.model.expression import substitute, symbol

    model = contin.Model(
        "mix", kind="map", states={"x": 0.3, "y": 0.2}, parameters={"a": 0.7, "b": 0.4},
        equations={"x": "a*sin(x) + y^2", "y": "b*x*y + cos(a*x)"}, observables={"sum": "x + y"},
    )  # fmt: skip
    formulas = list(model.equations)
    for _ in range(times - 1):
        known = {symbol(s): e for s, e in zip(model.state_names, formulas, strict=True)}
        formulas = substitute(list(model.equations), known)
    composed = compile_system(model.replace(equations=tuple(formulas)))
    iterated = iterate(compile_system(model), times)
    u, p = np.array([0.31, -0.24]), np.array([0.7, 0.4])
    generator = np.random.default_rng(3)
    d = generator.normal(size=(3, 4))
    held = {"rtol": 1e-12, "atol": 1e-13}
    np.testing.assert_allclose(iterated.value(u, p), composed.value(u, p), **held)
    np.testing.assert_allclose(iterated.jacobian(u, p)[1], composed.jacobian(u, p)[1], **held)
    for k in (1, 2, 3):
        np.testing.assert_allclose(iterated.derivative(u, p, *d[:k]), composed.derivative(u, p, *d[:k]), **held)
    mixed = (d[0] + 1j * d[1], d[2], d[0] - 1j * d[1])
    np.testing.assert_allclose(iterated.derivative(u, p, *mixed), composed.derivative(u, p, *mixed), **held)
    np.testing.assert_allclose(iterated.gradient(u, p, d[0]), composed.gradient(u, p, d[0]), **held)
    assert iterated.observable_names == ("sum", "period")
    np.testing.assert_allclose(iterated.observables(u, p), [[u.sum(), times]])


def test_iterates_do_not_nest_and_flows_have_none():
    system = api.compiled(logistic())
    assert iterate(iterate(system, 2), 3).times == 6
    assert iterate(iterate(system, 2), 3).base is system
    assert iterate(system, 1) is system
    with pytest.raises(InputError, match="only a map can be iterated"):
        api.equilibrium(contin.load("brusselator"), period=2)
    with pytest.raises(InputError, match="whole number >= 1; got 0"):
        iterate(system, 0)


def test_the_explorer_follows_the_cascade_to_period_64_and_each_cycle_once():
    found = api.diagram(logistic(), "r", WIDE)
    periods = [1.0, *(b.columns["period"][0] for b in found.branches[1:])]
    assert periods == [1, 2, 4, 8, 16, 32, 64]
    bubble = contin.Model(
        "bubble", kind="map", states={"x": 0.6}, parameters={"p": -0.9},
        equations={"x": "(3.2 - p^2)*x*(1 - x)"},
    )  # fmt: skip
    found = api.diagram(bubble, "p", (-1.0, 1.0))
    assert [b.name for b in found.branches] == ["start", "start/PD1"]


def test_cycles_have_all_their_iterates_as_columns_in_order_with_least_and_largest():
    """Period two of the logistic map: (r + 1 -+ sqrt((r - 3)(r + 1)))/(2 r)."""
    line = api.continuation(api.equilibrium(logistic()), "r", (2.5, 3.6))
    doubled = api.continuation(line["PD1"].switch(), "r", (2.5, 3.4)).columns
    r = doubled["r"]
    gap = np.sqrt(np.maximum((r - 3) * (r + 1), 0.0))
    tolerance = {"rtol": 0.0, "atol": 1e-7}  # at r = 3 the root of rounding
    np.testing.assert_allclose(doubled["x.min"], (r + 1 - gap) / (2 * r), **tolerance)
    np.testing.assert_allclose(doubled["x.max"], (r + 1 + gap) / (2 * r), **tolerance)
    np.testing.assert_allclose(doubled["x.2"], r * doubled["x.1"] * (1 - doubled["x.1"]), rtol=1e-9)
    np.testing.assert_allclose(doubled["x.1"], r * doubled["x.2"] * (1 - doubled["x.2"]), rtol=1e-9)
    assert np.array_equal(doubled["x"], doubled["x.1"])
