"""Eigenfunctions of multipliers: v' = f_u v, v(T) = rho v(0), on meshes and by shooting, against closed forms."""

import numpy as np
import pytest

import contin
from contin.errors import InputError

MU, W, DECAY = 0.5, 2.0, 0.7


@pytest.fixture(scope="module")
def birth():
    """A circle of radius sqrt(mu) with multipliers 1, exp(-2 mu T), exp(-DECAY T); z is a linear filter of x^2."""
    model = contin.Model(
        "filtered", states={"x": 0, "y": 0, "z": 0}, parameters={"mu": -1.0},
        equations={"x": f"mu*x - {W}*y - x*(x^2 + y^2)", "y": f"{W}*x + mu*y - y*(x^2 + y^2)", "z": f"x^2 - {DECAY}*z"},
    )  # fmt: skip
    return contin.continuation(contin.equilibrium(model), "mu", (-1, 1))["HB1"]


@pytest.fixture(scope="module", params=["collocation", "shooting"])
def branch(request, birth):
    return contin.continuation(
        birth.switch(), "mu", (-1, 1), values={"mu": [MU]}, settings={"method": request.param}
    )


def test_eigenfunctions_are_those_of_the_circle(branch):
    orbit = branch["UZ1"].orbit
    rho, v = orbit.multipliers, orbit.eigenfunctions
    assert v.shape == (3, len(orbit.t), 3)
    np.testing.assert_allclose(np.linalg.norm(v[:, 0], axis=1), 1.0, rtol=1e-12)
    for k in range(3):
        np.testing.assert_allclose(v[k, -1], rho[k] * v[k, 0], atol=1e-9)
    x, y, z = (orbit.columns[name] for name in "xyz")
    flow = np.array([-W * y, W * x, x**2 - DECAY * z]).T  # the derivative of the orbit belongs to the multiplier 1
    trivial = v[int(np.argmin(np.abs(rho - 1.0)))].real
    np.testing.assert_allclose(trivial, flow * (trivial[0] @ flow[0]) / (flow[0] @ flow[0]), atol=1e-6)
    filtered = v[int(np.argmin(np.abs(rho - np.exp(-DECAY * orbit.period))))].real
    np.testing.assert_allclose(filtered, np.exp(-DECAY * orbit.t)[:, None] * [0.0, 0.0, 1.0], atol=1e-8)


def test_orbits_of_rows_and_of_files_have_them_and_tables_are_samples(branch, tmp_path):
    from_row = branch.orbit(branch["UZ1"].index)
    np.testing.assert_allclose(np.abs(from_row.eigenfunctions), np.abs(branch["UZ1"].orbit.eigenfunctions), atol=1e-7)
    from_row.to_csv(tmp_path / "orbit.csv")
    table = np.genfromtxt(tmp_path / "orbit.csv", delimiter=",", names=True)
    for name, column in from_row.columns.items():
        np.testing.assert_array_equal(table[name], column)


def test_an_equilibrium_has_no_orbit(birth):
    with pytest.raises(InputError, match="no periodic orbit"):
        _ = birth.orbit
