"""Stable and unstable manifolds in closed form, and by their invariance."""

from __future__ import annotations

import numpy as np
import pytest

import contin
from contin.errors import InputError
from contin.model.model import Model

LORENZ = Model(
    "lorenz", states={"x": 0, "y": 0, "z": 0}, parameters={"r": 28.0, "s": 10.0, "b": 8 / 3},
    equations={"x": "s*(y - x)", "y": "r*x - y - x*z", "z": "x*y - b*z"},
)  # fmt: skip
HENON = Model(
    "henon", kind="map", states={"x": 0.6, "y": 0.2}, parameters={"a": 1.4, "b": 0.3},
    equations={"x": "1 - a*x^2 + y", "y": "b*x"},
)  # fmt: skip


def paraboloid(sign):
    """z = -x^2/3 - y^2/4 is the stable manifold of the origin, in reversed time (sign -1) the unstable one."""
    equations = {"x": "-x", "y": "-1.5*y", "z": "z + x^2 + y^2"}
    return Model(
        "paraboloid", states={"x": 0, "y": 0, "z": 0}, parameters={"a": 1.0},
        equations={name: f"{sign}*({f})" for name, f in equations.items()},
    )  # fmt: skip


@pytest.mark.parametrize(("sign", "side"), [(1, "stable"), (-1, "unstable")])
def test_a_surface_is_the_paraboloid_that_is_known(sign, side):
    surface = contin.manifold(paraboloid(sign), side=side, length=2.0, spacing=0.4, samples=60)
    c = surface.columns
    assert (surface.kind, surface.parameters, surface.notes) == ("manifold", (), ())
    np.testing.assert_allclose(c["z"], -(c["x"] ** 2) / 3 - c["y"] ** 2 / 4, atol=3e-9)
    orbits = [np.stack([c[n][c["orbit"] == k] for n in "xyz"], axis=1) for k in np.unique(c["orbit"])]
    for one, other in zip(orbits, [*orbits[1:], orbits[0]], strict=True):
        assert np.max(np.linalg.norm(one - other, axis=1)) <= 0.4
    chords = np.linalg.norm(np.diff(orbits[3], axis=0), axis=1)
    np.testing.assert_allclose(chords.sum(), 2.0, rtol=1e-3)
    assert np.all(c["t"] * (1 if side == "unstable" else -1) >= 0.0)


def test_a_strong_manifold_is_a_curve_of_the_fastest_rate():
    strong = contin.manifold(paraboloid(1), side="stable", dimension=1, length=1.0)
    c = strong.columns
    np.testing.assert_allclose(c["x"], 0, atol=1e-12)
    np.testing.assert_allclose(c["z"], -(c["y"] ** 2) / 4, atol=1e-9)
    assert c["s"][[0, -1]] == pytest.approx([-1.0, 1.0])


@pytest.mark.parametrize(("kind", "x", "y", "factor"), [("flow", "x", "-y", 1 / 3), ("map", "-2*x", "y/2", 2 / 7)])
def test_curves_of_quadratic_systems(kind, x, y, factor):
    """y' = -y + x^2 beside x' = x: y = x^2/3. Map (-2 x, y/2 + x^2): 4 c = c/2 + 1, y = 2 x^2/7."""
    model = Model(
        "quadratic", kind=kind, states={"x": 0, "y": 0}, parameters={"a": 1.0}, equations={"x": x, "y": f"{y} + a*x^2"}
    )
    unstable = contin.manifold(model, length=3.0).columns
    np.testing.assert_allclose(unstable["y"], factor * unstable["x"] ** 2, atol=1e-9)
    assert unstable["x"].min() < -1.5
    assert unstable["x"].max() > 1.5
    stable = contin.manifold(model, side="stable", length=3.0).columns
    np.testing.assert_allclose(stable["x"], 0, atol=1e-12)
    assert stable["s"][[0, -1]] == pytest.approx([-3.0, 3.0], abs=0.1)


@pytest.mark.parametrize(("side", "length"), [("unstable", 12.0), ("stable", 3.0)])
def test_curves_of_the_henon_map_are_invariant(side, length):
    """The image (the pre-image) of a point of the first half lies on the curve: beside one of its chords."""
    c = contin.manifold(HENON, side=side, length=length).columns
    points = np.stack([c["x"], c["y"]], axis=1)
    inner = points[np.abs(c["s"]) < 0.2 * length][::5]
    if side == "unstable":
        moved = np.stack([1 - 1.4 * inner[:, 0] ** 2 + inner[:, 1], 0.3 * inner[:, 0]], axis=1)
    else:
        back = inner[:, 1] / 0.3
        moved = np.stack([back, inner[:, 0] - 1 + 1.4 * back**2], axis=1)
    starts, chords = points[:-1], np.diff(points, axis=0)
    sizes = np.sum(chords**2, axis=1)
    missed = []
    for point in moved[np.all(np.abs(moved) < 3, axis=1)]:
        part = np.clip(np.sum((point - starts) * chords, axis=1) / np.maximum(sizes, 1e-300), 0, 1)
        missed.append(np.min(np.linalg.norm(starts + part[:, None] * chords - point, axis=1)))
    assert np.mean(np.array(missed) < 1e-4 * length) > 0.8  # those beyond the curve's ends are not on it


def test_orbits_on_the_stable_manifold_of_lorenz_return_to_the_origin():
    """Where that takes less than 1.3: an error of 1e-9 grows by exp(11.8 t) beside them."""
    surface = contin.manifold(LORENZ, side="stable", length=20.0, spacing=8.0, samples=40)
    c = surface.columns
    assert surface.notes == ()
    tips = np.flatnonzero((np.abs(c["s"] - 20.0) < 1e-9) & (c["t"] > -1.3))
    assert len(tips) > 4
    for row in tips[::3]:
        start = {name: float(c[name][row]) for name in "xyz"}
        back = contin.simulate(LORENZ, start, time=float(-c["t"][row]), samples=400)
        away = np.max(np.abs([back.columns[name] for name in "xyz"]), axis=0)
        assert away.min() < 0.05


def test_the_unstable_manifold_starts_from_a_label():
    line = contin.continuation(contin.equilibrium(LORENZ, parameters={"r": 2.0}), "r", (1.5, 30), values={"r": [20]})
    curve = contin.manifold(line["UZ1"], length=10.0)
    u = np.stack([curve.columns[n] for n in "xyz"], axis=1)
    np.testing.assert_allclose(u * [-1, -1, 1], u[::-1], atol=1e-7)  # (x, y, z) -> (-x, -y, z)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"length": -1.0}, "length"), ({"length": 1.0, "side": "left"}, "side"),
        ({"length": 1.0, "dimension": 2}, "1 unstable directions, not 2"), ({"length": 1.0, "samples": 2}, "samples"),
    ],
)  # fmt: skip
def test_mistakes_are_named(options, message):
    with pytest.raises(InputError, match=message):
        contin.manifold(LORENZ, {"x": 0, "y": 0, "z": 0}, **options)


def test_surfaces_of_a_cycle_in_closed_form():
    """r = 1, z = 0 is a cycle with the multipliers exp(-2 * 2 pi) and exp(2 pi).

    With z' = z and r' = r (1 - r^2): the stable surface is z = 0, the unstable one r = 1, a cylinder.
    """
    model = Model(
        "ring", states={"x": 1, "y": 0, "z": 0}, parameters={"a": 1.0, "k": 1.0},
        equations={"x": "a*x*(1 - x^2 - y^2) - y", "y": "a*y*(1 - x^2 - y^2) + x", "z": "k*z"},
    )  # fmt: skip
    orbit = contin.periodic_orbit(model, np.column_stack([np.cos(TURN), np.sin(TURN), 0 * TURN]), times=TURN)
    point = contin.continuation(orbit, "a", (0.5, 2), values={"a": [1.0]})["UZ1"]
    unstable = contin.manifold(point, length=7, spacing=4, samples=60)
    x, y, z = (unstable.columns[name] for name in "xyz")
    assert np.abs(np.hypot(x, y) - 1.0).max() < 1e-7
    assert z.max() > 0.1 > -0.1 > z.min()  # both sheets
    stable = contin.manifold(point, side="stable", length=4, spacing=4, samples=60)
    x, y, z = (stable.columns[name] for name in "xyz")
    assert np.abs(z).max() < 1e-9
    assert np.hypot(x, y).min() < 0.5
    assert np.hypot(x, y).max() > 1.5


TURN = np.linspace(0.0, 2.0 * np.pi, 200)
