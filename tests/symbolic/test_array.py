"""Copies of a model joined to each other: equations, permutations, and a parametrically driven array in closed form."""

import math

import numpy as np
import pytest

import contin
from contin.errors import InputError
from contin.model.evaluate import evaluate_all
from contin.symbolic.passes.array import array

SHAPES = {
    "all": (np.ones((4, 4)) - np.eye(4), ["exchange12", "exchange23", "exchange34"]),
    "ring": (np.roll(np.eye(4), 1, 0) + np.roll(np.eye(4), -1, 0), ["rotate", "reflect"]),
    "chain": (np.diag(np.ones(3), 1) + np.diag(np.ones(3), -1), ["reflect"]),
}


def cell(**more):
    return contin.Model(
        "cell",
        states={"x": 1.0, "y": 0.2},
        parameters={"mu": 0.4},
        equations={"x": "y", "y": "mu*(1 - x^2)*y - x"},
        symmetries={"flip": {"x": "-x", "y": "-y"}},
        starts={"far": {"x": 2.0}},
        observables={"size": "x^2 + y^2"},
        **more,
    )


@pytest.mark.parametrize("shape", SHAPES)
def test_copies_are_joined_to_their_neighbours(shape):
    joined = array(cell(), 4, {"x": "k*(x_other - x)", "y": "k*y_other^2"}, shape=shape, parameters={"k": 0.7})
    chance = np.random.default_rng(1)
    x, y = chance.normal(size=(2, 4))
    env = {"mu": 0.4, "k": 0.7} | {f"x{i + 1}": x[i] for i in range(4)} | {f"y{i + 1}": y[i] for i in range(4)}
    found = np.array(evaluate_all(joined.equations, env)).reshape(4, 2)
    adjacent, names = SHAPES[shape]
    np.testing.assert_allclose(found[:, 0], y + 0.7 * (adjacent @ x - adjacent.sum(1) * x), atol=1e-14)
    np.testing.assert_allclose(found[:, 1], 0.4 * (1 - x**2) * y - x + 0.7 * (adjacent @ y**2), atol=1e-14)
    assert [s.name for s in joined.symmetries] == names
    assert set(joined.observables) == {f"size{i + 1}" for i in range(4)}
    u, _ = joined.start_point("far")
    assert list(u[::2]) == [2.0] * 4


def test_fixed_ends_are_walls_at_rest_and_symmetries_of_a_copy_are_kept():
    joined = array(cell(), 3, {"y": "0.5*(x_other - x)"}, shape="chain", ends="fixed")
    env = {"mu": 0.4, "x1": 1.0, "x2": 2.0, "x3": 4.0, "y1": 0.0, "y2": 0.0, "y3": 0.0}
    found = dict(zip(joined.state_names, evaluate_all(joined.equations, env), strict=True))
    assert [found["y1"], found["y2"], found["y3"]] == pytest.approx([-1.0, -1.5, -7.0])
    assert [s.name for s in joined.symmetries] == ["reflect", "flip"]


def test_a_pair_of_resonators_has_the_amplitude_of_its_closed_form():
    """In phase, lambda = 1: (h/8)^2 = (gamma/2 + eta r^2/8)^2 + (d/4 - sigma/2 + 3 r^2/8)^2, along the whole branch."""
    join = {"y": "eps*(d + h*cos(2*(1 + eps*sigma/2)*t))*(x_other - x)/2"}
    pair = array(contin.load("oscillators/mems-resonator"), 2, join, shape="chain", ends="fixed")
    slow = contin.average(pair, form="cartesian")
    line = contin.continuation(contin.equilibrium(slow, "rest"), "h", (0.1, 4))
    found = [p for p in line.points if p.type == "BP"]
    expected = [8 / k * math.hypot(0.1, 0.5 * k / 4 - 0.3) for k in (1, 3)]
    assert sorted(p.values["h"] for p in found) == pytest.approx(sorted(expected), rel=1e-10)
    for p in found:
        k = 1 if p.values["h"] == pytest.approx(expected[0]) else 3
        fork = contin.continuation(p.switch(), "h", (0.1, 4))
        h, r = fork.columns["h"], fork.columns["r1"]
        right = np.hypot(0.1 + 0.3 * r**2 / 8, 0.5 * k / 4 - 0.3 + 3 * r**2 / 8)
        np.testing.assert_allclose(h * k / 8, right, rtol=1e-8)
        np.testing.assert_allclose(fork.columns["r2"], r, atol=1e-8)


def test_events_and_averaging_are_copied():
    clock = contin.Model(
        "clock",
        states={"x": 1.0, "y": 0.0},
        parameters={"eps": 0.01},
        equations={"x": "y", "y": "-x - eps*y"},
        events=[{"when": "x", "direction": "up", "set": {"y": "y + eps"}}],
        averaging={"small": "eps", "oscillators": [{"position": "x", "velocity": "y"}]},
    )
    slow = contin.average(array(clock, 3, {"y": "eps*0.3*(x_other - x)"}, shape="ring"))
    env = {"eps": 0.01, "r1": 0.5, "r2": 0.5, "r3": 0.5, "psi2": 0.0, "psi3": 0.0}
    assert evaluate_all(slow.equations, env)[:3] == pytest.approx([-0.25 + 1 / (2 * math.pi)] * 3)
    assert [s.name for s in slow.symmetries][:2] == ["rotate", "reflect"]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"count": 1, "join": {}}, "from 2 to 64"),
        ({"count": 3, "join": {"z": "x"}}, "not a state"),
        ({"count": 3, "join": {"y": "x_next"}}, "x_next"),
        ({"count": 3, "join": {"y": "x"}, "shape": "star"}, "all or ring or chain"),
        ({"count": 3, "join": {"y": "x"}, "parameters": {"x2": 1}}, "named like a parameter"),
    ],
)
def test_mistakes_are_said(options, words):
    with pytest.raises(InputError, match=words):
        array(cell(), **options)
