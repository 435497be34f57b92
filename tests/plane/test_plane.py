"""The phase plane against closed forms: energy levels, cycles of known radius, planted equilibria."""

from importlib import import_module

import numpy as np
import pytest

import contin
from contin.errors import InputError
from contin.model.model import Model

DUFFING = Model("duffing", states={"x": 0.1, "v": 0}, parameters={"d": 0.0}, equations={"x": "v", "v": "x - x^3 - d*v"})


def circles(size: float, rate: float) -> Model:
    """Radius r (in `size`): r' = r (r^2 - 1)(4 - r^2), angle' = 1, all times `rate`; cycles at r = 1 and 2."""
    grow = f"((x^2 + y^2)/{size!r}^2 - 1)*(4 - (x^2 + y^2)/{size!r}^2)"
    return Model(
        "circles", states={"x": 0.1 * size, "y": 0}, parameters={"p": 1},
        equations={"x": f"{rate!r}*(x*{grow} - y)", "y": f"{rate!r}*(y*{grow} + x)"},
    )  # fmt: skip


def test_separatrices_of_an_oscillator_without_friction_have_the_energy_of_the_saddle():
    plane = contin.plane(DUFFING, "x", "v", x_range=(-2, 2), y_range=(-1.5, 1.5))
    assert [r.type for r in plane.rests] == ["centre of the linearisation", "saddle", "centre of the linearisation"]
    assert len(plane.separatrices) == 4
    for half in plane.separatrices:
        x, v = half.flight.points.T
        assert np.abs(v**2 / 2 - x**2 / 2 + x**4 / 4).max() < 1e-8
        assert half.flight.end == "rest"
        assert half.flight.rest == 1  # the loops are homoclinic
    assert not plane.cycles  # closed orbits around a centre are no limit cycles


def test_with_friction_unstable_manifolds_go_to_the_foci_and_stable_ones_come_from_outside():
    plane = contin.plane(DUFFING, "x", "v", {"d": 0.2}, x_range=(-2, 2), y_range=(-1.5, 1.5), points=[(1.5, 1.5)])
    ends = {(h.kind, h.flight.end, h.flight.rest) for h in plane.separatrices}
    assert ends == {("unstable", "rest", 0), ("unstable", "rest", 2), ("stable", "left", None)}
    assert plane.trajectories[0].end == "rest"
    for half in plane.separatrices:  # energy only falls along the flow
        x, v = half.flight.points.T
        energy = half.flight.sense * (v**2 / 2 - x**2 / 2 + x**4 / 4)
        assert np.all(np.diff(energy[2:]) < 1e-9)


@pytest.mark.parametrize(("size", "rate"), [(1.0, 1.0), (1e-7, 1e4), (1e6, 1e-5)])
def test_cycles_of_circles_in_any_unit(size, rate):
    """The divergence of r' = g(r) and angle' = 1 over a turn is 2 pi g'(r): g'(1) = 6, g'(2) = -24."""
    plane = contin.plane(circles(size, rate), "x", "y", x_range=(-3 * size, 3 * size), y_range=(-3 * size, 3 * size))
    assert [r.type for r in plane.rests] == ["stable focus"]
    found = sorted(plane.cycles, key=lambda c: float(np.hypot(*c.points.T).max()))
    assert [c.stable for c in found] == [False, True]
    for cycle, radius, slope in zip(found, (1.0, 2.0), (6.0, -24.0), strict=True):
        np.testing.assert_allclose(np.hypot(*cycle.points.T) / size, radius, rtol=1e-6)
        assert cycle.period * rate == pytest.approx(2 * np.pi, rel=1e-8)
        assert np.log(cycle.multiplier) == pytest.approx(2 * np.pi * slope, rel=1e-5)


def test_the_cycle_of_van_der_pols_oscillator():
    """Period at mu = 5: 11.612230667 (Strogatz; Amore 2018 gives 11.6122306677)."""
    model = Model(
        "vdp", states={"x": 0.1, "y": 0}, parameters={"mu": 5.0}, equations={"x": "y", "y": "mu*(1 - x^2)*y - x"}
    )
    plane = contin.plane(model, "x", "y")
    assert plane.cycles[0].period == pytest.approx(11.6122306677, abs=1e-8)
    assert np.all(np.abs(plane.cycles[0].points).max(axis=0) < plane.window[:, 1])  # the window holds what is met


def test_planted_equilibria_and_nullclines():
    """x' = (x - 1)(x - 2)(y - 1), y' = (y - 2)(x + y - 5): lines as nullclines, four crossings that are equilibria."""
    model = Model(
        "lines", states={"x": 0, "y": 0}, parameters={"p": 1},
        equations={"x": "(x - 1)*(x - 2)*(y - 1)", "y": "(y - 2)*(x + y - 5)"},
    )  # fmt: skip
    plane = contin.plane(model, "x", "y", x_range=(0.1, 4.7), y_range=(0.1, 4.7))
    places = sorted(tuple(np.round(r.u, 9)) for r in plane.rests)
    assert places == [(1.0, 2.0), (1.0, 4.0), (2.0, 2.0), (2.0, 3.0), (4.0, 1.0)]
    for curve in plane.nullclines[0]:
        x, y = curve.T
        assert np.abs((x - 1) * (x - 2) * (y - 1)).max() < 1e-9
    for curve in plane.nullclines[1]:
        x, y = curve.T
        assert np.abs((y - 2) * (x + y - 5)).max() < 1e-9


def test_a_jump_through_zero_is_no_nullcline():
    model = Model(
        "relay", states={"x": 0.3, "y": 0.2}, parameters={"p": 1},
        equations={"x": "-x", "y": "1 - 2*heaviside(y - 0.123*x)"},
    )  # fmt: skip
    plane = contin.plane(model, "x", "y", x_range=(-1, 1), y_range=(-1, 1))
    assert plane.nullclines[1] == ()


def test_a_rotating_pendulum_has_a_saddle_a_focus_and_a_cycle_around_the_cylinder():
    model = Model(
        "pendulum", states={"phi": {"value": 0.1, "period": "2*pi"}, "w": 0}, parameters={"c": 0.2, "b": 0.4},
        equations={"phi": "w", "w": "b - c*w - sin(phi)"},
    )  # fmt: skip
    plane = contin.plane(model, "phi", "w", y_range=(-3, 3))
    assert sorted(r.type for r in plane.rests) == ["saddle", "stable focus"]
    (cycle,) = plane.cycles
    assert np.log(cycle.multiplier) == pytest.approx(-0.2 * cycle.period, rel=1e-6)  # the divergence is -c
    assert plane.plot().axes


@pytest.mark.seldom
def test_other_states_are_held_and_a_function_gives_the_same_plane(monkeypatch):
    monkeypatch.setattr(import_module("contin.plane.portrait"), "CELLS_OF_FUNCTIONS", 24)  # of its nullclines
    written = Model(
        "three", states={"x": 0.2, "y": 0.1, "z": 2.0}, parameters={"a": 1},
        equations={"x": "y", "y": "a*x*(z - 1) - x^3 - 0.5*y", "z": "-z"},
    )  # fmt: skip
    function = contin.FunctionProblem(
        lambda u, p: np.array([u[1], p["a"] * u[0] * (u[2] - 1) - u[0] ** 3 - 0.5 * u[1], -u[2]]),
        np.array([0.2, 0.1, 2.0]), {"a": 1.0}, states=("x", "y", "z"),
    )  # fmt: skip
    planes = [contin.plane(m, "x", "y", x_range=(-2, 2), y_range=(-2, 2)) for m in (written, function)]
    for plane in planes:
        assert "held: z = 2" in plane.notes[0]
        assert sorted(r.type for r in plane.rests) == ["saddle", "stable focus", "stable focus"]
        assert {(h.kind, h.flight.end) for h in plane.separatrices} == {("unstable", "rest"), ("stable", "left")}
    other = contin.plane(written, "x", "y", at={"z": 0.0}, x_range=(-2, 2), y_range=(-2, 2))
    assert [r.type for r in other.rests] == ["stable focus"]


def test_a_map_has_fixed_points_and_iterates():
    model = Model(
        "henon", kind="map", states={"x": 0.1, "y": 0.1}, parameters={"a": 1.4, "b": 0.3},
        equations={"x": "1 - a*x^2 + y", "y": "b*x"},
    )  # fmt: skip
    plane = contin.plane(model, "x", "y", x_range=(-2, 2), y_range=(-0.6, 0.6), points=[(0.1, 0.1)])
    fixed = sorted(float(r.u[0]) for r in plane.rests)  # a x^2 + (1 - b) x - 1 = 0
    np.testing.assert_allclose(fixed, np.sort(np.roots([1.4, 0.7, -1.0])), rtol=1e-12)
    assert all(r.stability == "saddle" for r in plane.rests)
    x, y = plane.trajectories[0].points.T
    np.testing.assert_allclose(x[1:], 1 - 1.4 * x[:-1] ** 2 + y[:-1], atol=1e-12)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"x": "x", "y": "q"}, "no state 'q'"),
        ({"x": "x", "y": "x"}, "two different states"),
        ({"at": {"x": 1}}, "there is no other state to hold"),
        ({"x_range": (1, 0)}, "expected low < high"),
        ({"points": [(1, 2, 3)]}, "expected pairs"),
    ],
)
def test_refusals(options, words):
    with pytest.raises(InputError, match=words):
        contin.plane(DUFFING, **{"x": "x", "y": "v", **options})


def test_models_that_have_no_plane_say_so():
    forced = Model(
        "forced", states={"x": 0, "v": 0}, parameters={"w": 1}, equations={"x": "v", "v": "cos(w*t) - x - v"},
        forcing={"period": "2*pi/w"},
    )  # fmt: skip
    with pytest.raises(InputError, match="forced"):
        contin.plane(forced, "x", "v")


@pytest.mark.seldom
def test_a_cycle_with_jumps_has_the_multiplier_of_its_map():
    """v' = I - v with v = 0 at v = 1, w' = -w with w = w + d there: period T = log(I/(I - 1)), multiplier exp(-T)."""
    model = Model(
        "fire", states={"v": 0, "w": 0.3}, parameters={"I": 1.5, "d": 0.5}, equations={"v": "I - v", "w": "-w"},
        events=[{"when": "v - 1", "direction": "up", "set": {"v": "0", "w": "w + d"}}],
    )  # fmt: skip
    plane = contin.plane(model, "v", "w", x_range=(-0.5, 1.5), y_range=(-0.5, 1.5), points=[(0.0, 0.3)])
    (cycle,) = plane.cycles
    assert cycle.period == pytest.approx(np.log(3.0), rel=1e-8)
    assert cycle.multiplier == pytest.approx(1.0 / 3.0, rel=1e-6)


@pytest.mark.parametrize("unit", [1.0, 1e15, 1e-12])
def test_a_state_that_starts_at_zero_has_its_natural_size_beside_one_that_does_not(unit):
    """Half the window of y was 1 where x starts at 2e-15: no cycle was seen."""
    model = Model(
        "van-der-pol", states={"x": 2.0 / unit, "y": 0}, parameters={"m": 1},
        equations={"x": "y", "y": f"m*(1 - ({unit!r}*x)^2)*y - x"},
    )  # fmt: skip
    plane = contin.plane(model, "x", "y")
    (cycle,) = plane.cycles
    assert cycle.period == pytest.approx(6.66328686, rel=1e-7)
    assert np.abs(plane.window).max() < 10.0 / unit


def test_a_plane_with_a_conserved_sum_says_that_equilibria_are_lines():
    model = Model("closed", states={"x": 1, "y": 0}, parameters={"k": 0.5}, equations={"x": "k*y - x", "y": "x - k*y"})
    assert any("x and y is conserved" in note for note in contin.plane(model, "x", "y").notes)
