"""The stored scan of the phase diagram against the formulas of the paper, and the tables that the pages show."""

import importlib
import sys

import numpy as np
import pytest

from tests.docs.test_pages import DOCS

sys.path.insert(0, str(DOCS / "metronomes"))


def test_the_stored_scan_differs_from_the_formulas_only_at_their_borders():
    """Every point that differs has a neighbour on the grid where the formula says what was simulated."""
    figure = importlib.import_module("figure_4")
    found = figure.brute_force()
    formula = figure.predicted(found["mu"], found["beta"])
    for name in ("anti-phase", "in-phase"):
        wrong = found[name] != formula[name]
        padded = np.pad(formula[name], 1, mode="edge")
        neighbours = [padded[1 + a : 61 + a, 1 + b : 61 + b] == found[name] for a in (-1, 0, 1) for b in (-1, 0, 1)]
        assert np.all(np.any(neighbours, axis=0)[wrong])
    assert figure.disagreements() == {"anti-phase": 60, "in-phase": 25, "in-phase stable": 120}


def test_in_phase_synchrony_is_stable_earlier_in_the_equations_of_motion_than_on_average():
    """The shift is of order eps: at most 1 in mu, and almost never the other way."""
    figure = importlib.import_module("figure_4")
    found = figure.brute_force()
    formula = figure.predicted(found["mu"], found["beta"])["in-phase stable"]
    stable = found["in-phase stable"]
    assert (stable & ~formula).sum() > 20 * (formula & ~stable).sum()
    inner = found["beta"][:, 0] < 0.85
    for row, expected in zip(stable[inner], formula[inner], strict=True):
        assert 0 <= int(np.argmax(expected)) - int(np.argmax(row)) <= 4  # a step is 0.25


@pytest.mark.parametrize(("numbers", "text"), [([True, True], "yes (2)"), ([1.0, 2.5], "1, 2.5"), ("rest", "rest")])
def test_numbers_of_the_ledger_are_shown_in_words_or_digits(numbers, text):
    assert importlib.import_module("ledger").shown(numbers) == text
