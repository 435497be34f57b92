"""Suppression: the closed forms of the page against equilibria and eigenvalues that contin computes."""

import importlib
import sys

import numpy as np
import pytest

import contin
from tests.docs.test_pages import DOCS

sys.path.insert(0, str(DOCS / "metronomes"))
page = importlib.import_module("suppression")


@pytest.fixture(scope="module")
def lone():
    return contin.average(contin.load("metronomes/lone"), form="cartesian")


def spectrum(state, mu):
    """Eigenvalues at a state."""
    branch = contin.continuation(state, "mu", (0.99 * mu, 1.01 * mu))
    return branch.eigenvalues[branch.start_row]


@pytest.mark.parametrize("count", [5, 8])
def test_the_fold_of_the_lone_metronome_tends_to_the_closed_form(lone, count):
    """The platform's share of the motion falls as 1/mu, so that the difference does, too."""
    gaps = []
    for mu in (200.0, 800.0):
        state = contin.equilibrium(lone, start="lone", parameters={"N": count, "mu": 0.05, "beta": 0.7})
        far = contin.continuation(state, "mu", (0.05, mu), values={"mu": [0.999 * mu]})["UZ1"]
        states = {name: far.values[name] for name in ("u1", "v1", "u2", "v2", "u3", "v3")}
        state = contin.equilibrium(lone, start=states, parameters={"N": count, "mu": 0.999 * mu, "beta": 0.7})
        fold = contin.continuation(state, "beta", (0.65, 1.0))["LP1"]
        gaps.append(fold.values["beta"] - page.endless_border(count))
    assert abs(gaps[0]) < 5e-3
    assert gaps[0] / gaps[1] == pytest.approx(4.0, rel=0.1)


def test_every_number_of_metronomes_has_the_averaged_equations_of_its_share():
    """k of N at mu is k/N of one at N mu: states, and eigenvalues but for those of clusters of one."""
    some = contin.average(contin.load("metronomes/some"), form="cartesian")
    two = contin.equilibrium(some, start="some", parameters={"N": 6, "k": 2, "mu": 0.05})
    share = contin.equilibrium(some, start="some", parameters={"N": 1, "k": 1 / 3, "mu": 0.3})
    assert np.allclose(two.u, share.u, atol=1e-12)
    found = spectrum(two, 0.05)
    assert np.allclose(np.sort(found.real), np.sort(spectrum(share, 0.3).real), atol=1e-11)
    assert max(found.real) > 0  # two that swing in phase repel each other


@pytest.mark.parametrize("mu", [0.3, 3.0])
def test_the_polynomial_of_a_pair_and_one_at_rest_has_the_eigenvalues_of_three_metronomes(mu):
    three = contin.average(contin.load("metronomes/three"), form="cartesian")
    big = page.r_star(0.3)
    start = {"u1": big, "v1": 0.0, "u2": -big, "v2": 0.0, "u3": 0.0, "v3": 0.0}
    state = contin.equilibrium(three, start=start, parameters={"mu": mu, "beta": 0.3})
    found = spectrum(state, mu)
    for root in np.roots(page.pair_and_rest(0.3, mu, 1)):
        assert min(abs(found - root)) < 1e-9
    assert (page.growth(0.3, mu, 1) > 0) == (mu > page.steady_border(0.3, 1))
