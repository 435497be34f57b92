"""Finding all equilibria in a box: counts that are known, images linked, disconnected branches reached."""

import numpy as np
import pytest

import contin
from contin import api
from contin.errors import InputError
from contin.search.equilibria_in_box import make_box


def polynomial():
    """x^6 in disguise: roots -2, -1, 0, 1, 2 in x, and y = x^2."""
    return contin.Model(
        "roots", states={"x": 0.3, "y": 0.1}, parameters={"p": 0.0},
        equations={"x": "x*(y - 1 + p)*(x^2 - 4)", "y": "x^2 - y"}, symmetries={"flip": {"x": "-x"}},
    )  # fmt: skip


@pytest.mark.parametrize(("mu", "expected"), [(6.0, 4), (3.0, 6), (0.3, 8)])
@pytest.mark.parametrize("form", ["typed", "polar", "stokes"])
def test_averaged_pair_has_4_6_and_8_equilibria(form, mu, expected):
    if form == "typed":
        model = contin.load("metronomes/pair-averaged")
    else:
        model = contin.average(contin.load("metronomes/pair"), form=form)
    box = {"S1": (-9, 9), "S2": (-9, 9), "S3": (-9, 9)} if form == "stokes" else {"r1": (0.01, 3), "r2": (0.01, 3)}
    found = contin.find_equilibria(model, box, {"mu": mu, "beta": 0.8})
    everything = found
    if form == "stokes":  # total rest is a state of this form
        found = [one for one in found if np.linalg.norm(one.u) > 1e-3]
    assert len(found) == expected
    system = api.compiled(model)
    for one in found:
        np.testing.assert_allclose(system.value(one.u, one.equilibrium.p), 0.0, atol=1e-12)
    images = [one for one in found if one.image_of is not None]
    assert len(images) == (expected - 4) // 2
    for one in images:
        assert one.symmetry == "exchange"
        mirror = system.symmetry("exchange", everything[one.image_of].u[None], one.equilibrium.p)[0]
        gap = mirror - one.u
        if form != "stokes":
            gap[2] -= 2 * np.pi * np.round(gap[2] / (2 * np.pi))
        np.testing.assert_allclose(gap, 0.0, atol=1e-9)


def test_all_roots_are_found_with_the_unstable_counts_and_links():
    found = contin.find_equilibria(polynomial(), (-5, 5))
    np.testing.assert_allclose([one.u[0] for one in found], [-2, -1, 0, 1, 2], atol=1e-12)
    np.testing.assert_allclose([one.u[1] for one in found], [4, 1, 0, 1, 4], atol=1e-12)
    assert [one.image_of for one in found] == [None, None, None, 1, 0]
    for one in found:
        x, y = one.u
        jacobian = np.array([[(y - 1) * (3 * x**2 - 4), x * (x**2 - 4)], [2 * x, -1]])
        assert one.unstable == int(np.sum(np.linalg.eigvals(jacobian).real > 0))


def test_a_box_selects_and_a_continuum_is_not_listed_point_by_point():
    inside = contin.find_equilibria(polynomial(), {"x": (0.5, 5), "y": (-1, 10)})
    np.testing.assert_allclose([one.u[0] for one in inside], [1, 2], atol=1e-12)
    circle = contin.Model(
        "circle", states={"x": 1, "y": 0.2}, parameters={"a": 1},
        equations={"x": "x*(a - x^2 - y^2)", "y": "y*(a - x^2 - y^2)"},
    )  # fmt: skip
    found = contin.find_equilibria(circle, (-2, 2))
    assert [one.isolated for one in found].count(False) == 1
    isolated = [one for one in found if one.isolated]
    assert len(isolated) == 1
    np.testing.assert_allclose(isolated[0].u, 0.0, atol=1e-12)


def test_fixed_points_of_maps_and_equilibria_of_functions():
    henon = contin.Model(
        "henon", kind="map", states={"x": 0.6, "y": 0.2}, parameters={"a": 1.4, "b": 0.3},
        equations={"x": "1 - a*x^2 + y", "y": "b*x"},
    )  # fmt: skip
    roots = np.sort(np.roots([1.4, 0.7, -1.0]))
    np.testing.assert_allclose([one.u[0] for one in contin.find_equilibria(henon, (-3, 3))], roots, atol=1e-12)
    cubic = contin.FunctionProblem(lambda u, p: p["a"] * u - u**3, [0.1], {"a": 1.0})
    np.testing.assert_allclose([one.u[0] for one in contin.find_equilibria(cubic, (-3, 3))], [-1, 0, 1], atol=1e-12)
    broken = contin.FunctionProblem(lambda u, p: np.array([u[0] - 1 / p["missing"]]), [0.1], {"a": 1.0})
    with pytest.raises(contin.ContinError, match="the residual raised KeyError: 'missing'"):
        contin.find_equilibria(broken, (-1, 1))


def test_fifty_states_on_a_lattice_of_bistable_cells():
    n = 50
    u = [f"u{k}" for k in range(n)]
    model = contin.Model(
        "lattice", states=dict.fromkeys(u, 0.0), parameters={"c": 0.0},
        equations={u[k]: f"c*({u[k - 1]} - 2*{u[k]} + {u[(k + 1) % n]}) + {u[k]} - {u[k]}^3" for k in range(n)},
    )  # fmt: skip
    found = contin.find_equilibria(model, (-1.5, 1.5), {"c": 0.6}, starts=20)
    assert len(found) > 3
    assert all(one.isolated for one in found)


def test_the_explorer_reaches_a_disconnected_branch():
    isola = contin.Model(
        "isola", states={"x": 0.0}, parameters={"p": {"value": 0.0, "range": [-2, 2]}},
        equations={"x": "-x*((x - 3)^2 + p^2 - 1)"},
    )  # fmt: skip
    connected = contin.diagram(isola, "p")
    assert len(connected) == 1
    everywhere = contin.diagram(isola, "p", start="all", box={"x": (-1, 6)})
    assert len(everywhere) == 2
    ring = next(b for b in everywhere.branches if b.columns["x"].max() > 1)
    assert {e.reason for e in ring.ends} == {"closed"}
    assert sorted(round(p.values["p"], 9) for p in ring.points) == [-1.0, 1.0]
    assert everywhere.notes == []


def test_the_isola_of_the_cubic_autocatalator_in_a_stirred_tank():
    """Gray and Scott (1983): the reacting states form an isola in the residence time t, apart from a = 1, b = 0.

    Folds where t = 4 (1 + k t)^2; Hopf point at b = sqrt(k), (1 + k t)^2 = sqrt(k) t (the larger root).
    """
    k = 0.04
    model = contin.Model(
        "autocatalator", states={"a": 1.0, "b": 0.0}, parameters={"tau": 50.0, "k": k},
        equations={"a": "(1 - a)/tau - a*b^2", "b": "-b/tau + a*b^2 - k*b"},
    )  # fmt: skip
    box = {"a": (0, 1), "b": (0, 1)}
    assert len(contin.find_equilibria(model, box)) == 3
    diagram = contin.diagram(model, "tau", (1, 400), start="all", box=box, orbits=False)
    assert len(diagram) == 2
    [isola] = [branch for branch in diagram if branch.points]
    assert {end.reason for end in isola.ends} == {"closed"}
    folds = sorted(point.values["tau"] for point in isola.points if point.type == "LP")
    np.testing.assert_allclose(folds, np.sort(np.roots([4 * k**2, 8 * k - 1, 4]).real), rtol=1e-10)
    [hopf] = [point for point in isola.points if point.type == "HB"]
    expected = max(np.roots([k**2, 2 * k - np.sqrt(k), 1]).real)
    assert (hopf.values["tau"], hopf.values["b"]) == pytest.approx((expected, np.sqrt(k)), rel=1e-10)


def test_boxes_are_checked():
    with pytest.raises(InputError, match=r"box: no state z; there are x, y"):
        contin.find_equilibria(polynomial(), {"z": (0, 1)})
    with pytest.raises(InputError, match=r"say between which values to look for y, e.g. y: \(-2, 2\)"):
        contin.find_equilibria(polynomial(), {"x": (0, 1)})
    with pytest.raises(InputError, match=r"x needs bounds lo < hi; got \(1, 0\)"):
        contin.find_equilibria(polynomial(), (1, 0))


def test_starts_fill_the_box_evenly():
    box = make_box(["x", "y", "a"], {"x": (0, 2), "y": (-1, 1)}, np.array([0.0, 0.0, 2 * np.pi]))
    points = box.starts(512)
    counts, _ = np.histogramdd(points, bins=(4, 4, 4), range=[(0, 2), (-1, 1), (-np.pi, np.pi)])
    assert counts.sum() == 512
    assert counts.min() >= 4
    assert counts.max() <= 14


@pytest.mark.parametrize("size", [1e-15, 1.0, 1e12])
def test_states_of_any_size_are_found_where_the_model_says_nothing_about_them(size):
    """x' = size (x/size) (1 - (x/size)^2): 0 and +-size, and nothing else."""
    inner = f"(x/{size})"
    model = contin.Model(
        "sized", states={"x": 0.0}, parameters={"a": 1.0}, equations={"x": f"{size}*{inner}*(a - {inner}^2)"}
    )
    found = sorted(float(e.u[0]) / size for e in contin.find_equilibria(model))
    np.testing.assert_allclose(found, [-1.0, 0.0, 1.0], atol=1e-12)


@pytest.mark.seldom
def test_a_declared_size_widens_the_box_and_a_diagram_says_where_it_looked():
    """x' = x (1 - x/K) with K = 1000 a: the second equilibrium is 1e6 times as far as the start."""
    equations = {"x": "x*(1 - x/(1000*a))"}
    for scale, count in ((None, 1), ("400*a", 1), ("600*a", 2)):
        state = 1e-3 if scale is None else {"value": 1e-3, "scale": scale}
        model = contin.Model("logistic", states={"x": state}, parameters={"a": 1.0}, equations=equations)
        diagram = contin.diagram(model, "a", (0.5, 2.0), start="all")
        assert len(diagram.branches) == count
        (note,) = (n for n in diagram.notes if "looked for" in n)
        reach = "0.002" if scale is None else f"{2.0 * float(scale[:3]):g}"
        assert f"x within {reach} of 0" in note
    diagram = contin.diagram(model, "a", (0.5, 2.0), start="all", box={"x": (-1, 3000)})
    assert not any("looked for" in n for n in diagram.notes)
