"""Families of invariant tori from NS points: radii, rotation numbers and exponents in closed form; how families end."""

import numpy as np
import pytest

import contin
from contin.errors import InputError, NoSolutionError
from contin.lowering import compile_system
from contin.tori import fourier
from contin.tori.strobe import Strobe

ANGLE = 0.71  # of the multipliers of the maps below


def ring_map(radius, twist="0"):
    """z -> (1 + radius - |z|^2) exp(i (ANGLE + twist)) z: a circle of |z|^2 = radius."""
    turned = f"({ANGLE} + {twist})"
    grown = f"(1 + {radius} - x^2 - y^2)"
    return contin.Model(
        "ring", kind="map", states={"x": 0, "y": 0}, parameters={"a": -0.1},
        equations={"x": f"{grown}*(cos{turned}*x - sin{turned}*y)", "y": f"{grown}*(sin{turned}*x + cos{turned}*y)"},
    )  # fmt: skip


def family(model, interval, label="NS1", **settings):
    rest = contin.equilibrium(model, dict.fromkeys(model.state_names, 0.0), {"a": interval[0]})
    line = contin.continuation(rest, "a", interval)
    return contin.torus(line[label], "a", interval, settings=settings)


def test_the_circle_of_a_map_has_its_radius_rotation_number_and_exponent():
    branch = family(ring_map("a", "0.3*a"), (-0.1, 0.3))
    a = branch.columns["a"]
    assert branch.ends[1].reason == "bound"
    assert a[-1] == 0.3
    assert np.allclose(branch.columns["rotation"], (ANGLE + 0.3 * a) / (2 * np.pi), atol=1e-9)
    assert np.allclose(branch.columns["x.max"], np.sqrt(np.abs(a)), atol=1e-7)
    assert np.allclose(branch.columns["x.norm"], np.sqrt(np.abs(a) / 2), atol=1e-8)
    assert np.allclose(branch.eigenvalues[1:, 0], 1 - 2 * a[1:], atol=1e-7)  # d(r (1 + a - r^2))/dr at r^2 = a
    assert branch.columns["stable"].all()
    assert branch.columns["error"].max() < 1e-6


def test_a_family_between_two_points_ends_at_the_other():
    branch = family(ring_map("a*(1 - a)"), (-0.1, 1.1))
    assert branch.ends[1].reason == "ns"
    assert branch.ends[1].data["at"]["a"] == pytest.approx(1.0, abs=1e-6)
    assert np.allclose(
        branch.columns["x.max"], np.sqrt(np.abs(branch.columns["a"] * (1 - branch.columns["a"]))), atol=1e-7
    )


def test_a_cycle_of_a_map_bears_as_many_circles():
    grown = "(1 + a - x^2 - y^2)"
    model = contin.Model(
        "two rings", kind="map", states={"x": 0, "y": 0, "w": 1}, parameters={"a": -0.1},
        equations={
            "x": f"{grown}*(cos({ANGLE})*x - sin({ANGLE})*y)", "y": f"{grown}*(sin({ANGLE})*x + cos({ANGLE})*y)",
            "w": "-w*(1 + 0.2*(1 - w^2))",
        },
    )  # fmt: skip
    cycle = contin.equilibrium(model, {"x": 0, "y": 0, "w": 1}, {"a": -0.1}, period=2)
    branch = contin.torus(contin.continuation(cycle, "a", (-0.1, 0.1))["NS1"], "a", (-0.1, 0.1))
    assert np.allclose(branch.columns["rotation"], 2 * ANGLE / (2 * np.pi), atol=1e-9)
    assert np.allclose(branch.columns["w.min"], -1)
    assert np.allclose(branch.columns["w.max"], 1)
    assert np.allclose(branch.columns["x.max"], np.sqrt(np.abs(branch.columns["a"])), atol=1e-7)
    assert np.allclose(np.sort(branch.eigenvalues[1:].real)[:, 0], 0.36, atol=1e-7)  # (1 - 0.4)^2


def test_a_subcritical_torus_is_unstable():
    grown = "(1 + a + x^2 + y^2)"
    model = contin.Model(
        "subcritical", kind="map", states={"x": 0, "y": 0}, parameters={"a": -0.1},
        equations={
            "x": f"{grown}*(cos({ANGLE})*x - sin({ANGLE})*y)",
            "y": f"{grown}*(sin({ANGLE})*x + cos({ANGLE})*y)",
        },
    )  # fmt: skip
    branch = family(model, (-0.1, 0.1))
    assert branch.columns["a"][-1] == -0.1
    assert (branch.columns["unstable"][1:] == 1).all()
    assert np.allclose(branch.eigenvalues[1:, 0], 1 - 2 * branch.columns["a"][1:], atol=1e-7)


def test_the_circle_of_the_delayed_logistic_map_turns_as_its_iterates_do_and_locks_to_one_seventh():
    model = contin.Model(
        "delayed logistic", kind="map", states={"x": 0.5, "y": 0.5}, parameters={"a": 1.8},
        equations={"x": "a*x*(1 - y)", "y": "x"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model, {"x": 0.4, "y": 0.4}), "a", (1.8, 2.3))
    branch = contin.torus(line["NS1"], "a", (1.8, 2.3))
    assert branch.columns["a"][0] == pytest.approx(2.0, abs=1e-9)
    assert branch.columns["rotation"][0] == pytest.approx(1 / 6)
    row = int(np.argmin(np.abs(branch.columns["a"] - 2.1)))
    a, points, x, y = branch.columns["a"][row], [], 0.4, 0.5
    for k in range(3000):
        x, y = a * x * (1 - y), x
        if k >= 1000:
            points.append((x, y))
    assert abs(fourier.rotation(np.array(points))) == pytest.approx(branch.columns["rotation"][row], abs=1e-7)
    assert max(p[0] for p in points) == pytest.approx(branch.columns["x.max"][row], abs=1e-4)
    assert branch.ends[1].reason == "locked"
    assert branch.ends[1].data["rotation"] == {"p": 1, "q": 7}


def test_a_forced_response_with_a_ring_around_it():
    model = contin.Model(
        "ring about a response", states={"x": 0.5, "y": 0.0}, parameters={"a": -0.2, "w": 2.0},
        definitions={"u": "x - cos(w*t)/2", "v": "y - sin(w*t)/2"}, forcing={"period": "2*pi/w"},
        equations={
            "x": "a*u - 0.6*v - u*(u^2 + v^2) - w*sin(w*t)/2",
            "y": "0.6*u + a*v - v*(u^2 + v^2) + w*cos(w*t)/2",
        },
    )  # fmt: skip
    responses = contin.continuation(contin.periodic_orbit(model, {"x": 0.5, "y": 0}), "a", (-0.2, 0.2))
    branch = contin.torus(responses["NS1"], "a", (-0.2, 0.2))
    a = np.maximum(branch.columns["a"], 0.0)
    assert np.allclose(branch.columns["rotation"], 0.3, atol=1e-8)  # 0.6/w
    assert np.allclose(branch.columns["x.max"], 0.5 + np.sqrt(a), atol=1e-4)
    assert np.allclose(branch.eigenvalues[1:, 0], np.exp(-2 * a[1:] * np.pi), atol=1e-6)


@pytest.mark.seldom
def test_the_product_of_two_oscillators():
    model = contin.Model(
        "two rings", states={"x": 1, "y": 0, "u": 0, "v": 0}, parameters={"a": -0.2, "w": 0.3},
        equations={
            "x": "x*(1 - x^2 - y^2) - y", "y": "y*(1 - x^2 - y^2) + x",
            "u": "u*(a - u^2 - v^2) - w*(1 + a)*v", "v": "v*(a - u^2 - v^2) + w*(1 + a)*u",
        },
    )  # fmt: skip
    orbits = contin.continuation(contin.periodic_orbit(model, {"x": 1, "y": 0, "u": 0, "v": 0}), "a", (-0.2, 0.2))
    branch = contin.torus(orbits["NS1"], "a", (-0.2, 0.2))
    a = np.maximum(branch.columns["a"], 0.0)
    assert a[-1] == 0.2
    assert np.allclose(branch.columns["period"], 2 * np.pi, atol=1e-7)
    assert np.allclose(branch.columns["rotation"], 0.3 * (1 + a), atol=1e-7)
    assert np.allclose(branch.columns["u.max"], np.sqrt(a), atol=1e-4)
    assert np.allclose(branch.columns["x.max"], 1, atol=1e-6)
    moduli = np.sort(branch.eigenvalues[1:].real, axis=1)
    assert np.allclose(moduli[:, 1], np.exp(-4 * np.pi * a[1:]), atol=1e-5)


@pytest.mark.long
def test_a_planar_flow_seen_from_time_to_time_has_circles_of_its_orbits_up_to_the_homoclinic_one():
    """With T the time between two looks the rotation number is T over the orbit's period."""
    parts = {"states": {"x": 0, "y": 0}, "parameters": {"a": -0.1, "T": 0.3}}
    equations = {"x": "y", "y": "-x + x^2 + y*(a - x/2)"}
    free = contin.Model("free", equations=equations, **parts)
    seen = contin.Model("seen", equations=equations, forcing={"period": "T"}, **parts)
    line = contin.continuation(contin.equilibrium(free, {"x": 0, "y": 0}), "a", (-0.1, 0.3))
    orbits = contin.continuation(line["HB1"].switch(), "a", (-0.1, 0.3))
    assert orbits.ends[1].reason == "homoclinic"
    rests = contin.continuation(contin.periodic_orbit(seen, {"x": 0, "y": 0}), "a", (-0.1, 0.3))
    branch = contin.torus(rests["NS1"], "a", (-0.1, 0.3))
    end = branch.ends[1]
    assert end.reason == "homoclinic"
    assert end.data["at"]["a"] == pytest.approx(orbits.ends[1].data["at"]["a"], abs=1e-5)
    rows = range(2, len(branch) // 2, 3)
    places = [float(branch.columns["a"][row]) for row in rows]
    line = contin.continuation(line["HB1"].switch(), "a", (-0.1, 0.3), values={"a": places})
    for row, place in zip(rows, places, strict=True):
        orbit = next(point for point in line.points if point.values["a"] == pytest.approx(place, rel=1e-12))
        assert branch.columns["rotation"][row] == pytest.approx(0.3 / orbit.values["period"], rel=1e-6)
        assert branch.columns["x.max"][row] == pytest.approx(orbit.values["x.max"], rel=1e-3)  # of mesh points


@pytest.mark.seldom
def test_a_torus_on_which_a_simulation_settles_is_followed_to_both_sides():
    model = contin.Model(
        "two rings", states={"x": 1.2, "y": 0, "u": 0.3, "v": 0}, parameters={"a": 0.3, "w": 0.37},
        equations={
            "x": "x*(1 - x^2 - y^2) - y", "y": "y*(1 - x^2 - y^2) + x",
            "u": "u*(a - u^2 - v^2) - w*v", "v": "v*(a - u^2 - v^2) + w*u",
        },
    )  # fmt: skip
    branch = contin.torus(model, "a", (0.2, 0.4), start={"x": 1.2}, settings={"intervals": 9})
    assert [end.reason for end in branch.ends] == ["bound", "bound"]
    assert branch.columns["a"][branch.start_row] == 0.3
    assert np.allclose(branch.columns["u.max"], np.sqrt(branch.columns["a"]), atol=1e-4)
    beats = branch.columns["rotation"] * 2 * np.pi / branch.columns["period"]
    assert np.allclose(np.abs(beats - np.round(beats)) % 1.0, 0.37, atol=1e-6)
    with pytest.raises(InputError, match=r"settles on no torus|no torus is found"):
        contin.torus(contin.load("classics/lorenz"), "rho", (20, 30), start={"x": 1}, parameters={"rho": 28})


def test_a_period_that_is_not_positive_is_no_solution():
    """Newton's method may lead there, from a guess on a chaotic trajectory."""
    system = compile_system(contin.load("classics/lorenz"))
    strobe = Strobe(system, np.ones(system.m), system.parameter_names.index("rho"), np.zeros(3))
    for time in -4.0, 0.0, float("nan"):
        with pytest.raises(NoSolutionError, match="period that is not positive"):
            strobe.derivatives(np.array([1.0, 1.0, 20.0]), time, 28.0)


def test_what_has_no_torus_is_said():
    line = contin.continuation(
        contin.equilibrium(contin.load("classics/brusselator"), None, {"B": 1.0}), "B", (1.0, 3.0)
    )
    with pytest.raises(InputError, match="NS"):
        contin.torus(line["HB1"], "B", (1.0, 3.0))
