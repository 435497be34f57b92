"""Random piecewise flows with one surface of discontinuity: equilibria, boundary equilibria and sliding motion.

On v1 < c and v1 > c the flow is affine, v' = A v + b + d p (+ a cubic term that keeps v1), and u = v + s v2^2 in random
coordinates. Every row is checked against the two fields themselves: on the surface they are antiparallel, with a weight
in [0, 1], and the unstable directions are those of the Filippov field, differentiated numerically.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from contin import api
from contin.errors import InputError, NoSolutionError
from contin.model.model import Model

RANGE = (-3.0, 3.0)
FORMS = {
    "if": "({high}) if h > 0 else ({low})",
    "heaviside": "({low}) + (({high}) - ({low}))*heaviside(h)",
    "sign": "({low}) + (({high}) - ({low}))*(1 + sign(h))/2",
}
Field = Callable[[Any, float], Any]


@dataclass(frozen=True)
class Case:
    model: Model
    fields: tuple[Field, Field]  # in v, below and above
    to_v: Callable[[Any], Any]
    level: float
    slope: float  # of the level in p
    names: tuple[str, ...]
    ends: tuple[float, float]  # p at which the equilibria of each side are on the surface


def random_case(seed: int, n: int, form: str) -> Case:
    rng = np.random.default_rng(seed)
    level, slope = float(rng.uniform(-0.3, 0.3)), float(rng.choice([0.0, 0.3]))
    matrices = rng.normal(size=(2, n, n)) - 0.7 * np.eye(n)
    offsets, drifts = rng.normal(size=(2, n)), rng.normal(size=(2, n))
    turn = np.linalg.qr(rng.normal(size=(n, n)))[0] @ np.diag(rng.uniform(0.6, 1.6, n))
    inverse, shear = np.linalg.inv(turn), float(rng.uniform(-0.3, 0.3))

    def field(k: int) -> Field:
        return lambda v, p: matrices[k] @ v + offsets[k] + drifts[k] * p

    def to_v(u: Any) -> Any:
        y = inverse @ u
        return np.concatenate([[y[0] - shear * y[1] ** 2], y[1:]])

    names = tuple(f"x{k}" for k in range(n))
    text = "({!r})".format
    definitions = {f"y{i}": " + ".join(f"{text(float(inverse[i, j]))}*{names[j]}" for j in range(n)) for i in range(n)}
    definitions |= {"v0": f"y0 - {text(shear)}*y1^2"} | {f"v{i}": f"y{i}" for i in range(1, n)}
    definitions["h"] = f"v0 - {text(level)} - {text(slope)}*p"
    for i in range(n):
        low, high = (
            " + ".join(f"{text(float(matrices[k, i, j]))}*v{j}" for j in range(n))
            + f" + {text(float(offsets[k, i]))} + {text(float(drifts[k, i]))}*p"
            for k in range(2)
        )
        definitions[f"g{i}"] = FORMS[form].format(low=low, high=high)
    definitions["k0"] = f"g0 + 2*{text(shear)}*y1*g1"
    definitions |= {f"k{i}": f"g{i}" for i in range(1, n)}
    equations = {names[i]: " + ".join(f"{text(float(turn[i, j]))}*k{j}" for j in range(n)) for i in range(n)}
    model = Model("sides", states=dict.fromkeys(names, 0.0), parameters={"p": 0.0}, definitions=definitions,
                  equations=equations)  # fmt: skip
    ends = []
    for k in range(2):  # v(p) = v(0) + v'(0) p, and v1(p) = level + slope p
        at, moves = np.linalg.solve(matrices[k], -offsets[k]), np.linalg.solve(matrices[k], -drifts[k])
        ends.append(float((level - at[0]) / (moves[0] - slope)))
    return Case(model, (field(0), field(1)), to_v, level, slope, names, (ends[0], ends[1]))


def filippov(case: Case, v: Any, p: float) -> tuple[Any, float]:
    """The sliding field and its weight; the normal in v, at fixed p, is the first axis."""
    low, high = case.fields[0](v, p), case.fields[1](v, p)
    weight = low[0] / (low[0] - high[0])
    return low + weight * (high - low), weight


def sliding_unstable(case: Case, v: Any, p: float) -> tuple[int, float]:
    """Unstable directions, that across the surface included; and how clear the count is."""
    n = len(v)
    jacobian = np.empty((n - 1, n - 1))
    for j in range(1, n):
        e = 1e-6 * np.eye(n)[j]
        jacobian[:, j - 1] = (filippov(case, v + e, p)[0] - filippov(case, v - e, p)[0])[1:] / 2e-6
    values = np.linalg.eigvals(jacobian) if n > 1 else np.empty(0)
    across = case.fields[1](v, p)[0] - case.fields[0](v, p)[0]  # positive: both fields lead away
    clear = min(float(np.abs(values.real).min(initial=np.inf)), abs(float(across)))
    return int(np.sum(values.real > 0.0)) + int(across > 0.0), clear


def check(seed: int, n: int, form: str) -> tuple[int, int]:
    """Numbers of boundary equilibria and of rows of pseudo-equilibria that were checked."""
    case = random_case(seed, n, form)
    starts = [{"p": p} for p in (-2.9, 2.9)]
    met, rows = 0, 0
    for start in starts:
        try:
            diagram = api.diagram(case.model, "p", RANGE, parameters=start, orbits=False)
        except (NoSolutionError, InputError):
            continue  # Newton found no admissible equilibrium there
        for branch in diagram.branches:
            states = np.column_stack([branch.columns[name] for name in case.names])
            v = np.array([case.to_v(u) for u in states])
            p = branch.columns["p"]
            height = v[:, 0] - case.level - case.slope * p
            for end in branch.ends:
                assert end.reason in ("bound", "surface", "start"), (seed, n, form, branch.name, end)
            if "weight" in branch.columns:
                rows += len(p)
                assert np.abs(height).max() < 1e-8
                assert -1e-9 <= branch.columns["weight"].min() <= branch.columns["weight"].max() <= 1.0 + 1e-9
                for at, value, unstable in zip(v[1:-1], p[1:-1], branch.columns["unstable"][1:-1], strict=True):
                    field, weight = filippov(case, at, value)
                    assert np.abs(field).max() < 1e-7
                    assert 0.0 <= weight <= 1.0
                    expected, clear = sliding_unstable(case, at, value)
                    assert unstable == expected or clear < 1e-5, (seed, n, form, value)
            else:
                side = int(height[len(height) // 2] > 0.0)
                assert np.all((height > -1e-8) if side else (height < 1e-8))
                residual = [np.abs(case.fields[side](at, value)).max() for at, value in zip(v, p, strict=True)]
                assert max(residual) < 1e-7
            for point in branch.points:
                if point.type != "BE":
                    continue
                met += 1
                error = min(abs(point.values["p"] - end) for end in case.ends)
                assert error <= max(10.0 * point.error, 1e-12), (seed, n, form, point, case.ends)
                beyond = [b for b in diagram.branches if b.parent is not None
                          and (b.parent.branch, b.parent.label) == (branch.name, point.label)]  # fmt: skip
                for child in beyond:
                    ahead = np.sign(child.columns["p"][1] - point.values["p"])
                    behind = np.sign(branch.columns["p"][point.index - 1 if point.index else 1] - point.values["p"])
                    assert (point.normal_form["kind"] == "persistence") == (ahead != behind), (seed, n, form)
                assert beyond or any(point.label in note or "lies on" in note for note in diagram.notes) or any(
                    b is not branch and abs(float(b.columns["p"][row]) - point.values["p"]) < 1e-9
                    for b in diagram.branches for row in (0, -1)
                )  # fmt: skip
    return met, rows


@pytest.mark.parametrize(("n", "form"), [(2, "heaviside"), (3, "if")])
@pytest.mark.seldom
def test_random_piecewise_flows(n, form):
    found = np.sum([check(seed, n, form) for seed in (0, 1, 2, 3)[n - 2 :]], axis=0)
    assert found[0] > 2
    assert found[1] > 10


@pytest.mark.long
@pytest.mark.parametrize("n", [2, 3, 4, 6])
def test_many_random_piecewise_flows(n):
    for form in FORMS:
        for seed in range(100, 140):
            check(seed, n, form)


def test_persistence_then_back_to_an_equilibrium_in_closed_form():
    """x' = p - x - 2 heaviside(x - 1): x = p, then sliding at x = 1 with weight (p - 1)/2, then x = p - 2."""
    model = Model("slab", states={"x": 0.0}, parameters={"p": 0.0}, equations={"x": "p - x - 2*heaviside(x - 1)"})
    diagram = api.diagram(model, "p", (-1.0, 5.0))
    first, sliding, last = diagram.branches
    assert (first.ends[1].reason, sliding.ends[1].reason, last.ends[1].reason) == ("surface", "surface", "bound")
    assert first.ends[1].data["surface"] == "x - 1 = 0"
    np.testing.assert_allclose(sliding.columns["weight"], (sliding.columns["p"] - 1.0) / 2.0, atol=1e-12)
    np.testing.assert_allclose(sliding.columns["x"], 1.0, atol=1e-12)
    assert sliding.columns["stable"].all()
    np.testing.assert_allclose(last.columns["x"], last.columns["p"] - 2.0, atol=1e-12)
    assert [p.values["p"] for b in diagram.branches for p in b.points] == pytest.approx([1.0, 3.0], abs=1e-12)


def test_nonsmooth_fold_has_an_unstable_pseudo_equilibrium():
    """x' = p - x + heaviside(x): two stable equilibria for -1 < p < 0, between them the threshold x = 0."""
    model = Model("step", states={"x": -0.5}, parameters={"p": -0.5}, equations={"x": "p - x + heaviside(x)"})
    diagram = api.diagram(model, "p", (-2.0, 1.0))
    threshold = next(b for b in diagram.branches if "weight" in b.columns)
    assert not threshold.columns["stable"].any()
    assert sorted(threshold.columns["p"][[0, -1]]) == pytest.approx([-1.0, 0.0], abs=1e-12)
    assert {p.normal_form["kind"] for b in diagram.branches for p in b.points} == {"nonsmooth fold"}


def test_a_tiny_jump_is_not_stepped_over():
    """Newton converges on the far side of a jump of 1e-7: the branch ends at it all the same."""
    model = Model(
        "tiny", states={"x": -1.0}, parameters={"p": -1.0}, equations={"x": "p - x - (1e-7 if x > 0.2 else 0)"}
    )
    branch = api.continuation(api.equilibrium(model), "p", (-1.0, 1.0))
    assert branch.ends[1].reason == "surface"
    assert branch["BE1"].values["p"] == pytest.approx(0.2, abs=1e-12)


def test_fixed_points_of_a_map_end_at_a_jump():
    """x -> p + x/2 - heaviside(x): x = 2 p up to 0."""
    model = Model(
        "map", kind="map", states={"x": -1.0}, parameters={"p": -0.5}, equations={"x": "p + x/2 - heaviside(x)"}
    )
    branch = api.diagram(model, "p", (-1.0, 1.0))["start"]
    assert branch.ends[1].reason == "surface"
    assert branch["BE1"].values["p"] == pytest.approx(0.0, abs=1e-12)
    assert branch["BE1"].normal_form["kind"] == "border collision"


def test_a_corner_is_no_surface_of_discontinuity():
    model = Model("corner", states={"x": -0.5}, parameters={"p": -1.0}, equations={"x": "p - x - max(x, 0)"})
    branch = api.continuation(api.equilibrium(model), "p", (-1.0, 1.0))
    assert [end.reason for end in branch.ends] == ["bound", "bound"]
    assert branch.points == ()


def test_curves_of_the_sliding_motion_are_refused_in_words():
    """x' = 1 - 2 heaviside(x), y' = p - y^2 on x = 0: the pseudo-equilibria fold at p = 0."""
    model = Model(
        "fold", states={"x": -1.0, "y": 0.8}, parameters={"p": 0.64, "q": -1.0},
        equations={"x": "q - x + y - (2 if x > 0 else 0)", "y": "p - y^2"},
    )  # fmt: skip
    diagram = api.diagram(model, "q", (-3.0, 1.0), start={"x": -0.2, "y": 0.8})
    sliding = next(b for b in diagram.branches if "weight" in b.columns)
    folded = api.continuation(_at(sliding, -1), "p", (-0.5, 2.0))
    assert folded["LP1"].values["p"] == pytest.approx(0.0, abs=1e-9)
    with pytest.raises(InputError, match="sliding motion are not followed"):
        folded["LP1"].locus(("p", "q"))


def _at(branch: Any, row: int) -> Any:
    """A start with p free at a row of a branch in q."""
    from contin.continuation.seed import Seed

    problem = branch.problem.with_active("p", branch.z[row])
    z = branch.z[row].copy()
    z[-1] = problem.base[problem.active]
    return Seed(problem, z)


@pytest.mark.parametrize("jump", ["(0 if p < 0.4*q else 1)", "heaviside(p - 0.4*q)", "(1 + sign(p - 0.4*q))/2"])
def test_a_jump_that_only_the_parameter_decides_is_named(jump):
    model = Model("step", states={"x": 0.0}, parameters={"p": 0.0, "q": 1.25}, equations={"x": f"p - x + {jump}"})
    branch = api.continuation(api.equilibrium(model), "p", (-0.5, 1.0))
    end = branch.ends[1]
    assert end.reason == "surface"
    assert end.data["at"]["p"] == pytest.approx(0.5, abs=1e-8)
    assert "the equations jump at" in end.text


def test_two_surfaces_that_are_met_at_once_are_both_named_and_nothing_is_said_of_what_begins_there():
    equations = {"x": "a - x - heaviside(x - 1)", "y": "a - y - 2*heaviside(y - 1)"}
    model = Model("corner", states={"x": 0.0, "y": 0.0}, parameters={"a": 0.0}, equations=equations)
    branch = api.continuation(api.equilibrium(model), "a", (0.0, 5.0))
    (point,) = branch.points
    assert (point.type, point.normal_form["kind"]) == ("BE", "degenerate")
    assert "x - 1 = 0 and y - 1 = 0" in branch.ends[1].text


def test_two_coupled_surfaces_that_are_met_at_once():
    """x = p - 3/2 and y = p - 1/2 + x/5 come to x = 0 and y = 1 together, where rounding puts states on either side."""
    equations = {"x": "p - x - 1.5*sign(x)", "y": "p - y - 0.5*heaviside(y - 1) + 0.2*x"}
    model = Model("corner", states={"x": 1.0, "y": 1.7}, parameters={"p": 2.5}, equations=equations)
    diagram = api.diagram(model, "p", (-1.0, 3.0))
    (branch,) = diagram.branches
    (point,) = branch.points
    assert abs(point.values["p"] - 1.5) <= point.error
    assert point.normal_form["kind"] == "degenerate"
    assert sorted(str(point.normal_form["surface"]).split(" and ")) == ["x = 0", "y - 1 = 0"]
    assert any("two surfaces meet here" in note for note in diagram.notes)


def test_sliding_motion_meets_a_second_surface():
    """On x = 0 slides y' = 2p - y - sign(y): from p = 0.6 to 0.5, where y = 0; another jump stands beside as a sign."""
    equations = {"x": "p - x - 0.5*sign(x) - 0.1*sign(y)", "y": "2*p - y - sign(y) + 0.2*x"}
    model = Model("crossing", states={"x": 1.0, "y": 1.0}, parameters={"p": 2.0}, equations=equations)
    line, slides = api.diagram(model, "p", (-2.0, 2.0)).branches
    assert abs(line["BE1"].values["p"] - 0.6) <= line["BE1"].error
    assert slides.ends[1].reason == "surface"
    assert abs(slides["BE1"].values["p"] - 0.5) <= slides["BE1"].error
    np.testing.assert_allclose(slides.columns["y"], 2.0 * slides.columns["p"] - 1.0, atol=1e-9)


RELAY = {"x": "p - 0.5*x - y", "y": "x - 0.3 - k*sign(y)"}


@pytest.mark.parametrize(
    ("equations", "start", "p", "at", "edges"),
    [
        ({"x": "p - x - 2*heaviside(x - 1)"}, {"x": 1.0}, 2.2, {"x": 1.0}, (1.0, 3.0)),
        ({"x": "p - x - 2*heaviside(x - 1)"}, {"x": 1.0}, 2.0, {"x": 1.0}, (1.0, 3.0)),  # their mean is 0
        ({"x": "p - x - 2*heaviside(x - 1)"}, {"x": 0.5}, 2.0, {"x": 1.0}, (1.0, 3.0)),
        (RELAY, {"x": 0.3, "y": 0.0}, 0.2, {"x": 0.4, "y": 0.0}, (-0.35, 0.65)),
        ({"x": "(1 if x < 0 else -1) + y", "y": "p - y"}, {"x": 0.0, "y": 0.3}, 0.1, {"x": 0.0, "y": 0.1}, (-1.0, 1.0)),
    ],
)
def test_a_start_inside_the_sliding_region_is_a_pseudo_equilibrium_on_a_named_surface(equations, start, p, at, edges):
    model = Model("sliding", states=start, parameters={"p": p, "k": 1.0}, equations=equations)
    found = api.equilibrium(model)
    assert "pseudo-equilibrium" in str(found)
    assert "on the surface" in str(found)
    assert found.u == pytest.approx([at[name] for name in start], abs=1e-9)
    branch = api.continuation(found, "p", (-5.0, 5.0))
    assert [point.type for point in branch.points] == ["BE", "BE"]
    for point, edge in zip(branch.points, edges, strict=True):
        assert abs(point.values["p"] - edge) <= point.error


def test_a_zero_of_the_mean_on_a_surface_that_is_crossed_is_no_equilibrium():
    """x' = -1 below x = 0 and 1 above: with heaviside(0) = 1/2 it vanishes at x = 0, which motion leaves."""
    model = Model("crossed", states={"x": 0.0}, parameters={"p": 0.0}, equations={"x": "p - 1 + 2*heaviside(x)"})
    with pytest.raises(NoSolutionError, match="surface x"):
        api.equilibrium(model)


@pytest.mark.parametrize("jump", [1e-7, 1e-4, 1e-3])
def test_a_sliding_motion_narrower_than_a_step_has_no_rows_beyond_it(jump):
    """x' = p - x - d heaviside(x): x = 0 slides for 0 < p < d with the weight p/d, and x = p - d goes on."""
    model = Model("narrow", states={"x": -1.0}, parameters={"p": -1.0}, equations={"x": f"p - x - {jump}*heaviside(x)"})
    diagram = api.diagram(model, "p", (-1.0, 1.0))
    below, sliding, above = diagram.branches
    assert [b.ends[1].reason for b in (below, sliding, above)] == ["surface", "surface", "bound"]
    np.testing.assert_allclose(sliding.columns["weight"], sliding.columns["p"] / jump, atol=1e-6)
    assert sliding.columns["weight"].max() <= 1.0 + 1e-9
    assert abs(sliding["BE1"].values["p"] - jump) <= sliding["BE1"].error


def test_an_equilibrium_that_starts_on_the_surface_to_rounding_ends_there():
    """x' = r x (1 - x) - x/2 above x = 1/2: x = 1 - 1/(2 r), which is 1/2 at r = 1, where Newton's method arrives."""
    model = Model(
        "harvest", states={"x": 1.0}, parameters={"r": 1.0}, equations={"x": "r*x*(1 - x) - 0.5*x*heaviside(x - 0.5)"}
    )
    first, sliding = api.diagram(model, "r", (0.2, 2.0)).branches
    assert [end.reason for end in first.ends] == ["surface", "bound"]
    assert abs(first["BE1"].values["r"] - 1.0) <= first["BE1"].error
    np.testing.assert_allclose(sliding.columns["weight"], sliding.columns["r"], atol=1e-9)
