"""The march: the same steps in machine code and in Python, its orders of accuracy, its effort."""

from dataclasses import dataclass

import numpy as np
import pytest

import contin
from contin.continuation import corrector
from contin.continuation import march as python_march
from contin.continuation.sample import Frame, Sample, Stop
from contin.continuation.settings import Settings
from contin.problems.dense_march import DenseLinearisation, DenseMarch
from tests.problems.cases import oscillator, zeros
from tests.problems.follow import follow, model

EMPTY = np.empty(0, complex)


def problem_of(equations, states, parameters):
    start = contin.equilibrium(model(equations, states, parameters))
    problem = start.problem(next(iter(parameters)))
    return problem, np.append(start.u, start.p[problem.active])


def origin_of(problem, z, scale, sense=1.0):
    tangent = problem.tangents(z, scale)[0]
    return Sample(z, sense * tangent * np.sign(tangent[-1]), np.full(4, np.nan), 0, EMPTY)


SYSTEMS = {
    "circle": ({"x": "1 - x^2 - p^2"}, {"x": 1.0}, {"p": 0.0}, (-2.0, 2.0)),
    "tank": (
        {"x": "-x + p*(1 - x)*exp(y)", "y": "-y + 14*p*(1 - x)*exp(y) - 2*y"}, zeros("x y"), {"p": 0.01}, (0.0, 0.5),
    ),
    "oscillator": (oscillator("x", "y", "p"), zeros("x y"), {"p": -1.0}, (-1.0, 1.0)),
    "pitchfork": ({"x": "p*x - x^3", "y": "x - y"}, zeros("x y"), {"p": -1.0}, (-2.0, 2.0)),
    "three states": (
        {"x": "p - x^2 + y", "y": "x*z - y", "z": "p*x - 2*z - z^3"}, {"x": 1.0, "y": 0.3, "z": 0.3}, {"p": 0.7},
        (-1.0, 1.5),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", SYSTEMS)
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_machine_code_and_python_accept_the_same_points(name, sense):
    equations, states, parameters, bounds = SYSTEMS[name]
    problem, z = problem_of(equations, states, parameters)
    scale = problem.initial_scale(z, bounds)
    origin, frame, settings = origin_of(problem, z, scale, sense), Frame(scale), Settings()
    arguments = (origin, None, 0.0, frame, settings.first_step, 200, bounds, settings, None)
    compiled = problem.march(*arguments)
    plain = python_march.march(DenseMarch(problem), *arguments)
    assert (compiled.stop, len(compiled)) == (plain.stop, len(plain))
    assert len(plain) >= 2
    np.testing.assert_allclose(compiled.z, plain.z, rtol=1e-8, atol=1e-9)
    np.testing.assert_allclose(compiled.lengths, plain.lengths, rtol=1e-8)
    # the kernel measures with the Jacobian of Newton's last iteration, within 1e-4 of the point
    np.testing.assert_allclose(compiled.tangents, plain.tangents, atol=1e-6)
    np.testing.assert_allclose(compiled.tests, plain.tests, rtol=1e-5, atol=1e-6)
    assert (compiled.unstable == plain.unstable).all()
    assert compiled.next_step == pytest.approx(plain.next_step, rel=1e-6)
    assert compiled.evaluations == plain.evaluations


def test_rows_satisfy_the_equations_and_tangents_are_tangent():
    equations, states, parameters, bounds = SYSTEMS["three states"]
    branch = follow(equations, states, parameters, bounds)
    assert len(branch.z) > 20
    for z, t in zip(branch.z, branch.tangents, strict=True):
        f, jacobian = branch.problem.linearise(z)
        assert np.abs(f).max() < 1e-8
        assert np.abs(jacobian @ t).max() < 1e-5 * np.linalg.norm(t)


def observed_order(h, error):
    return np.polyfit(np.log(h), np.log(error), 1)[0]


def test_predictor_with_memory_misses_the_circle_by_third_order():
    """From two equal steps the predictor is z + h t + (h/2)(t - t_old); on a circle its first correction is O(h^3)."""
    problem, z = problem_of({"x": "1 - x^2 - p^2"}, {"x": 1.0}, {"p": 0.0})
    scale = np.ones(2)
    steps = 0.2 / 2.0 ** np.arange(5)
    first = []
    for h in steps:
        settings = Settings(step=h, max_step=h, max_angle=80.0)
        chunk = python_march.march(
            DenseMarch(problem),
            origin_of(problem, z, scale),
            None,
            0.0,
            Frame(scale),
            h,
            2,
            (-9.0, 9.0),
            settings,
            None,
        )
        last = chunk.sample(-1)
        guess = h * last.tangent + 0.5 * h * (last.tangent - chunk.tangents[-2])
        found = corrector.correct(DenseMarch(problem), last.z, last.tangent, h, guess, scale, 1e-13)
        first.append(found.first_correction)
    assert observed_order(steps, first) == pytest.approx(3.0, abs=0.15)


def test_newton_on_the_curve_converges_quadratically():
    problem, z = problem_of({"x": "1 - x^2 - p^2"}, {"x": 1.0}, {"p": 0.0})
    scale, base = np.ones(2), origin_of(*(lambda q, w: (q, w, np.ones(2)))(problem, z))
    sizes = []
    for offset in (1e-1, 1e-2, 1e-3):
        guess = np.array([offset, 0.3])
        found = corrector.correct(DenseMarch(problem), z, base.tangent, 0.3, guess, scale, 1e-14)
        exact = np.array([np.sqrt(1 - 0.09) - 1.0, 0.3])
        jacobian = np.array([[-2 * (1 + guess[0]), -2 * guess[1]], [0.0, 1.0]])
        residual = np.array([1 - (1 + guess[0]) ** 2 - guess[1] ** 2, 0.0])
        one = guess - np.linalg.solve(jacobian, residual)
        sizes.append(np.linalg.norm(one - exact))
        assert np.linalg.norm(found.y - exact) < 1e-14
        assert found.iterations <= 6
    errors = np.array([abs(offset - (np.sqrt(0.91) - 1.0)) for offset in (1e-1, 1e-2, 1e-3)])
    assert np.all(sizes <= 0.6 * errors**2 / np.sqrt(0.91))


def test_labelled_points_do_not_depend_on_the_step():
    """Verified to full precision: p and x of a fold agree to rounding for steps over two orders of magnitude."""
    equations, states, parameters, bounds = SYSTEMS["tank"]
    found = [
        [
            (q.type, q.values["p"])
            for q in follow(equations, states, parameters, bounds, settings={"max_step": h}).points
        ]
        for h in (0.005, 0.02, 0.1, 0.5)
    ]
    assert found[0]
    for other in found[1:]:
        assert [t for t, _ in other] == [t for t, _ in found[0]]
        assert [p for _, p in other] == pytest.approx([p for _, p in found[0]], rel=1e-13)


BUDGETS = {  # evaluations of the march and accepted points; measured in the comment
    "circle": (300, 130),  # 239, 117
    "tank": (230, 110),
    "oscillator": (60, 40),
    "three states": (200, 90),
}


@pytest.mark.parametrize("name", BUDGETS)
def test_effort_stays_within_its_budget(name):
    branch = follow(*SYSTEMS[name])
    evaluations, steps = BUDGETS[name]
    assert branch.effort["evaluations"] <= evaluations, branch.effort
    assert branch.effort["steps"] <= steps, branch.effort


def test_straight_branch_takes_one_over_max_step_points():
    branch = follow({"x": "p - x"}, {"x": 0.0}, {"p": 0.0}, (0.0, 1.0), settings={"max_step": 0.05})
    assert branch.steps <= 2 * 20 + 10
    assert branch.effort["evaluations"] <= 2 * branch.steps + 2


@dataclass(frozen=True, eq=False)
class BlindBeyond(DenseLinearisation):
    """Corrects, and knows no tangent."""

    def solve(self, right):
        return super().solve(right) if right[-1] != 1.0 else np.full_like(right, np.nan)


@dataclass(frozen=True, eq=False)
class Blind(DenseMarch):
    """Corrects everywhere; tangents are known up to p = 0.5 (as where a preconditioner fails, and the residual not)."""

    def linearisation(self, z, tangent, scale):
        here = super().linearisation(z, tangent, scale)
        return here if z[-1] <= 0.5 else BlindBeyond(here.residual, here.factors, here.sign, here.log_determinant)


def test_no_row_is_without_a_tangent():
    equations, states, parameters, bounds = SYSTEMS["circle"]
    problem, z = problem_of(equations, states, parameters)
    scale = problem.initial_scale(z, bounds)
    settings = Settings()
    chunk = python_march.march(
        Blind(problem), origin_of(problem, z, scale), None, 0.0, Frame(scale), settings.first_step, 200, bounds,
        settings, None,
    )  # fmt: skip
    assert chunk.stop is Stop.NOT_FINITE
    assert np.isfinite(chunk.tangents).all()
    assert chunk.z[-1, -1] == pytest.approx(0.5, abs=1e-6)
