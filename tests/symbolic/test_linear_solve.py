"""Linear systems of formulas: against numbers, at random patterns."""

import random

import numpy as np
import pytest

from contin.model.evaluate import evaluate, evaluate_all
from contin.model.expression import ZERO, symbol
from contin.symbolic.calculus.linear_solve import BlockError, FormulaSolver, StructureError


def test_solutions_and_determinants_of_random_patterns_are_those_of_numbers():
    chance, singular = random.Random(1), 0
    for _ in range(150):
        n = chance.randint(1, 6)
        kept = [[chance.random() < 0.4 or (i == j and chance.random() < 0.5) for j in range(n)] for i in range(n)]
        values = {f"a{i}_{j}": chance.uniform(-1, 1) for i in range(n) for j in range(n)}
        values |= {f"b{i}": chance.uniform(-1, 1) for i in range(n)}
        matrix = [[symbol(f"a{i}_{j}") if kept[i][j] else ZERO for j in range(n)] for i in range(n)]
        numbers = np.array([[evaluate(a, values) for a in row] for row in matrix])
        try:
            solver = FormulaSolver.of(matrix)
        except StructureError as error:
            rows = list(error.rows)
            assert np.linalg.matrix_rank(numbers[rows]) < len(rows)
            singular += 1
            continue
        determinant = evaluate(solver.determinant, values)
        assert abs(determinant) == pytest.approx(abs(np.linalg.det(numbers)), abs=1e-12)
        if abs(determinant) > 1e-2:
            b = [symbol(f"b{i}") for i in range(n)]
            x = np.array(evaluate_all(solver.solve(b), values))
            np.testing.assert_allclose(numbers @ x, evaluate_all(b, values), atol=1e-11)
    assert singular > 20


def test_a_zero_where_elimination_would_have_its_pivot_is_no_pole():
    a, one = symbol("a"), symbol("one")
    solver = FormulaSolver.of([[a, one], [one, a]])
    x = solver.solve([symbol("b"), ZERO])
    assert evaluate_all(x, {"a": 0.0, "one": 1.0, "b": 3.0}) == [0.0, 3.0]


def test_blocks_that_are_too_large_are_refused():
    with pytest.raises(BlockError, match="9 unknowns depend on each other"):
        FormulaSolver.of([[symbol(f"a{i}_{j}") for j in range(9)] for i in range(9)])
