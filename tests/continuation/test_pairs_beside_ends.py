"""Two events between the last row and a bound, or the start and the first row, are found as between any two rows."""

import pytest

import contin
from contin import api

SIZES = [(1e-3, 1.5), (1e-4, 10.0), (1e-6, 10.0)]  # half the pair's distance, bound / that
PAIR = "(p - {e})*(p + {e})"  # critical values change their sides at p = -e and e


def of_kind(kind, e, start):
    """A model whose trivial branch has the pair, and the label's type."""
    pair, p = PAIR.format(e=e), {"p": start}
    if kind == "map":
        equations = {"x": f"(-1 - {pair})*x + x^3", "y": "0.3*y + p"}
        return contin.Model("map", kind="map", states={"x": 0, "y": 1}, parameters=p, equations=equations), "PD"
    if kind == "algebraic":
        equations = {"x": f"{pair}*x + x^3", "y": "y - 1 - p^2"}
        return contin.Model("alg", kind=kind, states={"x": 0, "y": 1}, parameters=p, equations=equations), "BP"
    equations = {
        "x": f"-({pair} + x^2 + y^2)*x - 1.7*y", "y": f"1.7*x - ({pair} + x^2 + y^2)*y",
    }  # fmt: skip
    return contin.Model("flow", states={"x": 0, "y": 0}, parameters=p, equations=equations), "HB"


@pytest.mark.parametrize(("e", "far"), SIZES)
@pytest.mark.parametrize("kind", ["flow", "map", "algebraic"])
@pytest.mark.parametrize("at", ["end", "start", "inside"])
def test_both_of_a_pair(kind, e, far, at):
    """`inside`: the start lies beside the pair, and the branch goes on in both senses."""
    start = -0.53 if at == "end" else -far * e
    bounds = (-0.53, far * e) if at == "end" else (start if at == "start" else -0.53, 0.5)
    model, type_ = of_kind(kind, e, start)
    branch = api.continuation(api.equilibrium(model), "p", bounds)
    found = [point for point in branch.points if point.type == type_]
    assert [point.type for point in branch.points] == [type_] * 2
    for point, exact in zip(found, (-e, e), strict=True):
        assert abs(point.values["p"] - exact) <= max(point.error, 1e-15)


@pytest.mark.parametrize("third", [2e-3, 1.2e-3])
def test_a_pair_before_a_bound_and_a_third_one_behind_it(third):
    """Signs differ between the row before the bound and the one behind it, by the third crossing alone."""
    model = contin.Model(
        "three", states={"x": 0, "y": 1}, parameters={"p": -0.53},
        equations={"x": f"(p - 1e-3)*(p + 1e-3)*(p - {third})*x - x^3", "y": "p^2 + 1 - y"},
    )  # fmt: skip
    branch = api.continuation(api.equilibrium(model), "p", (-0.53, 1.1e-3))
    assert [point.type for point in branch.points] == ["BP", "BP"]
    assert branch.columns["p"].max() <= 1.1e-3


def test_cycles_too():
    """z' = -(p - e)(p + e) z - z^3 beside a circle of radius 1."""
    model = contin.Model(
        "circle", states={"x": 1, "y": 0, "z": 0}, parameters={"p": -0.53},
        equations={
            "x": "x*(1 - x^2 - y^2) - 3*y", "y": "3*x + y*(1 - x^2 - y^2)", "z": "-(p - 1e-3)*(p + 1e-3)*z - z^3",
        },
    )  # fmt: skip
    branch = api.continuation(api.periodic_orbit(model, period=2.1), "p", (-0.53, 1.5e-3))
    assert [point.type for point in branch.points] == ["BPC", "BPC"]
    assert [point.values["p"] for point in branch.points] == pytest.approx([-1e-3, 1e-3], abs=1e-9)


def test_equations_without_a_value_behind_the_bound():
    model = contin.Model(
        "root", states={"x": 0, "y": 1}, parameters={"p": -0.5},
        equations={"x": "(p + 1e-3)*x - x^3", "y": "1 + log(1.01e-3 - p) - y"},
    )  # fmt: skip
    branch = api.continuation(api.equilibrium(model), "p", (-0.5, 1e-3))
    assert [point.type for point in branch.points] == ["BP"]
    assert branch.ends[1].reason == "bound"


@pytest.mark.parametrize("e", [1e-2, 1e-5])
@pytest.mark.parametrize("part", [0.7, 0.97])
@pytest.mark.parametrize("kind", ["flow", "map", "algebraic"])
def test_a_pair_in_the_last_step_that_is_allowed(kind, part, e):
    """No row beyond tells of it. The start is moved so that the pair lies at this part of the last step."""

    def followed(start):
        model, type_ = of_kind(kind, e, start)
        settings = {"steps": 5, "step": 0.05, "max_step": 0.05}
        return api.continuation(api.equilibrium(model), "p", (start, start + 3), settings=settings), type_

    before, last = followed(-2.0)[0].columns["p"][-2:]
    branch, type_ = followed(-2.0 - before - part * (last - before))
    inside = [p for p in (-e, e) if p < branch.columns["p"][-1]]
    assert branch.ends[1].reason == "steps"
    assert [point.type for point in branch.points] == [type_] * len(inside)
    for point, exact in zip(branch.points, inside, strict=True):
        assert abs(point.values["p"] - exact) <= max(point.error, 1e-15)
