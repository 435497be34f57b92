"""Equations that jump at a value of a parameter: every kind of branch ends there, however small the jump is."""

import importlib

import pytest

import contin
from contin import api

SIZES = [1e-1, 1e-6]


def jump(size, at="p - 0.5"):
    return f"{size}*heaviside({at})"


def assert_ends_at(branch, value, name="p", surface="p - 0.5 = 0"):
    end = branch.ends[1]
    assert end.reason == "surface"
    assert surface in end.text
    assert end.data["at"]["p"] == pytest.approx(branch.columns["p"][-1], abs=1e-8)
    assert branch.columns[name][-1] == pytest.approx(value, abs=1e-8)
    assert branch.columns[name].max() <= value
    assert branch.notes == ()


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("kind", ["flow", "map", "algebraic"])
def test_points(kind, size):
    formula = f"0.5*x + 0.5*p + {jump(size)}" if kind == "map" else f"p - x + {jump(size)}"
    options = {} if kind == "flow" else {"kind": kind}
    model = contin.Model("jump", states={"x": 0.1}, parameters={"p": 0.1}, equations={"x": formula}, **options)
    branch = api.continuation(api.equilibrium(model), "p", (0.1, 1.0))
    assert_ends_at(branch, 0.5)
    assert branch.columns["x"][-1] == pytest.approx(0.5, abs=1e-8)  # the limit from the side that it comes from


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("method", ["collocation", "shooting"])
def test_cycles(method, size):
    rate = f"(3 + {jump(size)})"
    model = contin.Model(
        "cycle", states={"x": 1, "y": 0}, parameters={"p": 0.1},
        equations={"x": f"x*(1 - x^2 - y^2) - {rate}*y", "y": f"{rate}*x + y*(1 + p - x^2 - y^2)"},
    )  # fmt: skip
    start = api.periodic_orbit(model, period=2.1, transient=20, method=method)
    assert_ends_at(api.continuation(start, "p", (0.1, 1.0)), 0.5)


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("where", ["equation", "condition"])
def test_boundary_values(where, size):
    inner, outer = (jump(size), "0") if where == "equation" else ("0", jump(size))
    model = contin.Model(
        "between", kind="bvp", time={"name": "t", "from": 0, "to": 1}, states={"u": 0, "v": 0}, parameters={"p": 0.1},
        equations={"u": "v", "v": f"-p*exp(u) + {inner}"}, conditions=[f"u(start) = {outer}", "u(end) = 0"],
    )  # fmt: skip
    assert_ends_at(api.continuation(api.boundary_problem(model), "p", (0.1, 1.0)), 0.5)


@pytest.mark.parametrize("size", SIZES)
def test_curves_in_two_parameters(size):
    """Folds of p + (1 + q) x - x^3, p = 2 ((1 + q)/3)^(3/2) on one side of q = 1/2."""
    model = contin.Model(
        "curve", states={"x": -1}, parameters={"p": -0.9, "q": 0.1},
        equations={"x": f"p + (1 + q)*x - x^3 + {jump(size, 'q - 0.5')}"},
    )  # fmt: skip
    line = api.continuation(api.equilibrium(model), "p", (-2, 2))
    curve = api.continuation(line["LP1"].locus(), ["p", "q"], {"p": (-3, 3), "q": (0, 1)})
    assert_ends_at(curve, 0.5, "q", "q - 0.5 = 0")
    assert abs(curve.columns["p"][-1]) == pytest.approx(2 * 0.5**1.5, abs=1e-8)


ROOT = "p - x + 0.1*heaviside(p - 0.5)*abs(p - 0.5)^0.5"


@pytest.mark.parametrize("formula", ["p - x + abs(p - 0.5)", ROOT, "-x*(x - 2*heaviside(p - 0.5) - 3)"])
def test_a_corner_or_a_jump_elsewhere_is_passed(formula):
    """The last: from x = 0, which solves the equation on both sides."""
    start = 0.0 if "x*(" in formula else 0.1
    model = contin.Model("corner", states={"x": start}, parameters={"p": 0.1}, equations={"x": formula})
    branch = api.continuation(api.equilibrium(model), "p", (0.1, 1.0))
    assert branch.ends[1].reason == "bound"
    assert branch.columns["p"][-1] == 1.0


def test_rows_beyond_a_jump_that_nothing_leads_to_do_not_belong_to_the_branch():
    """Beyond p = 1/2 the solutions are 1/2 +- sqrt(p - 51/100): a step lands on them, and none lies next to x = p."""
    model = contin.Model(
        "gap", states={"x": 0.1}, parameters={"p": 0.1},
        equations={"x": "(1 - heaviside(p - 0.5))*(p - x) + heaviside(p - 0.5)*(p - 0.51 - (x - 0.5)^2)"},
    )  # fmt: skip
    assert_ends_at(api.continuation(api.equilibrium(model), "p", (0.1, 1.0), settings={"step": 0.2}), 0.5)


@pytest.mark.parametrize("size", [0.1, 1e-4])
def test_functions_of_two_parameters(size):
    """Along the folds p = 2 ((1 + q)/3)^(3/2) the function changes its sign where p + 2 q = 6/5."""
    model = contin.Model(
        "curve", states={"x": -1}, parameters={"p": -0.9, "q": 0.1},
        equations={"x": f"p + (1 + q)*x - x^3 + {jump(size, 'p + 2*q - 1.2')}"},
    )  # fmt: skip
    line = api.continuation(api.equilibrium(model), "p", (-2, 2))
    curve = api.continuation(line["LP1"].locus(), ["p", "q"], {"p": (-3, 3), "q": (0, 1)})
    p, q = (curve.columns[name][-1] for name in ("p", "q"))
    assert curve.ends[1].reason == "surface"
    assert p + 2 * q == pytest.approx(1.2, abs=1e-8)
    assert p == pytest.approx(2 * ((1 + q) / 3) ** 1.5, abs=1e-8)


@pytest.mark.parametrize("size", [0.1, 1e-4])
@pytest.mark.parametrize(("step", "at"), [("floor(3*p)", 1 / 3), ("ceil(20*p - 0.1)", 0.105), ("mod(p, 0.45)", 0.45)])
def test_step_functions_of_a_parameter(step, at, size):
    """The first of their jumps counts, however many lie in a step."""
    model = contin.Model("steps", states={"x": 0.1}, parameters={"p": 0.1}, equations={"x": f"p - x + {size}*{step}"})
    branch = api.continuation(api.equilibrium(model), "p", (0.1, 1.0))
    assert branch.ends[1].reason == "surface"
    assert branch.columns["p"][-1] == pytest.approx(at, abs=1e-8)


@pytest.mark.parametrize("size", [0.1, 1e-4, -1e-3])
@pytest.mark.parametrize("kind", ["map", "algebraic"])
def test_step_functions_of_a_state(kind, size):
    """x = p up to x = 1/5; with jumps up there are two solutions at some p, with jumps down there is none."""
    formula = f"p - x + {size}*floor(5*x)" if kind == "algebraic" else f"0.5*(x + p) + {size}*floor(5*x)"
    model = contin.Model("steps", kind=kind, states={"x": 0.1}, parameters={"p": 0.1}, equations={"x": formula})
    branch = api.continuation(api.equilibrium(model), "p", (0.1, 1.0))
    assert branch.ends[1].reason == "surface"
    assert branch.columns["x"][-1] == pytest.approx(0.2, abs=1e-8)
    assert branch.columns["p"][-1] == pytest.approx(0.2, abs=1e-8)


@pytest.mark.parametrize("missing", [0, 1])
def test_what_is_seen_at_one_distance_alone_is_no_jump(monkeypatch, missing):
    """Across a corner of root type two points 1e-10 apart in p are 1e-5 apart in x."""
    jumping = importlib.import_module("contin.continuation.ends.jumping")
    whole = jumping.by_unknown

    def partly(*given):
        return [(limit, None if k == missing else beyond) for k, (limit, beyond) in enumerate(whole(*given))]

    monkeypatch.setattr(jumping, "by_unknown", partly)
    model = contin.Model("root", states={"x": 0.1}, parameters={"p": 0.1}, equations={"x": ROOT})
    branch = api.continuation(api.equilibrium(model), "p", (0.1, 1.0))
    assert branch.ends[1].reason == "bound"
    assert branch.unexplained == 1
    assert "the solution could not be computed" in branch.notes[0]
