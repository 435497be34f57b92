"""The bundled models say true things: their equations, starts and expected points, checked in many digits."""

import mpmath
import numpy as np
import pytest

import contin
from contin.model import registry
from contin.model.dual import directional
from contin.model.evaluate import evaluate, evaluate_all
from contin.model.model import Model
from contin.model.yaml_loader import load_model_text

NAMES = [line.name for line in registry.listing() if line.source == "contin"]


def environment(model: Model, start=None, **parameters) -> dict[str, float]:
    u, p = model.start_point(start, parameters)
    return dict(zip((*model.state_names, *model.parameter_names), (*u.tolist(), *p.tolist()), strict=True))


def jacobian(model: Model, env: dict[str, float]) -> np.ndarray:
    return np.array([directional(model.equations, env, {s: 1.0}) for s in model.state_names]).T


@pytest.mark.parametrize("name", NAMES)
def test_every_bundled_model_is_complete_and_reloads_from_its_text(name):
    model = contin.load(name)
    assert model.title
    assert model.source
    assert model.expect
    if isinstance(model, Model):  # not a Python function
        assert load_model_text(model.text()) == model


def test_brusselator_has_its_hopf_point_where_the_trace_vanishes():
    model = contin.load("brusselator")
    for a in (0.5, 1.0, 1.7):
        at = model.expect[0].at[0]
        b = evaluate(at["B"], {"A": a})
        env = environment(model, "rest", A=a, B=b)
        np.testing.assert_allclose(evaluate_all(model.equations, env), 0, atol=1e-14)
        matrix = jacobian(model, env)
        assert np.trace(matrix) == pytest.approx(0, abs=1e-13)
        assert np.linalg.det(matrix) == pytest.approx(a**2)


def test_lorenz_loses_rest_at_1_and_convection_in_a_hopf_point():
    model = contin.load("lorenz")
    env = environment(model, "rest", rho=1)
    assert np.linalg.det(jacobian(model, env)) == pytest.approx(0, abs=1e-12)
    rho = evaluate(model.expect[1].at[0]["rho"], model.default_parameters())
    assert rho == pytest.approx(470 / 19, rel=1e-15)  # s = 10, b = 8/3
    env = environment(model, "convection", rho=rho)
    np.testing.assert_allclose(evaluate_all(model.equations, env), 0, atol=1e-12)
    eigenvalues = np.linalg.eigvals(jacobian(model, env))
    assert sorted(eigenvalues.real)[1:] == pytest.approx([0, 0], abs=1e-12)
    assert abs(eigenvalues.imag).max() > 1


def co_equilibrium(x):
    """The equilibrium with this x, and its q2: s = z/k, y = 1 - x - z(1 + 1/k), z from a quadratic, q2 from y' = 0."""
    q1, q3, q5, q6, k = 2.5, 10, 1, mpmath.mpf("0.1"), mpmath.mpf("0.4")
    c = 1 + 1 / k
    z = (-q3 * x * c + mpmath.sqrt((q3 * x * c) ** 2 + 8 * q1 * (2 * q5 * x**2 + q3 * x * (1 - x)))) / (4 * q1)
    y = 1 - x - z * c
    return {"x": x, "y": y, "s": z / k, "q2": (q6 + q3 * x) * y / z}


def co_hurwitz(x):
    """-det J and a1 a2 - a3 of the characteristic polynomial along the closed form."""
    model = contin.load("co-oxidation")
    point = {"q1": 2.5, "q3": 10, "q4": mpmath.mpf("0.0675"), "q5": 1, "q6": mpmath.mpf("0.1"), "k": mpmath.mpf("0.4")}
    point |= co_equilibrium(x)
    values = evaluate_all(model.equations, point, mpmath)
    assert max(abs(v) for v in values) < mpmath.mpf("1e-30")

    def entry(i, name):
        return mpmath.diff(lambda s: evaluate(model.equations[i], {**point, name: s}, mpmath), point[name])

    a = [[entry(i, name) for name in "xys"] for i in range(3)]
    a1 = -(a[0][0] + a[1][1] + a[2][2])
    a2 = sum(a[i][i] * a[j][j] - a[i][j] * a[j][i] for i, j in ((0, 1), (0, 2), (1, 2)))
    a3 = -mpmath.det(mpmath.matrix(a))
    return a3, a1 * a2 - a3, a2


@pytest.mark.seldom
def test_co_oxidation_has_its_folds_and_hopf_points_where_the_determinants_vanish():
    model = contin.load("co-oxidation")
    assert {item.label for item in model.expect} == {"LP", "HB"}
    with mpmath.workdps(40):
        # brackets in x hold one zero of each determinant
        brackets = {"LP": [(0.02, 0.03), (0.05, 0.06)], "HB": [(0.015, 0.018), (0.07, 0.08)]}
        for item in model.expect:
            which = 0 if item.label == "LP" else 1
            roots = [
                mpmath.findroot(lambda x: co_hurwitz(x)[which], b, solver="anderson", tol=1e-50)  # noqa: B023
                for b in brackets[item.label]
            ]
            found = [float(co_equilibrium(x)["q2"]) for x in roots]
            expected = [evaluate(point["q2"], {}) for point in item.at]
            assert found == pytest.approx(expected, rel=1e-15)
            if item.label == "HB":
                assert all(co_hurwitz(x)[2] > 0 for x in roots)  # a pair +-i sqrt(a2), not a neutral saddle


@pytest.mark.parametrize("start", ["oscillating", "threshold", "rest"])
def test_one_metronome_rests_or_swings_as_the_closed_form_says(start):
    model = contin.load("metronomes/one-averaged")
    env = environment(model, start, alpha=0.7, a=3.1, b=0.8)
    assert evaluate(model.equations[0], env) == pytest.approx(0, abs=1e-14)
    slope = jacobian(model, env)[0, 0]
    assert (slope > 0) == (start == "threshold")


def test_one_metronome_is_the_average_over_a_period():
    """r' is the mean of -sin(phi) (alpha r sin(phi) + g(r cos(phi), -r sin(phi))), theta' that of -cos(phi) (...)/r."""
    model = contin.load("metronomes/one-averaged")
    alpha, a, b = 0.37, 3.3, 0.9
    for r in (0.4, 1.7, 2.6):

        def force(phi, r=r):
            x, y = r * mpmath.cos(phi), -r * mpmath.sin(phi)
            return alpha * r * mpmath.sin(phi) + (a * x**3 - b * x**5 if x * y > 0 else 0)

        quarters = [0, mpmath.pi / 2, mpmath.pi, 3 * mpmath.pi / 2, 2 * mpmath.pi]
        mean = mpmath.quad(lambda p: -mpmath.sin(p) * force(p), quarters) / (2 * mpmath.pi)
        turn = mpmath.quad(lambda p: -mpmath.cos(p) * force(p) / r, quarters) / (2 * mpmath.pi)  # noqa: B023
        env = {"r": r, "alpha": alpha, "a": a, "b": b}
        assert evaluate(model.equations[0], env) == pytest.approx(float(mean), rel=1e-12)
        assert evaluate(model.observables["frequency_shift"], env) == pytest.approx(float(turn), rel=1e-12)


def test_one_metronome_folds_where_the_amplitudes_meet():
    model = contin.load("metronomes/one-averaged")
    values = model.default_parameters({"a": 3.1, "b": 0.8})
    at = {n: evaluate(e, values) for n, e in model.expect[0].at[0].items()}
    env = values | at
    assert evaluate(model.equations[0], env) == pytest.approx(0, abs=1e-14)
    assert jacobian(model, env)[0, 0] == pytest.approx(0, abs=1e-13)


@pytest.mark.parametrize("start", ["in-phase", "anti-phase"])
def test_synchronous_states_of_the_pair_are_equilibria(start):
    model = contin.load("metronomes/pair-averaged")
    env = environment(model, start, mu=3.0, beta=0.6, a=3.7, b=0.9)
    np.testing.assert_allclose(evaluate_all(model.equations, env), 0, atol=1e-14)
    assert env["psi"] == pytest.approx(0 if start == "in-phase" else np.pi)


@pytest.mark.parametrize("parameters", [{}, {"beta": 0.3}, {"beta": 0.5, "a": 3.5, "b": 0.8}])
def test_the_pair_loses_in_phase_where_the_antisymmetric_block_is_singular(parameters):
    model = contin.load("metronomes/pair-averaged")
    values = model.default_parameters(parameters)
    mu = evaluate(model.expect[0].at[0]["mu"], values)
    if not parameters:
        assert mu == pytest.approx(4.75646174352128, rel=1e-14)
    env = environment(model, "in-phase", **{**parameters, "mu": mu})
    basis = np.array([[1, -1, 0], [0, 0, 1], [1, 1, 0]]).T / np.sqrt([2, 1, 2])
    blocks = basis.T @ jacobian(model, env) @ basis
    assert np.linalg.det(blocks[:2, :2]) == pytest.approx(0, abs=1e-12)
    assert abs(blocks[2, 2]) > 0.1
    for shift, unstable in ((-0.2, 1), (0.2, 0)):
        env = environment(model, "in-phase", **{**parameters, "mu": mu + shift})
        assert sum(np.linalg.eigvals(jacobian(model, env)).real > 0) == unstable


def test_the_pair_folds_where_the_two_amplitudes_meet():
    model = contin.load("metronomes/pair-averaged")
    values = model.default_parameters()
    at = {n: evaluate(e, values) for n, e in model.expect[2].at[0].items()}
    env = {**values, **at, "r2": at["r1"], "psi": np.pi}
    np.testing.assert_allclose(evaluate_all(model.equations, env), 0, atol=1e-13)
    assert np.linalg.det(jacobian(model, env)) == pytest.approx(0, abs=1e-11)
