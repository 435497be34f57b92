"""Piecewise equations: folds on a switching surface, corners that are no folds, jumps that end a branch."""

from dataclasses import dataclass, field
from math import pi

import numpy as np
import pytest

import contin
from contin.model.model import Model
from tests.problems.cases import oscillator, zeros
from tests.problems.follow import assert_labels, follow, labels, reasons

R = (-1.0, 1.5)


@dataclass(frozen=True)
class Corner:
    equations: dict[str, str]
    states: dict[str, object]
    start: float
    range: tuple[float, float]
    nonsmooth: list[float]  # parameter values of folds at corners
    smooth: list[tuple[str, float]] = field(default_factory=list)
    ends: tuple[str, str] = ("bound", "bound")


def escapement(x1: float) -> str:
    """r' = -p r/2 + min(1, (r/x1)^2) r/(pi (1 + r^2)): for x1 = 1, p has its maximum 1/pi where the impulse ends."""
    return f"-p*r/2 + min(1, r^2/{x1 * x1!r})*r/(pi*(1 + r^2))"


ROOT = "p - x if x < 0.4 else p - 0.4 + 3*sqrt(x - 0.4)"  # p = x below, p = 0.4 - 3 sqrt(x - 0.4) above
CORNERS = {
    "a line, then a root of infinite slope": Corner({"x": ROOT}, {"x": 0.2}, 0.2, (-3.0, 2.0), [0.4]),
    "a root of infinite slope, then a line": Corner({"x": ROOT}, {"x": 0.8}, 0.4 - 3 * 0.4**0.5, (-3.0, 2.0), [0.4]),
    "p = |x|": Corner({"x": "p - abs(x)"}, {"x": -1.0}, 1.0, R, [0.0]),
    "p = |x| in two states": Corner({"x": "p - abs(x) + y", "y": "x/10 - y"}, {"x": -1.0, "y": -0.1}, 1.1, R, [0.0]),
    "p = max(x, -2x): slopes 1 and -2": Corner({"x": "p - max(x, -2*x)"}, {"x": -0.5}, 1.0, R, [0.0]),
    "p = -min(x, -x/1000)": Corner({"x": "p + min(x, -x/1000)"}, {"x": -1.0}, 1.0, R, [0.0]),
    "conditional: parabola against line": Corner({"x": "p - (x^2 + x if x > 0 else -x/2)"}, {"x": -1.0}, 0.5, R, [0.0]),
    "diamond |x| + |p| = 1": Corner(
        {"x": "abs(x) + abs(p) - 1"}, {"x": 0.5}, 0.5, (-2.0, 2.0), [1.0, -1.0], ends=("closed", "closed")
    ),
    "hysteresis of saturation: p = sat(3x) - x": Corner(
        {"x": "p - max(-1, min(1, 3*x)) + x"}, {"x": -3.0}, 2.0, (-2.5, 2.5), [2 / 3, -2 / 3]
    ),
    "square wave: p = x + |x-1| - |x+1|": Corner(
        {"x": "p + abs(x + 1) - abs(x - 1) - x"}, {"x": -3.0}, -1.0, (-3.0, 3.0), [1.0, -1.0]
    ),
    "a maximum at a corner: p = min(1, r^2) 2/(pi (1 + r^2))": Corner(
        {"r": escapement(1.0)}, {"r": 2.0}, 2 / (5 * pi), (0.01, 2.0), [1 / pi]
    ),
    "a smooth fold 5e-4 from a corner that is none": Corner(
        {"x": "p - (x^2 - 0.001*x if x > 0 else -x)"}, {"x": 1.0}, 0.999, R, [], [("LP", -2.5e-7)]
    ),
    "two folds 1e-3 apart, in one step": Corner(
        {"x": "p - x + 3*max(0, x - 0.5) - 3*max(0, x - 0.501)"}, {"x": 0.0}, 0.0, R, [0.5, 0.498]
    ),
    "two folds 1e-5 apart, at right angles to the branch": Corner(
        {"x": "p - x + 2*max(0, x - 0.5) - 2*max(0, x - 0.50001)"}, {"x": 0.0}, 0.0, R, [0.5, 0.49999]
    ),
    "two slopes of one sign": Corner({"x": "p - min(x, 2*x)"}, {"x": 0.5}, 0.5, R, []),
    "three slopes of one sign": Corner({"x": "p - 2*abs(x) + 2*abs(x - 1) - x/2"}, {"x": -2.0}, -3.0, (-3.0, 3.0), []),
    "x |x| is smooth enough": Corner({"x": "p - x*abs(x) - x"}, {"x": 0.5}, 0.75, R, []),
}


@pytest.mark.parametrize("name", CORNERS)
def test_folds_at_corners_are_those_where_the_parameter_turns(name):
    case = CORNERS[name]
    branch = follow(case.equations, case.states, {"p": case.start}, case.range)
    assert_labels(branch, [("LP", v) for v in case.nonsmooth] + case.smooth)
    kinds = [p.normal_form.get("kind") for p in branch.points]
    assert kinds.count("nonsmooth") == len(case.nonsmooth)
    assert reasons(branch) == case.ends
    assert branch.notes == ()
    for point in branch.points:
        wanted = min((v for v in [*case.nonsmooth, *(v for _, v in case.smooth)]), key=lambda v: abs(v - point.z[-1]))
        assert abs(point.z[-1] - wanted) <= point.error


@pytest.mark.parametrize("name", CORNERS)
def test_every_row_solves_the_equations_also_beside_corners(name):
    case = CORNERS[name]
    branch = follow(case.equations, case.states, {"p": case.start}, case.range)
    system = branch.problem.system
    assert len(branch.z) > 10
    for z in branch.z:
        f, slopes = system.jacobian(z[:-1], branch.problem.full_parameters(z))
        assert np.abs(f).max() < 1e-7 * max(1.0, float(np.abs(slopes).max()))  # beside a root: the row's distance


def test_jump_of_stability_at_a_corner_is_noted_and_not_a_hopf_point():
    """x'' - s(z) x' + x = 0 with s = sign of z = p: the pair jumps from -1/2 to 1/2 without being imaginary."""
    branch = follow(
        {"x": "-y + (1 if z > 0 else -1)*x", "y": "x", "z": "p - z"}, {**zeros("x y"), "z": -1.0}, {"p": -1.0}, R
    )
    assert branch.points == ()
    assert len(branch.notes) == 1
    assert "jumps at a corner" in branch.notes[0]
    assert set(branch.columns["unstable"][branch.columns["p"] < 0]) == {0}
    assert set(branch.columns["unstable"][branch.columns["p"] > 0]) == {2}


@pytest.mark.parametrize("place", [0.0, 0.37])
@pytest.mark.parametrize("start", [-1.0, 0.0])
@pytest.mark.parametrize("kind", ["map", "flow"])
def test_jump_of_stability_at_a_corner_is_noted_exactly_where_it_is(kind, start, place):
    """A map's slope jumps from 0.4 to -1.3 at x = 0 (border collision); a flow's trace from -0.4 to 0.2."""
    if kind == "map":
        piece = Model(
            "border", kind="map", states={"x": start}, parameters={"p": start + place},
            equations={"x": f"p - {place} + (0.4*x if x < 0 else -1.3*x)"},
        )  # fmt: skip
    else:
        piece = Model(
            "pair", states={"x": start, "y": 0.0}, parameters={"p": start + place},
            equations={"x": "y + 0.3*abs(x)", "y": f"p - {place} - x - 0.1*y"},
        )  # fmt: skip
    branch = contin.continuation(contin.equilibrium(piece), "p", (-2.0, 2.0))
    assert branch.points == ()
    (note,) = (note for note in branch.notes if "corner" in note)
    where = note.removeprefix("at p = ").split(",")[0]
    assert float(where) == pytest.approx(place, abs=1e-12)


@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize("turn", ["abs(x)", "max(x, -2*x)", "(x if x > 0 else -3*x)"])
def test_a_start_on_a_fold_at_a_corner_is_that_fold(turn, unit):
    states = {"x": {"value": 0.0, "scale": unit}}
    model = Model("corner", states=states, parameters={"p": 0.0}, equations={"x": f"{unit}*p - {turn}"})
    branch = contin.continuation(contin.equilibrium(model), "p", (-2.0, 2.0))
    assert_labels(branch, [("LP", 0.0)])
    assert branch.points[0].normal_form["kind"] == "nonsmooth"
    assert reasons(branch) == ("bound", "bound")
    assert branch.columns["p"].min() >= -1e-12


def test_hopf_point_with_a_kink_in_the_growth_rate_is_a_hopf_point():
    branch = follow(oscillator("x", "y", "(1 if p > 0 else 3)*p"), zeros("x y"), {"p": -1.0}, R)
    assert_labels(branch, [("HB", 0.0)], atol=1e-9)


@pytest.mark.parametrize("jump", ["heaviside(x - 0.5)", "sign(x - 0.5)", "(1 if x > 0.5 else 0)"])
def test_branch_ends_at_a_jump_of_the_equations_and_does_not_leap_over_it(jump):
    """x = p below the jump; beyond it another line solves the equations, parallel to the first."""
    shift = 1.0 if jump.startswith("sign") else 0.0
    branch = follow({"x": f"p - x + {jump}"}, {"x": -0.5 - shift}, {"p": -0.5}, R)
    assert reasons(branch) == ("bound", "surface")
    assert branch.columns["x"].max() < 0.5 + 1e-6
    assert branch.columns["p"].max() == pytest.approx(0.5 + shift, abs=1e-6)


@pytest.mark.parametrize("jump", [0.3, 1e-6])
def test_a_branch_does_not_lead_across_a_jump_that_a_root_hides(jump):
    """Beside the surface the upper side differs by 3 sqrt(h), which is larger than the jump a rounding error away."""
    steep = {"x": f"p - x if x < 0.4 else p - 0.4 + {jump} + 3*sqrt(x - 0.4)"}
    branch = follow(steep, {"x": 0.8}, {"p": 0.4 - jump - 3 * 0.4**0.5}, (-3.0, 2.0))
    assert branch.columns["x"].min() >= 0.4
    assert labels(branch) == []


def test_the_average_of_a_threshold_in_velocity_folds_where_the_threshold_is_reached():
    """y^3 above y = 0.4, -3/10 y^5: at r = 0.4 only the damping is left, alpha = -3/10 5/8 0.4^4, with a root above."""
    model = contin.load({
        "contin": 1, "name": "threshold", "states": {"x": 1.7, "y": 0}, "parameters": {"alpha": -0.5, "eps": 0.01},
        "equations": {"x": "y", "y": "-x + eps*(-alpha*y + (y^3 if y > 0.4 else 0) - 3/10*y^5)"},
        "averaging": {"small": "eps", "oscillators": [{"position": "x", "velocity": "y"}]},
    })  # fmt: skip
    averaged = contin.average(model, form="polar")
    branch = contin.continuation(contin.equilibrium(averaged, {"r": 1.7}), "alpha", (-14, 3))
    (corner,) = [p for p in branch.points if p.normal_form.get("kind") == "nonsmooth"]
    assert corner.values["alpha"] == pytest.approx(-0.0048, abs=min(corner.error, 1e-12))
    assert corner.values["r"] == pytest.approx(0.4, abs=1e-15)
