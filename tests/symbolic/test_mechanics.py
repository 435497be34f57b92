import networkx
import numpy as np
import pytest

import contin
from contin.errors import InputError
from contin.model.evaluate import evaluate, evaluate_all
from contin.symbolic.passes.mechanics import mechanical_model
from contin.symbolic.passes.metronomes import metronomes


def point_of(model, seed=0):
    chance = np.random.default_rng(seed)
    env = {n: float(chance.uniform(0.5, 1.5)) for n in model.parameter_names}
    return {**env, "eps": 0.05, **{n: float(chance.uniform(-2, 2)) for n in model.state_names}}


def test_two_metronomes_on_one_platform_are_the_papers_equations():
    derived, printed = metronomes(2), contin.load("metronomes/pair")
    env = point_of(derived)
    np.testing.assert_allclose(
        evaluate_all(derived.equations, env), evaluate_all(printed.equations, env), rtol=1e-12, atol=1e-13
    )


@pytest.mark.parametrize("alike", [True, False])
@pytest.mark.parametrize("count", [1, 2, 3, 6])
def test_accelerations_solve_newtons_equations_and_keep_the_centre_of_mass(count, alike):
    """Numerically: m_i (a_i + A) = forces with sum of all momentum changes zero, in the paper's units."""
    model = metronomes(count, alike=alike)
    env = point_of(model, count)
    names = [f"x{i + 1}" for i in range(count)]
    found = np.array(evaluate_all(model.equations, env))[1::2]
    eps = env["eps"]
    mu = [env["mu"] if alike else env[f"mu{i + 1}"] for i in range(count)]
    beta = [env["beta"] if alike else env[f"beta{i + 1}"] for i in range(count)]
    kappa = [1.0 if alike or i == 0 else env[f"kappa{i + 1}"] for i in range(count)]
    rho = [1.0 if alike or i == 0 else env[f"rho{i + 1}"] for i in range(count)]
    mass = np.array([eps * m for m in mu])  # M = 1, omega = 1, delta_1 = k_1 = m_1
    stiffness = np.array(kappa) * mass[0]
    unit = np.array(rho) * mass[0] / stiffness  # delta_i/k_i
    x = np.array([env[q] for q in names])
    y = np.array([env[q.replace("x", "y")] for q in names])
    g = np.where(x * y > 0, env["a"] * x**3 - env["b"] * x**5, 0.0)
    acceleration = unit * found
    platform = -np.sum(mass * acceleration) / (1 + mass.sum())
    own = stiffness * unit * (x + eps * (np.array(beta) * y - env["sigma"] * x**3 - g))
    np.testing.assert_allclose(mass * acceleration + own + mass * platform, 0, atol=1e-12)


def test_a_pendulum_on_a_cart_is_solved_for_both_accelerations():
    model = mechanical_model(
        "cart", ["q", "X"],
        ["(M + m)*ddX + m*l*cos(q)*ddq - m*l*sin(q)*dq^2", "l*ddq + cos(q)*ddX + 9.81*sin(q)"],
        parameters={"M": 2, "m": 0.5, "l": 0.7},
    )  # fmt: skip
    env = {"M": 2, "m": 0.5, "l": 0.7, "q": 0.4, "dq": 1.1, "X": 0, "dX": 0.3}
    matrix = np.array([[0.5 * 0.7 * np.cos(0.4), 2.5], [0.7, np.cos(0.4)]])
    right = np.array([0.5 * 0.7 * np.sin(0.4) * 1.1**2, -9.81 * np.sin(0.4)])
    solved = np.linalg.solve(matrix, right)
    assert evaluate_all(model.equations, env) == pytest.approx([1.1, solved[0], 0.3, solved[1]])


def test_mistakes_in_mechanics_are_named():
    with pytest.raises(InputError, match="not linear in the accelerations"):
        mechanical_model("m", ["q"], ["ddq^2 + q"], parameters={})
    with pytest.raises(InputError, match="mass matrix is singular"):
        mechanical_model("m", ["q", "p"], ["ddq + ddp", "ddq + ddp + q"], parameters={})
    with pytest.raises(InputError, match="need as many equations"):
        mechanical_model("m", ["q", "p"], ["ddq"], parameters={})


def test_platforms_on_a_graph_couple_through_the_response_of_the_springs():
    """Simulated: platforms joined by springs, driven at frequency 1, answer as the coupling says."""
    graph, spring = networkx.path_graph(3), 0.2
    model = metronomes(3, platforms=graph, spring=spring)
    env = {**point_of(model), "a": 0.0, "b": 0.0, "sigma": 0.0, "beta": 0.0, "mu": 1.0}
    env |= {f"y{i}": 0.0 for i in (1, 2, 3)}
    x = np.array([env[f"x{i}"] for i in (1, 2, 3)])
    force = -(np.array(evaluate_all(model.equations, env))[1::2] + x) / env["eps"]
    # X'' + spring L X = x (per mu): at frequency 1, (spring L - 1) X = -... so X = -(1 - spring L)^-1 x and X'' = -X
    laplacian = networkx.laplacian_matrix(graph).toarray()
    amplitude = np.linalg.solve(np.eye(3) - spring * laplacian, x)
    np.testing.assert_allclose(force, amplitude, rtol=1e-12)
    with pytest.raises(InputError, match="resonate"):
        metronomes(3, platforms=graph, spring=1.0)
    with pytest.raises(InputError, match="places must name"):
        metronomes(2, platforms=graph, places=[0, 7])


def test_sigma_changes_phases_and_not_amplitudes():
    """Kato and Kori, Discussion: theta' gains -3 sigma r^2/8."""
    averaged = contin.average(metronomes(1))
    env = {**averaged.default_parameters(), "r": 1.3, "mu": 0}
    bent = {**env, "sigma": 0.7}
    assert evaluate(averaged.equations[0], bent) == evaluate(averaged.equations[0], env)
    shift = averaged.observables["frequency_shift"]
    assert evaluate(shift, bent) - evaluate(shift, env) == pytest.approx(-3 * 0.7 * 1.3**2 / 8)
