"""Several oscillators: the three forms against quadrature of the equations, and against each other."""

import math

import numpy as np
import pytest
from oscillating import mean_motion, oscillators, polar_motion, polar_of

import contin
from contin.errors import InputError
from contin.model.evaluate import evaluate_all

QUARTERS = [k * math.pi / 2 for k in range(4)]


def amplitudes(count, seed):
    chance = np.random.default_rng(seed)
    return chance.uniform(0.4, 2.0, count) * np.exp(1j * chance.uniform(0, 2 * math.pi, count))


def quarter_cuts(a):
    return [q - np.angle(z) for z in a for q in QUARTERS]


ESCAPEMENT = "(a*x{i}^3 - b*x{i}^5 if x{i}*y{i} > 0 else 0)"
PAIR = [
    "-beta*y{i} + {g} - mu*(x1 + x2) + nu*x{j}^2*y{i}".replace("{g}", ESCAPEMENT).format(i=i, j=3 - i) for i in (1, 2)
]
PARAMETERS = {"a": 3.1, "b": 0.7, "beta": 0.4, "mu": 2.0, "nu": 0.3}


@pytest.mark.parametrize("seed", range(3))
def test_polar_pair_agrees_with_quadrature(seed):
    model = oscillators(*PAIR, parameters=PARAMETERS)
    a = amplitudes(2, seed)
    motion = mean_motion(model, a, cuts=quarter_cuts(a))
    np.testing.assert_allclose(polar_motion(model, contin.average(model), a), polar_of(a, motion), atol=1e-11)


@pytest.mark.parametrize("seed", range(3))
def test_cartesian_form_is_the_mean_motion_itself_also_near_zero(seed):
    model = oscillators(*PAIR, parameters=PARAMETERS)
    averaged = contin.average(model, form="cartesian")
    a = amplitudes(2, seed) * np.array([1.0, 1e-3 if seed == 2 else 1.0])
    values = averaged.default_parameters() | {"u1": a[0].real, "v1": a[0].imag, "u2": a[1].real, "v2": a[1].imag}
    rates = np.array(evaluate_all(averaged.equations, values)).reshape(2, 2) @ [1, 1j]
    np.testing.assert_allclose(rates, mean_motion(model, a, cuts=quarter_cuts(a)), atol=1e-11)
    observed = dict(zip(averaged.observables, evaluate_all(averaged.observables.values(), values), strict=True))
    assert [observed["r1"], observed["r2"]] == pytest.approx(np.abs(a))
    assert observed["psi"] == pytest.approx(np.angle(a[1] / a[0]))


@pytest.mark.parametrize("seed", range(3))
def test_stokes_form_is_the_image_of_the_cartesian_one(seed):
    model = oscillators(*PAIR, parameters=PARAMETERS)
    averaged = contin.average(model, form="stokes")
    a = amplitudes(2, seed)
    rates = mean_motion(model, a, cuts=quarter_cuts(a))
    product = rates[0] * np.conj(a[1]) + a[0] * np.conj(rates[1])
    own = 2 * np.real(np.conj(a) * rates)
    state = {
        "S1": abs(a[0]) ** 2 - abs(a[1]) ** 2,
        "S2": 2 * (a[0] * np.conj(a[1])).real,
        "S3": 2 * (a[0] * np.conj(a[1])).imag,
    }
    found = evaluate_all(averaged.equations, averaged.default_parameters() | state)
    np.testing.assert_allclose(found, [own[0] - own[1], 2 * product.real, 2 * product.imag], atol=1e-10)
    assert state["S3"] == pytest.approx(-2 * abs(a[0]) * abs(a[1]) * math.sin(np.angle(a[1] / a[0])))


COUPLED = [
    # (forces, parameters, piecewise)
    (["mu*y1 + k*tanh(x2 - x1)", "mu*y2 + k*tanh(x1 - x2)"], {"mu": 0.4, "k": 0.8}, False),
    (["y1*exp(-x2^2)", "y2*(1 + x1*y2)"], {}, False),
    (["(1 - x1^2)*y1 - c*sign(y1 + y2)", "(1 - x2^2)*y2 - c*sign(y1 + y2)"], {"c": 0.5}, True),
    (["y1 if x1 - x2 > 0.3 else -x2", "x1*y2 if x1 + y2 < 0.2 and x2 > 0 else 0"], {}, True),
]


@pytest.mark.parametrize(("forces", "parameters", "piecewise"), COUPLED)
@pytest.mark.parametrize("form", ["polar", "cartesian"])
def test_couplings_without_a_closed_form_become_accurate_rules(forces, parameters, piecewise, form):
    model = oscillators(*forces, parameters=parameters)
    averaged = contin.average(model, form=form)
    for seed in range(2):
        a = amplitudes(2, 10 + seed)
        cuts = []
        if piecewise:  # find the switching instants on a fine grid
            tau = np.linspace(0, 2 * math.pi, 4001)
            z = a[:, None] * np.exp(1j * tau)
            x, y = z.real, -z.imag
            for h in (y[0] + y[1], x[0] - x[1] - 0.3, x[0] + y[1] - 0.2, x[1]):
                for k in np.flatnonzero(h[:-1] * h[1:] < 0):
                    cuts.append(tau[k] - h[k] * (tau[k + 1] - tau[k]) / (h[k + 1] - h[k]))
        motion = mean_motion(model, a, cuts=cuts)
        tolerance = 3e-7 if piecewise else 1e-11  # of the switching instants on the grid
        if form == "polar":
            np.testing.assert_allclose(polar_motion(model, averaged, a), polar_of(a, motion), atol=tolerance * 10)
        else:
            state = {"u1": a[0].real, "v1": a[0].imag, "u2": a[1].real, "v2": a[1].imag}
            found = np.array(evaluate_all(averaged.equations, averaged.default_parameters() | state)).reshape(2, 2)
            np.testing.assert_allclose(found @ [1, 1j], motion, atol=tolerance)


def test_friction_between_two_platforms_has_its_first_harmonic():
    """The mean of sign(V cos(t - d)) against exp(i t) is 2/pi exp(i d)."""
    model = oscillators("-sign(y1 + y2)", "0", parameters={})
    averaged = contin.average(model, form="cartesian")
    a = np.array([1.2 + 0.3j, -0.2 + 0.9j])
    state = {"u1": a[0].real, "v1": a[0].imag, "u2": a[1].real, "v2": a[1].imag}
    found = evaluate_all(averaged.equations, averaged.default_parameters() | state)
    expected = -2 / math.pi * (a[0] + a[1]) / abs(a[0] + a[1])
    assert complex(*found[:2]) == pytest.approx(expected, abs=1e-12)


def test_starts_symmetries_and_observables_are_carried_over():
    model = oscillators(
        *PAIR, parameters=PARAMETERS,
        starts={"quarter": {"x1": 2, "y1": 0, "x2": 0, "y2": -3}, "anti": {"x1": 1, "y1": 0, "x2": -1, "y2": 0}},
        symmetries={"exchange": {"x1": "x2", "x2": "x1", "y1": "y2", "y2": "y1"}},
        observables={"energy": "x1^2 + y1^2 + x2^2 + y2^2", "gap": "x1 - x2", "gain": "a/b"},
    )  # fmt: skip
    expected = {
        "polar": {"r1": 2, "r2": 3, "psi": math.pi / 2},
        "cartesian": {"u1": 2, "v1": 0, "u2": 0, "v2": 3},
        "stokes": {"S1": -5, "S2": 0, "S3": -12},
    }
    for form, point in expected.items():
        averaged = contin.average(model, form=form)
        u, p = averaged.start_point("quarter")
        assert u == pytest.approx(list(point.values()), abs=1e-15)
        env = dict(zip((*averaged.state_names, *averaged.parameter_names), (*u, *p), strict=True))
        observed = dict(zip(averaged.observables, evaluate_all(averaged.observables.values(), env), strict=True))
        assert observed["energy"] == pytest.approx(13)
        assert observed["gain"] == pytest.approx(3.1 / 0.7)
        assert "gap" not in observed
        assert "Without gap" in averaged.description
        assert "exchange" in [s.name for s in averaged.symmetries]
    assert contin.average(model).start_point("anti")[0] == pytest.approx([1, 1, math.pi])
    assert dict(contin.average(model, form="stokes").symmetry("exchange").map).keys() == {"S1", "S3"}


@pytest.mark.parametrize("form", ["polar", "cartesian", "stokes"])
def test_an_averaged_model_saves_and_loads_back_identically(form):
    averaged = contin.average(oscillators(*PAIR, parameters=PARAMETERS), form=form)
    again = contin.load(dict_of(averaged.text()))
    assert again.equations == averaged.equations
    assert again.observables == averaged.observables
    assert again == averaged


def dict_of(text):
    from ruamel.yaml import YAML

    return YAML(typ="safe").load(text)


def test_other_resonances_are_refused_and_small_detuning_is_kept():
    kwargs = {
        "states": {"x1": 1, "y1": 0, "x2": 1, "y2": 0},
        "averaging": {
            "small": "eps",
            "oscillators": [{"position": "x1", "velocity": "y1"}, {"position": "x2", "velocity": "y2"}],
        },
    }
    far = contin.Model(
        "far", parameters={"eps": 0.01},
        equations={"x1": "y1", "y1": "-x1 + eps*x2", "x2": "y2", "y2": "-4*x2 + eps*x1"}, **kwargs,
    )  # fmt: skip
    with pytest.raises(InputError, match=r"ratio 2 .*1:1 resonance"):
        contin.average(far)
    near = contin.Model(
        "near", parameters={"eps": 0.01, "w": 1.01},
        equations={"x1": "y1", "y1": "-x1 - eps*y1", "x2": "y2", "y2": "-w^2*x2 - eps*y2"}, **kwargs,
    )  # fmt: skip
    averaged = contin.average(near)
    env = averaged.default_parameters() | {"r1": 1, "r2": 2, "psi": 0.3}
    assert evaluate_all(averaged.equations, env)[2] == pytest.approx((1.01**2 - 1) / 2 / 0.01)  # (w^2 - 1)/(2 eps)


def test_ten_metronomes_average_in_seconds_and_exchange_stays():
    import time

    force = "-beta*y{i} - mu*({sum}) + {g}".replace("{g}", ESCAPEMENT)
    names = " + ".join(f"x{j + 1}" for j in range(10))
    forces = [force.format(i=i + 1, sum=names) for i in range(10)]
    model = oscillators(*forces, parameters={"a": 4, "b": 1, "beta": 0.5, "mu": 1.0})
    began = time.perf_counter()
    averaged = contin.average(model)
    assert time.perf_counter() - began < 30
    a = amplitudes(10, 4)
    motion = mean_motion(model, a, cuts=quarter_cuts(a))
    np.testing.assert_allclose(polar_motion(model, averaged, a), polar_of(a, motion), atol=1e-10)
