"""The brute force beside the map of stable states: its equations are contin's, and its names follow from amplitudes."""

import importlib
import sys

import numpy as np
import pytest

from tests.docs.test_pages import DOCS, shell

sys.path.insert(0, str(DOCS / "metronomes"))
page = importlib.import_module("all_states")
claiming = importlib.import_module("claiming")


def test_the_equations_of_the_brute_force_are_those_that_contin_derives():
    r, psi, mu, beta = np.array([1.7, 0.6]), 0.9, 2.3, 0.4
    z = r * np.exp(1j * np.array([0.0, psi]))
    growth = page.rates(z, mu, beta) / z
    expected = [*(growth.real * r), growth[1].imag - growth[0].imag]
    found = claiming.rates(claiming.averaged("pair"), (*r, psi), mu=mu, beta=beta)
    assert np.allclose(found, expected, rtol=1e-12)


@pytest.mark.parametrize(
    ("low", "high", "psi", "name"),
    [
        ((0, 0), (0.001, 0.002), 1.0, "rest"),
        ((2, 2), (2, 2), 0.0, "in-phase"),
        ((2, 2), (2, 2), 3.1, "anti-phase"),
        ((2.2, 2), (2.2, 2), 0.1, "unequal"),
        ((2.0, 0.4), (2.0, 0.4), 0.1, "one alone"),
        ((1.8, 1.8), (2.2, 2.2), 0.1, "large beats"),
        ((2.1, 1.8), (2.2, 2.0), 0.1, "small beats"),
        ((0.1, 0.1), (2.2, 2.2), 0.1, "turning beats"),
    ],
)
def test_states_are_named_by_their_amplitudes(low, high, psi, name):
    assert page.named(np.array(low, dtype=float), np.array(high, dtype=float), psi) == name


def test_every_point_of_the_brute_force_is_stored():
    stored = [tuple(point["states"]) for point in page.stored()]
    assert len(stored) == 200
    assert sum("turning beats" in states for states in stored) > 20


@pytest.mark.long
def test_no_start_settles_on_a_state_that_the_curves_do_not_have(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shell("contin run metronomes/pair-states")
    wrong, missed = page.compared()
    assert not wrong
    assert len(missed) <= 1
