"""Curves of the stroboscopic map of forced flows, and strong surfaces of cycles."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import contin
from contin.errors import InputError
from contin.model.model import Model

DUFFING = Model(
    "duffing", states={"x": 0, "y": 0}, parameters={"e": 0.001, "a": 0.0, "d": 0.25, "w": 1.0},
    forcing={"period": "2*pi/w"}, equations={"x": "y", "y": "x - x^3 - e*(a*sin(w*t) + d*y)"},
)  # fmt: skip


def saddle(e, a):
    """The orbit beside the saddle of Duffing's double well."""
    t = np.linspace(0.0, 2.0 * np.pi, 60)
    orbit = contin.periodic_orbit(DUFFING, 0 * np.column_stack([t, t]), {"e": e}, times=t)
    return contin.continuation(orbit, "a", (0, 2 * a), values={"a": [a]})["UZ1"]


def curve_of(branch):
    return np.stack([branch.columns["x"], branch.columns["y"]], axis=1)


def first_crossing(branch):
    """x > 1 where the curve that leaves to positive x first crosses y = 0: a cubic through four of its points."""
    u, own = curve_of(branch), branch.columns["orbit"]
    left, right = u[own == 0][::-1], u[own == 2]
    u = right if right[len(right) // 4, 0] > u[own == 1][0, 0] else left
    k = int(np.flatnonzero((u[:-1, 1] * u[1:, 1] <= 0) & (u[:-1, 0] > 1))[0])
    y, x = u[k - 1 : k + 3, 1], u[k - 1 : k + 3, 0]
    return float(np.polyfit(y, x, 3)[-1])


@pytest.mark.parametrize(("a", "d"), [(1.0, 0.25), (0.3, 0.25)])
def test_the_splitting_of_separatrices_is_melnikovs(a, d):
    """On y = 0 the energies differ by e M(0), M = -4 d/3 + sqrt(2) pi w a sech(pi w/2), dH/dx = sqrt(2).

    Guckenheimer and Holmes, sec. 4.5, with -sin in place of cos, t0 = pi/2. The sign of M changes at a = 0.753 d.
    """
    melnikov = -4 * d / 3 + np.sqrt(2) * np.pi * a / np.cosh(np.pi / 2)
    for e, within in ((1e-3, 0.02), (2.5e-4, 0.006)):
        point = saddle(e, a)
        unstable = contin.manifold(point, length=4.0)
        stable = contin.manifold(point, side="stable", length=4.0)
        apart = first_crossing(unstable) - first_crossing(stable)
        assert apart / e == pytest.approx(melnikov / np.sqrt(2), rel=within)


@pytest.mark.parametrize("side", ["stable", "unstable"])
def test_images_of_the_tangle_lie_on_it(side):
    """By scipy's integrator, within 1e-4 of the length."""
    length = 20.0
    c = contin.manifold(saddle(1.0, 0.3), side=side, length=length)
    assert c.notes == ()
    points, s = curve_of(c), np.abs(c.columns["s"])
    inner = points[s < (0.05 if side == "unstable" else 0.015) * length][::3]
    assert len(inner) > 4
    turn = 2 * np.pi if side == "unstable" else -2 * np.pi

    def rate(t, u):
        return [u[1], u[0] - u[0] ** 3 - 0.3 * np.sin(t) - 0.25 * u[1]]

    starts, chords = points[:-1], np.diff(points, axis=0)
    for u in inner:
        image = solve_ivp(rate, (0, turn), u, rtol=1e-10, atol=1e-12).y[:, -1]
        part = np.clip(np.sum((image - starts) * chords, axis=1) / np.sum(chords**2, axis=1), 0, 1)
        assert np.min(np.linalg.norm(starts + part[:, None] * chords - image, axis=1)) < 1e-4 * length


def test_a_linear_forced_saddle_has_straight_curves():
    """x' = x + cos t, y' = -2 y: through the orbit x = (sin t - cos t)/2, with multipliers exp(2 pi), exp(-4 pi)."""
    model = Model(
        "line", states={"x": -0.5, "y": 0}, parameters={"k": 1.0, "w": 1.0}, forcing={"period": "2*pi/w"},
        equations={"x": "k*x + cos(w*t)", "y": "-2*y"},
    )  # fmt: skip
    t = np.linspace(0.0, 2.0 * np.pi, 60)
    orbit = contin.periodic_orbit(model, np.column_stack([(np.sin(t) - np.cos(t)) / 2, 0 * t]), times=t)
    point = contin.continuation(orbit, "k", (0.5, 2), values={"k": [1.0]})["UZ1"]
    unstable = contin.manifold(point, length=3.0)
    np.testing.assert_allclose(unstable.columns["y"], 0, atol=1e-9)
    assert unstable.columns["x"][[0, -1]] == pytest.approx([-3.5, 2.5], abs=0.1)
    stable = contin.manifold(point, side="stable", length=3.0)
    np.testing.assert_allclose(stable.columns["x"], -0.5, atol=1e-9)
    with pytest.raises(InputError, match=r"1 unstable directions, not 2"):
        contin.manifold(point, length=3.0, dimension=2)


def test_the_strong_surface_of_a_cycle_of_several_multipliers():
    """r = 1, z = w = 0 with the rates 1 of z and 0.3 of w, w' = 0.3 w + z^2: the strong surface is w = z^2/1.7."""
    model = Model(
        "ring", states={"x": 1, "y": 0, "z": 0, "w": 0}, parameters={"a": 1.0},
        equations={"x": "a*x*(1 - x^2 - y^2) - y", "y": "a*y*(1 - x^2 - y^2) + x", "z": "z", "w": "0.3*w + z^2"},
    )  # fmt: skip
    t = np.linspace(0.0, 2.0 * np.pi, 100)
    orbit = contin.periodic_orbit(model, np.column_stack([np.cos(t), np.sin(t), 0 * t, 0 * t]), times=t)
    point = contin.continuation(orbit, "a", (0.5, 2), values={"a": [1.0]})["UZ1"]
    with pytest.raises(InputError, match=r"2 unstable multipliers .* `dimension: 2`"):
        contin.manifold(point, length=7)
    c = contin.manifold(point, length=7, spacing=4, samples=40, dimension=2).columns
    assert np.abs(np.hypot(c["x"], c["y"]) - 1.0).max() < 1e-7
    np.testing.assert_allclose(c["w"], c["z"] ** 2 / 1.7, atol=1e-5 * np.abs(c["z"]).max())
    assert c["z"].max() > 0.1 > -0.1 > c["z"].min()
