"""Pairs that become unstable far from zero: of Jacobians that are only applied no bound of entries tells where, and of
large matrices it lies beyond what is computed from zero."""

import numpy as np
import pytest
from scipy import sparse
from scipy.sparse.linalg import LinearOperator

import contin


def pair_among_decays(n: int, frequency: float) -> contin.FunctionProblem:
    """Eigenvalues p +- i frequency, and n - 2 decays from -0.5 to -40: a Hopf point at p = 0, whatever is nearer."""
    decays = -np.linspace(0.5, 40.0, n - 2)

    def residual(u, p):
        x, y = u[:2]
        growth = p["p"] - x * x - y * y
        return np.concatenate([[growth * x - frequency * y, growth * y + frequency * x], decays * u[2:]])

    def jacobian(u, p):
        x, y = u[:2]
        growth = p["p"] - x * x - y * y

        def product(v):
            v = np.ravel(v)
            top = [(growth - 2 * x * x) * v[0] - (2 * x * y + frequency) * v[1],
                   (frequency - 2 * x * y) * v[0] + (growth - 2 * y * y) * v[1]]  # fmt: skip
            return np.concatenate([top, decays * v[2:]])

        return LinearOperator((n, n), matvec=product, dtype=float)

    def preconditioner(u, p):
        turn = np.linalg.inv(np.array([[p["p"], -frequency], [frequency, p["p"]]]))
        return lambda r: np.concatenate([turn @ r[:2], r[2:] / decays])

    return contin.FunctionProblem(residual, np.zeros(n), {"p": -0.5}, jacobian, preconditioner=preconditioner)


@pytest.mark.parametrize(("n", "frequency"), [(50, 30.0), (120, 1.0), (120, 300.0), (700, 1.0), (700, 30.0)])
def test_a_pair_is_seen_wherever_it_crosses(n, frequency):
    line = contin.continuation(pair_among_decays(n, frequency), "p", (-0.6, 0.7), settings={"max_step": 0.4})
    (point,) = line.points
    assert point.type == "HB"
    assert abs(point.values["p"]) <= point.error < 1e-9
    np.testing.assert_array_equal(line.columns["unstable"], np.where(line.columns["p"] > 1e-12, 2, 0))
    assert any("a Jacobian that is only applied" in note for note in line.notes) == (n > 500)


@pytest.mark.seldom
def test_a_pair_beyond_what_is_computed_from_zero_is_seen():
    n, frequency = 700, 30.0
    applied = pair_among_decays(n, frequency)

    def jacobian(u, p):
        columns = applied.jacobian(u, p) @ np.eye(n)[:, :2]
        rest = sparse.diags(np.linspace(-0.5, -40.0, n - 2))
        return sparse.block_diag([columns[:2], rest], format="csc")

    line = contin.continuation(
        contin.FunctionProblem(applied.residual, np.zeros(n), {"p": -0.5}, jacobian), "p", (-0.6, 0.7),
        settings={"max_step": 0.4},
    )
    (point,) = line.points
    assert point.type == "HB"
    assert abs(point.values["p"]) <= point.error < 1e-9
    assert any("of others that lie apart on the right" in note for note in line.notes)
