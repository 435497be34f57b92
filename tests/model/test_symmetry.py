"""Declared symmetries are compared with the equations when a model is made."""

import numpy as np
import pytest

from contin.errors import InputError
from contin.model.model import Model


def pair(**changes):
    """Two coupled oscillator amplitudes and their phase difference."""
    entries = {
        "states": {"r1": 2, "r2": 2, "psi": {"value": 0, "period": "2*pi"}},
        "parameters": {"mu": 1, "beta": 0.8, "h": 0},
        "equations": {
            "r1": "-mu*r2*sin(psi) - beta*r1 + r1^3 + h",
            "r2": "mu*r1*sin(psi) - beta*r2 + r2^3 + h",
            "psi": "mu*(r1/r2 - r2/r1)*cos(psi) + r1^2 - r2^2",
        },
    }
    return Model("pair", **(entries | changes))


def test_symmetries_that_hold_are_accepted():
    model = pair(symmetries={"exchange": {"r1": "r2", "r2": "r1", "psi": "-psi"}})
    assert model.symmetry("exchange").map["psi"] is -model.symmetry("exchange").map["psi"] * -1


def test_a_wrong_sign_is_refused_with_the_equation_and_the_amount():
    with pytest.raises(InputError, match=r"symmetries.exchange: not a symmetry of the equations: the equation of \w+ "):
        pair(symmetries={"exchange": {"r1": "r2", "r2": "r1"}})


def test_a_symmetry_must_hold_for_all_parameters_not_only_the_defaults():
    gauge = {"gauge": {"r1": "-r1", "psi": "psi + pi"}}
    with pytest.raises(InputError, match=r"not a symmetry.*h = "):
        pair(symmetries=gauge)  # h breaks it, although its default is 0
    without = {"mu": 1, "beta": 0.8}
    equations = {
        "r1": "-mu*r2*sin(psi) - beta*r1 + r1^3",
        "r2": "mu*r1*sin(psi) - beta*r2 + r2^3",
        "psi": "mu*(r1/r2 - r2/r1)*cos(psi) + r1^2 - r2^2",
    }
    assert pair(parameters=without, equations=equations, symmetries=gauge).symmetry("gauge").name == "gauge"


def test_nonlinear_substitutions_use_the_derivative():
    # y = x^3 turns x' = -x into y' = -3y; the scaling x -> 2x is a symmetry of both
    Model("m", states={"x": 1, "y": 1}, equations={"x": "-x", "y": "-3*y"}, symmetries={"s": {"x": "2*x", "y": "8*y"}})
    Model("m", states={"x": 1, "y": 1}, equations={"x": "-x", "y": "-3*y"}, symmetries={"shear": {"y": "y + x^3"}})
    with pytest.raises(InputError, match="the equation of y"):
        Model("m", states={"x": 1, "y": 1}, equations={"x": "-x", "y": "-3*y"}, symmetries={"shear": {"y": "y + x^2"}})


def test_maps_compare_images_and_angles_modulo_their_period():
    # doubling an angle: the image of 2x is 2pi - 2x, twice the image of x is 4pi - 2x
    entries = {"kind": "map", "equations": {"x": "2*x"}, "symmetries": {"inversion": {"x": "2*pi - x"}}}
    Model("doubling", states={"x": {"value": 0.3, "period": "2*pi"}}, **entries)
    with pytest.raises(InputError, match=r"a difference of 6\.3"):
        Model("doubling", states={"x": 0.3}, **entries)


def test_rounding_in_a_difference_of_large_terms_is_not_a_broken_symmetry():
    equations = {"x": "(x + 1e9*y) - 1e9*y - x + 1e-9*(x - y)", "y": "1e-9*(y - x)"}
    swap = {"x": "y", "y": "x"}
    model = Model("m", states={"x": 1, "y": 1}, equations=equations, symmetries={"swap": swap})
    assert [symmetry.name for symmetry in model.symmetries] == ["swap"]


def test_a_projection_is_not_a_symmetry():
    with pytest.raises(InputError, match="not one-to-one"):
        Model("m", states={"x": 1, "y": 2}, equations={"x": "x*y", "y": "-y"}, symmetries={"drop": {"x": "0"}})


def test_piecewise_and_forced_equations_are_compared_too():
    Model(
        "m", states={"x": 1, "y": 0}, parameters={"a": 4, "w": 1}, forcing={"period": "2*pi/w"},
        equations={"x": "y", "y": "-x + (a*x^3 if x*y > 0 else 0) + x*cos(w*t)"},
        symmetries={"flip": {"x": "-x", "y": "-y"}},
    )  # fmt: skip
    with pytest.raises(InputError, match="not a symmetry"):
        Model(
            "m", states={"x": 1, "y": 0}, parameters={"w": 1}, forcing={"period": "2*pi/w"},
            equations={"x": "y", "y": "-x + cos(w*t)"}, symmetries={"flip": {"x": "-x", "y": "-y"}},
        )  # fmt: skip


def test_equations_with_a_small_domain_are_sampled_where_they_are_finite():
    # log and sqrt are real only near the default guess
    Model(
        "m", states={"x": 1.0, "y": 1.0}, equations={"x": "log(y) - sqrt(x)", "y": "log(x) - sqrt(y)"},
        symmetries={"swap": {"x": "y", "y": "x"}},
    )  # fmt: skip
    with pytest.warns(UserWarning, match="symmetry flip was not checked"):
        Model("m", states={"x": 1.0}, equations={"x": "log(-1 - x^2)"}, symmetries={"flip": {"x": "-x"}})


def test_a_ring_of_many_cells_may_be_rotated():
    n = 60
    states = {f"x{i}": 0.1 for i in range(n)}
    equations = {f"x{i}": f"sin(x{i}) + k*(x{(i + 1) % n} - x{i})" for i in range(n)}
    turn = {f"x{i}": f"x{(i + 1) % n}" for i in range(n)}
    model = Model("ring", states=states, parameters={"k": 1}, equations=equations, symmetries={"turn": turn})
    assert len(model.symmetries[0].map) == n
    turn["x0"], turn["x1"] = turn["x1"], turn["x0"]
    with pytest.raises(InputError, match="not a symmetry"):
        Model("ring", states=states, parameters={"k": 1}, equations=equations, symmetries={"turn": turn})


def test_stiff_scales_do_not_hide_a_broken_equation():
    equations = {"x": "-1e9*x", "y": "1e-6*y + 1e-9*y^2"}
    with pytest.raises(InputError, match="the equation of y"):
        Model("m", states={"x": 1, "y": 1}, equations=equations, symmetries={"flip": {"x": "-x", "y": "-y"}})
    assert np.isfinite(Model("m", states={"x": 1, "y": 1}, equations=equations).start_point()[0]).all()


@pytest.mark.parametrize("threshold", [5.0, 50.0, 900.0])
def test_a_symmetry_must_hold_beyond_surfaces_far_from_the_start(threshold):
    """x' = -x + max(x - k, 0) is odd for |x| < k alone; with the mirror image of the kink it is odd everywhere."""
    one_sided = {"x": f"-x + max(x - {threshold}, 0)"}
    with pytest.raises(InputError, match="not a symmetry"):
        Model("m", states={"x": 1.0}, equations=one_sided, symmetries={"flip": {"x": "-x"}})
    odd = {"x": f"-x + max(x - {threshold}, 0) - max(-x - {threshold}, 0)"}
    assert Model("m", states={"x": 1.0}, equations=odd, symmetries={"flip": {"x": "-x"}}).symmetries
