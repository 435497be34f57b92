"""From a guess to an equilibrium: starts at which Newton alone stalls, and starts that have no equilibrium near."""

from math import exp

import numpy as np
import pytest

import contin
from contin.errors import InputError, NoSolutionError
from tests.problems.follow import model


def test_a_residual_that_is_only_rounding_is_a_solution():
    # 1 - 0.3 - |0 - 0.7| is 5.6e-17 in binary arithmetic, and no x near 0 makes it smaller
    system = model({"x": "p - 0.3 - abs(x - 0.7)"}, {"x": 0.0}, {"p": 1.0})
    assert contin.equilibrium(system, {"x": 0.0}, {"p": 1.0}).u == pytest.approx([0.0], abs=1e-15)


def test_where_newton_leaves_the_range_of_steep_sigmoids_another_method_finds_the_equilibrium():
    sigmoids = {"E": "-E + 1/(1 + exp(-(16*E - 12*J + P)))", "J": "-J + 1/(1 + exp(-(15*E - 3*J + Q)))"}
    system = model(sigmoids, {"E": 0.1, "J": 0.1}, {"P": -2.0, "Q": -4.0})  # Wilson and Cowan (1972)
    excited, inhibited = contin.equilibrium(system, {"E": 0.1, "J": 0.1}, {"P": -2.0, "Q": -4.0}).u
    assert excited == pytest.approx(1 / (1 + exp(2 - 16 * excited + 12 * inhibited)), rel=1e-12)
    assert inhibited == pytest.approx(1 / (1 + exp(4 - 15 * excited + 3 * inhibited)), rel=1e-12)


@pytest.mark.parametrize("gap", [1.0, 1e-6])
def test_no_method_finds_an_equilibrium_where_there_is_none(gap):
    system = model({"x": "x^2 + p"}, {"x": 0.5}, {"p": gap})
    with pytest.raises(NoSolutionError, match="no equilibrium found from the start"):
        contin.equilibrium(system, {"x": 0.5}, {"p": gap})


@pytest.mark.parametrize(
    ("formula", "guess", "root"), [("(x - 1)*exp(-x)", 4.0, 1.0), ("(x^2 + 0.1)*(x - 5)", -1.0, 5.0)]
)
def test_where_newton_is_led_astray_the_message_names_the_nearest_equilibrium(formula, guess, root):
    """Towards infinity, where the residual vanishes too, or into a minimum of it."""
    system = model({"x": formula}, {"x": guess}, {"p": 1.0})
    with pytest.raises(NoSolutionError, match=rf"residual .* -> .*nearest equilibrium found is x = {root:g};"):
        contin.equilibrium(system)


def test_a_model_without_parameters_has_solutions_and_no_branches():
    model = contin.Model("fixed", states={"x": 1.0, "y": 0.0}, equations={"x": "y", "y": "(1 - x^2)*y - x"})
    assert contin.equilibrium(model).u == pytest.approx([0.0, 0.0], abs=1e-12)
    assert [f.unstable for f in contin.find_equilibria(model)] == [2]
    assert contin.periodic_orbit(model).period == pytest.approx(6.66328686, rel=1e-8)  # van der Pol, mu = 1
    with pytest.raises(InputError, match="no parameter 'k': the model has none"):
        contin.continuation(contin.equilibrium(model), "k", (0.0, 1.0))


@pytest.mark.parametrize("seed", range(6))
def test_a_run_from_beside_zero_is_the_run_from_zero(seed):
    """Newton's method comes to 1e-34 there, which is nobody's scale."""
    equations = {"x": "p*x - 0.3*y - x^3", "y": "0.3*x + p*y - y^3", "z": "x*y + p*z"}
    system = model(equations, dict.fromkeys("xyz", 0.0), {"p": -1.0})
    size = 10.0 ** -(1 + seed % 3)
    start = dict(zip("xyz", size * np.random.default_rng(seed).uniform(-1.0, 1.0, 3), strict=True))
    beside = contin.continuation(contin.equilibrium(system, start), "p", (-1.0, 1.5))
    assert np.all(beside.columns["x"] == 0.0)
    assert [end.reason for end in beside.ends] == ["bound", "bound"]


def test_a_state_that_is_truly_small_stays():
    system = model({"x": "1e-20*p - x", "y": "p - y"}, {"x": 0.0, "y": 0.0}, {"p": 1.0})
    found = contin.equilibrium(system, {"x": 1e-3, "y": 0.5})
    assert found.u == pytest.approx([1e-20, 1.0], rel=1e-12, abs=0.0)


def test_an_amplitude_below_zero_is_no_equilibrium():
    """x'' + x = eps (a v - k sign(v) - c v^3): a r/2 = 2 k/pi + 3 c r^3/8, in which sign(v) presumes r > 0."""
    oscillator = contin.Model(
        "rubbing",
        states={"x": 1.0, "v": 0.0},
        parameters={"eps": 0.1, "a": 0.6},
        equations={"x": "v", "v": "-x + eps*(a*v - 0.5*sign(v) - 0.1*v^3)"},
        averaging={"small": "eps", "oscillators": [{"position": "x", "velocity": "v"}]},
    )
    averaged = contin.average(oscillator, form="polar")
    roots = np.roots([3 * 0.1 / 8, 0.0, -0.3, 2 * 0.5 / np.pi])
    found = 0
    for start in np.linspace(-4.0, 4.0, 17):
        try:
            r = contin.equilibrium(averaged, {"r": start}).u[0]
        except NoSolutionError:
            continue
        found += 1
        assert r > 0.0
        assert np.abs(roots - r).min() < 1e-9
    assert found >= 8
    with pytest.raises(NoSolutionError, match=r"r below its lowest value 0.*nearest equilibrium found is r = [0-9]"):
        contin.equilibrium(averaged, {"r": -2.6})
