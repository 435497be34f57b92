"""Rows whose multipliers could not be computed are not called stable, and a note says so."""

from dataclasses import replace

import numpy as np

import contin
from contin.continuation.uncounted import uncounted, uncounted_note
from contin.problems.orbits.collocated_orbits import OrbitProblem


def test_rows_without_any_number_are_found_but_for_those_excused():
    values = np.array([[1.0, 2.0], [np.nan, np.nan], [np.nan, 3.0], [np.nan, np.nan]], complex)
    assert uncounted(values, [3]) == [1]
    assert uncounted(np.empty((3, 0), complex), []) == []
    assert uncounted_note([], {}, "p", 3) == []


def test_orbits_whose_multipliers_fail_are_not_called_stable(monkeypatch):
    normal = OrbitProblem.march

    def failing(self, *arguments):
        chunk = normal(self, *arguments)
        return replace(chunk, eigenvalues=np.full_like(chunk.eigenvalues, np.nan), unstable=0 * chunk.unstable)

    model = contin.load({
        "name": "hopf", "states": {"x": 1, "y": 0}, "parameters": {"mu": 1.0},
        "equations": {"x": "mu*x - y - x*(x^2 + y^2)", "y": "x + mu*y - y*(x^2 + y^2)"},
    })  # fmt: skip
    orbit = contin.periodic_orbit(model, {"x": 1.0, "y": 0.0})
    fine = contin.continuation(orbit, "mu", (1.0, 1.5), settings={"steps": 3})
    assert fine.columns["stable"].all()
    assert not fine.notes
    monkeypatch.setattr(OrbitProblem, "march", failing)
    failed = contin.continuation(orbit, "mu", (1.0, 1.5), settings={"steps": 3})
    unknown = np.isnan(failed.eigenvalues).all(axis=1)
    assert unknown.any()
    assert not failed.columns["stable"][unknown].any()
    assert [note for note in failed.notes if "could not be computed in" in note and "not called stable" in note]
    assert failed.unexplained == 1
