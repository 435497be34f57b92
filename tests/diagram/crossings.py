"""All equilibria that a diagram holds at one parameter value, each as often as a branch passes through it."""

from __future__ import annotations

import numpy as np

import contin
from contin.diagram.diagram import Diagram
from contin.diagram.identity import wrapped


def model(equations, states, parameters, **parts):
    return contin.Model("case", states=dict(states), parameters=dict(parameters), equations=dict(equations), **parts)


def explore(equations, states, parameters, range, symmetries=None, **options) -> Diagram:
    parts = {"symmetries": symmetries} if symmetries else {}
    return contin.diagram(model(equations, states, parameters, **parts), next(iter(parameters)), range, **options)


def solutions(diagram: Diagram, value: float) -> np.ndarray:
    """States at the crossings of parameter = value, solved to full precision; one row for each passage of a branch."""
    found = []
    size = max(np.abs(branch.z[:, :-1]).max() for branch in diagram) or 1.0  # of the states, in their units
    for branch in diagram:
        p = branch.z[:, -1] - value
        for k in np.flatnonzero(p[:-1] * p[1:] < 0):
            guess = branch.z[k] + (branch.z[k + 1] - branch.z[k]) * p[k] / (p[k] - p[k + 1])
            exact = branch.problem.at_parameter(guess, value, size * np.ones(len(guess)))
            assert exact is not None
            found.append(wrapped(exact, branch.problem.angle_periods)[:-1])
    return np.array(found)


def assert_same_points(found: np.ndarray, expected) -> None:
    """The same set of points, each once."""
    expected = np.asarray(expected, dtype=float)
    assert len(found) == len(expected), (
        f"{len(found)} passages instead of {len(expected)}: {np.round(found, 6).tolist()}"
    )
    for point in expected:
        distance = np.abs(found - point).max(axis=1)
        assert np.sum(distance < 1e-8) == 1, f"{point} is met {np.sum(distance < 1e-8)} times"
