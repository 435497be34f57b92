"""The group of the declared symmetries: its order, and what is said where it is too large."""

import numpy as np
import pytest

import contin
from contin import api
from contin.problems.symmetry_group import MOST, cut_off, group_note, group_words, moved


def ring(n, **symmetries):
    """n equal equations, each with a copy of the sum of all."""
    names = [f"x{k}" for k in range(n)]
    total = " + ".join(names)
    model = contin.Model(
        "ring", states=dict.fromkeys(names, 0.5), parameters={"p": 1.0},
        equations={x: f"p*{x} - {x}^3 - ({total})" for x in names}, symmetries=symmetries,
    )  # fmt: skip
    return api.equilibrium(model).system


def turn(n):
    return {f"x{k}": f"x{(k + 1) % n}" for k in range(n)}


SWAP = {"x0": "x1", "x1": "x0"}


@pytest.mark.parametrize(
    ("n", "symmetries", "order"),
    [
        (3, {"turn": turn(3)}, 3),
        (3, {"turn": turn(3), "swap": SWAP}, 6),
        (5, {"turn": turn(5), "swap": SWAP}, 120),
        (7, {"turn": turn(7)}, 7),
        (2, {"swap": SWAP, "flip": {"x0": "-x0", "x1": "-x1"}}, 4),
    ],
)
def test_the_group_has_its_order(n, symmetries, order):
    system = ring(n, **symmetries)
    words = group_words(system)
    assert len(words) == order - 1
    assert words[: len(symmetries)] == tuple(symmetries)
    u = np.random.default_rng(2).normal(size=(1, n))
    images = [u, *(moved(system, word, u, np.array([1.0])) for word in words)]
    assert len({tuple(np.round(image[0], 9)) for image in images}) == order
    assert not cut_off(system)
    assert group_note(system) == ()


def test_a_group_that_is_too_large_is_said_and_taken_by_pairs():
    system = ring(6, turn=turn(6), swap=SWAP)  # 720 permutations
    assert cut_off(system)
    assert set(group_words(system)) >= {"turn", "swap", "turn*swap", "swap*turn"}
    assert all(word.count("*") < 2 for word in group_words(system))
    assert str(MOST) in group_note(system)[0]


def test_without_declared_symmetries_there_are_none():
    assert group_words(ring(2)) == ()
