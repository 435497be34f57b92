"""Functions of another module's arrays, which refuse numpy; preconditioners of sparse systems."""

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import splu

import contin
from contin import api
from contin.errors import InputError

M = 12


class Refusing:
    """An array of a module that shares nothing with numpy, as cupy's on a device."""

    def __init__(self, values):
        self._values = values

    def __array__(self, *args, **kwargs):
        raise TypeError("implicit conversion to a numpy array is not allowed")

    __array_ufunc__ = None

    def __add__(self, other):
        return Refusing(self._values + (other._values if isinstance(other, Refusing) else other))

    def __mul__(self, other):
        return Refusing(self._values * (other._values if isinstance(other, Refusing) else other))

    __rmul__ = __mul__

    def exp(self):
        return Refusing(np.exp(self._values))

    def through(self, matrix):
        return Refusing(matrix(self._values))

    def max(self):
        return self._values.max()


def laplace(m):
    one = sp.diags([1.0, -2.0, 1.0], [-1, 0, 1], shape=(m, m)) * (m + 1.0) * (m + 1.0)
    return (sp.kron(one, sp.identity(m)) + sp.kron(sp.identity(m), one)).tocsc()


MATRIX = laplace(M)
FACTORS = splu(MATRIX)


def plane_bratu(**given):
    return contin.FunctionProblem(
        lambda u, p: MATRIX @ u + p["p"] * np.exp(u), np.zeros(M * M), {"p": 0.0},
        lambda u, p: (MATRIX + sp.diags(p["p"] * np.exp(u))).tocsc(), record=lambda u, p: {"top": u.max()}, **given,
    )  # fmt: skip


def fold(problem):
    line = api.continuation(problem, "p", (0.0, 10.0), direction="up", settings={"stop_at": ["LP"]})
    return line, line["LP1"]


@pytest.fixture(scope="module")
def direct():
    return fold(plane_bratu())


def test_arrays_that_refuse_numpy_pass_through_the_matrix_free_path(direct):
    problem = contin.FunctionProblem(
        lambda u, p: u.through(lambda v: MATRIX @ v) + p["p"] * u.exp(), np.zeros(M * M), {"p": 0.0},
        lambda u, p: lambda v: v.through(lambda w: MATRIX @ w) + p["p"] * (u.exp() * v),
        record=lambda u, p: {"top": u.max()},
        preconditioner=lambda u, p: lambda r: r.through(FACTORS.solve),
        arrays=(lambda v: Refusing(np.array(v)), lambda a: a._values),
    )  # fmt: skip
    assert problem.method == "matrix-free"
    line, point = fold(problem)
    _, exact = direct
    assert abs(point.values["p"] - exact.values["p"]) <= point.error + exact.error
    assert point.values["top"] == pytest.approx(exact.values["top"], rel=1e-6)
    assert line.effort["applications"] > 0


def test_a_missing_way_back_to_numpy_is_told():
    with pytest.raises(InputError, match=r"arrays must be a pair of functions, from numpy and back to it, such as"):
        plane_bratu(arrays=(np.asarray,))


def test_a_preconditioner_of_a_dense_jacobian_is_refused():
    dense = contin.FunctionProblem(
        lambda u, p: p["p"] - u, [1.0], {"p": 1.0}, lambda u, p: -np.eye(1), preconditioner=lambda u, p: lambda r: r
    )
    with pytest.raises(InputError, match=r"jacobian returns an array, which is factored; a preconditioner needs a"):
        api.equilibrium(dense)


def test_a_preconditioner_takes_the_place_of_factors_and_is_made_anew_where_it_has_become_worse(direct):
    made = []

    def preconditioner(u, p):
        made.append(p["p"])
        return splu((MATRIX + sp.diags(p["p"] * np.exp(u))).tocsc()).solve

    line, point = fold(plane_bratu(preconditioner=preconditioner))
    whole, exact = direct
    assert abs(point.values["p"] - exact.values["p"]) <= point.error + exact.error
    assert point.normal_form["a"] == pytest.approx(exact.normal_form["a"], rel=1e-5)
    assert np.all(line.columns["unstable"][: point.index] == 0)
    assert line.effort["factorisations"] <= len(made) < len(line) < whole.effort["factorisations"]


def test_algebraic_multigrid_as_a_preconditioner(direct):
    pyamg = pytest.importorskip("pyamg")

    def preconditioner(u, p):
        matrix = sp.csr_matrix(MATRIX + sp.diags(p["p"] * np.exp(u)))
        cycle = pyamg.ruge_stuben_solver(-matrix, max_coarse=20).aspreconditioner()
        return lambda r: -cycle.matvec(r)

    _, point = fold(plane_bratu(preconditioner=preconditioner))
    _, exact = direct
    assert abs(point.values["p"] - exact.values["p"]) <= point.error + exact.error
