"""Functions written for packages of automatic differentiation have exact derivatives."""

from __future__ import annotations

import sys

import numpy as np
import pytest

import contin

KNOWN = {"A": 1.0, "B": 1.0}


def made(package):
    """The Brusselator, with |.| of an exponential in it so that complex steps are of no use."""
    if package == "jax":
        jax = pytest.importorskip("jax")
        jax.config.update("jax_enable_x64", True)
        numbers, build = jax.numpy, contin.from_jax
    elif package == "casadi":
        casadi = pytest.importorskip("casadi")

        def symbolic(u, p):
            return [
                p["A"] - (p["B"] + 1) * u[0] + u[0] ** 2 * u[1], p["B"] * u[0] - casadi.fabs(u[0]) * u[0] * u[1]
            ]  # fmt: skip

        return contin.from_casadi(symbolic, [1.0, 1.0], KNOWN, states=["x", "y"])
    else:
        numbers, build = pytest.importorskip("autograd.numpy"), contin.from_autograd

    def residual(u, p):
        x, y = u[0], u[1]
        return numbers.array([p["A"] - (p["B"] + 1) * x + x**2 * y, p["B"] * x - numbers.abs(x) * x * y])

    return build(residual, [1.0, 1.0], KNOWN, states=["x", "y"])


@pytest.mark.parametrize("package", ["autograd", "jax", "casadi"])
def test_derivatives_of_order_two_and_three_are_those_of_the_formulas(package):
    system, exact = made(package).system(), contin.load("classics/brusselator")
    formulas = pytest.importorskip("contin.lowering").compile_system(exact)
    generator = np.random.default_rng(0)
    u, p = np.array([0.7, 1.9]), np.array([1.1, 2.3])
    order = [exact.parameter_names.index(name) for name in ("A", "B")]
    place = [0, 1, *(2 + k for k in order)]
    np.testing.assert_allclose(system.jacobian(u, p)[1], formulas.jacobian(u, p[order])[1][:, place], rtol=1e-14)
    for k in (2, 3):
        directions = [generator.normal(size=4) for _ in range(k)]
        moved = [d[place] for d in directions]
        np.testing.assert_allclose(
            system.derivative(u, p, *directions), formulas.derivative(u, p[order], *moved), rtol=1e-12, atol=1e-14
        )


@pytest.mark.parametrize("package", ["autograd", "jax", "casadi"])
def test_the_first_lyapunov_coefficient_is_exact(package):
    hopf = contin.continuation(made(package), "B", (0.5, 3.0))["HB1"]
    assert abs(hopf.values["B"] - 2.0) < 1e-12
    expected = contin.continuation(
        contin.equilibrium(contin.load("classics/brusselator"), {"x": 1, "y": 1}, KNOWN), "B", (0.5, 3.0)
    )["HB1"].normal_form["l1"]
    assert abs(hopf.normal_form["l1"] - expected) < 1e-10 * abs(expected)


@pytest.mark.parametrize("package", ["autograd", "jax", "casadi"])
def test_a_missing_package_is_named(package, monkeypatch):
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(contin.InputError, match=f"from_{package} needs the package {package}: pip install"):
        getattr(contin, f"from_{package}")(lambda u, p: u, [1.0], {"p": 1.0})


def test_a_chain_written_for_casadi_has_a_sparse_jacobian():
    casadi = pytest.importorskip("casadi")
    n = 100

    def bratu(u, p):
        wide = casadi.vertcat(0, u, 0)
        return (wide[2:] - 2 * u + wide[:-2]) * (n + 1) ** 2 + p["lam"] * casadi.exp(u)

    model = contin.from_casadi(bratu, np.zeros(n), {"lam": 0.0})
    assert model.method == "sparse"
    fold = contin.continuation(model, "lam", (0, 4), settings={"steps": 40})["LP1"]
    assert abs(fold.values["lam"] - 3.513830719) < 2.0 / n**2
