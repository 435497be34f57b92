"""Defining systems as kernels evaluate them, beside the same equations in numpy, and their Jacobians by differences."""

import numpy as np
import pytest

from contin.lowering import compile_system
from contin.model.model import Model
from contin.problems.equilibria import defining
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.problems.equilibria.scaled import ScaledSystem

FORMULAS = {"x": "p*x - y + x^2*w", "y": "x + p*y*w - y^3", "w": "p*q - w*exp(-x) + x*y"}
KINDS = ("fold", "shifted", "branch", "pair")


class WithoutKernel(ScaledSystem):
    """The same equations, evaluated in Python."""

    def bordered(self, *given: object, **named: object) -> None:
        return None


def system_of(local: ScaledSystem, kind: str, y: np.ndarray, monkeypatch: pytest.MonkeyPatch) -> defining.System:
    """The defining system of a kind with borders from y."""
    made: list[defining.System] = []
    monkeypatch.setattr(defining, "newton", lambda system, *_: made.append(system))
    if kind == "fold":
        defining.fold(local, y)
    elif kind == "shifted":
        defining.eigenvalue_at(local, y, -2.0)
    elif kind == "branch":
        defining.branch_point(local, y)
    elif local.problem.is_map:
        defining.critical_pair(local, y, lambda w: np.exp(1j * w) - 1.0, lambda w: 1j * np.exp(1j * w), 0.7)
    else:
        defining.critical_pair(local, y, lambda w: 1j * w, lambda w: 1j, 0.7)
    return made[0]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("what", ["flow", "map"])
@pytest.mark.parametrize("rated", [False, True])
def test_the_kernel_has_the_equations_that_numpy_has_and_their_derivatives(kind, what, rated, monkeypatch):
    model = Model("m", kind=what, states={"x": 0, "y": 0, "w": 0}, parameters={"q": 2, "p": 1}, equations=FORMULAS)
    problem = EquilibriumProblem(compile_system(model), np.array([2.0, 1.0]), 1)
    random = np.random.default_rng(3)
    scale, rates = 0.5 + random.random(4), 1.0 + 9.0 * random.random(3) if rated else None
    y = random.random(4)
    systems = [system_of(one(problem, scale, rates), kind, y, monkeypatch) for one in (ScaledSystem, WithoutKernel)]
    x = (np.append(y, 1.1) if kind == "pair" else y) + 0.01
    rows = x + 0.1 * random.random((5, x.size))
    for ours, others in zip(
        [*systems[0].at(x), systems[0].values(rows), systems[0].terms(x)],
        [*systems[1].at(x), systems[1].values(rows), systems[1].terms(x)], strict=True,
    ):  # fmt: skip
        np.testing.assert_allclose(ours, others, rtol=1e-10, atol=1e-10 * np.abs(others).max())
    for system in systems:  # in one call, or in several: the same numbers
        values, matrices, terms = system.around(rows)
        assert np.array_equal(values[2:], system.values(rows[2:]))
        assert np.array_equal(terms, system.terms(rows[0]))
        for value, matrix, row in zip(values, matrices, rows, strict=False):
            assert np.array_equal(value, system.at(row)[0])
            assert np.array_equal(matrix, system.at(row)[1])
    step = 1e-5 * np.eye(x.size)
    slopes = (systems[0].values(x + step) - systems[0].values(x - step)).T / 2e-5
    matrix = systems[0].at(x)[1]
    np.testing.assert_allclose(matrix, slopes, atol=1e-7 * np.abs(matrix).max())


def test_where_the_bordered_matrix_is_singular_what_depends_on_it_is_nan():
    model = Model("m", states={"x": 0}, parameters={"p": 0}, equations={"x": "p + x^2"})
    local = ScaledSystem(EquilibriumProblem(compile_system(model), np.zeros(1), 0), np.ones(2))
    bordered = local.bordered(defining.FOLD, np.zeros((1, 1)), np.zeros((1, 1)))
    residual, matrix = bordered.at(np.array([1.0, 2.0]))
    assert residual[0] == 3.0
    assert np.isnan(residual[1])
    assert np.isnan(matrix[1]).all()
