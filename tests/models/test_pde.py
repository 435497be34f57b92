"""Partial differential equations in the registry: Python functions answer to names as model files do."""

import numpy as np
import pytest

import contin
from tests.cli.calls import call, results, run_file


def test_bratu_agrees_with_the_closed_form():
    """u = 2 log(cosh s / cosh(s (1 - 2 x))) solves u'' + p exp(u) = 0 with p = 8 (s / cosh s)^2."""
    model = contin.load("pde/bratu")
    s, middle = 0.9, model.n // 2
    p = 8 * (s / np.cosh(s)) ** 2
    found = contin.equilibrium(model, parameters={"p": p})
    assert found.u[middle] == pytest.approx(2 * np.log(np.cosh(s)), rel=1e-12)


def test_the_jacobian_of_the_brusselator_is_the_derivative_of_its_residual():
    model = contin.load("brusselator-1d")
    generator = np.random.default_rng(3)
    z, v = generator.uniform(1, 3, model.n), generator.uniform(-1, 1, model.n)
    slope = model.residual(z + 1e-30j * v, model.values).imag / 1e-30
    np.testing.assert_allclose(model.jacobian(z, model.values) @ v, slope, rtol=1e-13, atol=1e-10)


def test_a_run_file_names_a_partial_differential_equation(tmp_path):
    run = {"parameter": "p", "range": [0, 4], "settings": {"steps": 60}, "values": {"middle": [0.5]}}
    path = run_file(tmp_path, "pde/bratu", run)
    call("run", path, "--json", tmp_path / "out.json", "--quiet")
    [branch] = results(tmp_path / "out.json")["branches"]
    assert [p["type"] for p in branch["points"]] == ["UZ", "LP"]
    assert branch["points"][0]["values"]["middle"] == pytest.approx(0.5, abs=1e-9)


def test_passes_need_formulas(tmp_path, capsys):
    path = run_file(tmp_path, "pde/bratu", {"parameter": "p"}, transform=[{"average": {"form": "polar"}}])
    assert call("run", path) == 2
    assert "bratu is a Python function; passes need a model made of formulas" in capsys.readouterr().err
