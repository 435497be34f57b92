"""Piecewise equations with modes as inputs: the same formulas on each side, and the surfaces between them."""

import ctypes

import numpy as np
import pytest

from contin.lowering import compile_system
from contin.lowering.calls import make_call
from contin.model.model import Model


def flow(equation: str, **parameters: float) -> Model:
    equations = {"x": equation, "y": "x"}
    return Model("piecewise", states={"x": 0, "y": 0}, parameters=parameters or {"a": 1.0}, equations=equations)


def value_in_modes(system, u, p, modes):
    pieces = system.pieces
    u, p = np.array(u, float), np.concatenate([p, modes])
    out = np.zeros(2)
    call = make_call(pieces.value_address, 3)
    call(*(ctypes.c_void_p(v.ctypes.data) for v in (u, p, out)))
    return out[0]


def test_a_product_is_taken_apart_into_its_factors():
    pieces = compile_system(flow("x^3 if 2*x*y^3 > 0 else 0")).pieces
    assert [pieces.name(k) for k in range(pieces.count)] == ["x = 0", "y = 0"]


def test_even_powers_have_no_side():
    assert compile_system(flow("x if y*x^2 > 0 else 0")).pieces.count == 1


def test_a_difference_and_its_negative_are_one_surface():
    system = compile_system(flow("(1 if x > a else 0) + (3 if a > x else 0) + (5 if 2*x < 2*a else 0)"))
    assert system.pieces.count == 1


FORMULAS = [
    "abs(x - a)*y", "min(x, y)", "max(x, a*y)", "sign(x)*y", "heaviside(y - a)", "abs(x + abs(y))",
    "x^2 if 0 < x < y else -y if y > a or x < 0 else 7",
]  # fmt: skip


@pytest.mark.parametrize("formula", FORMULAS)
def test_the_mode_of_a_point_gives_the_formula_of_that_point(formula):
    system = compile_system(flow(formula, a=0.3))
    pieces, generator, p = system.pieces, np.random.default_rng(3), np.array([0.3])
    call = make_call(pieces.surfaces_address, 4)
    for u in generator.normal(size=(40, 2)):
        h, dh = np.zeros(pieces.count), np.zeros((pieces.count, 2 + pieces.p_size))
        full = np.concatenate([p, np.ones(pieces.count)])
        call(*(ctypes.c_void_p(v.ctypes.data) for v in (u, full, h, dh)))
        assert value_in_modes(system, u, p, np.sign(h)) == system.value(u, p)[0]


def test_held_modes_extend_a_formula_beyond_its_surface():
    system = compile_system(flow("x^2 if x > 0 else -5"))
    assert value_in_modes(system, [-2.0, 0.0], [1.0], [1.0]) == 4.0
    assert value_in_modes(system, [2.0, 0.0], [1.0], [-1.0]) == -5.0


def test_smooth_equations_have_no_surfaces():
    assert compile_system(flow("a*x - x^3")).pieces.count == 0


def test_conditions_on_parameters_alone_stay_conditions():
    system = compile_system(flow("x if a > 0 else y"))
    assert system.pieces.count == 1  # a may vary: it is a surface that no trajectory crosses
    assert value_in_modes(system, [3.0, 4.0], [1.0], [1.0]) == 3.0


@pytest.mark.parametrize("equation", ["a*x - y^3", "x - a"])
def test_smooth_equations_are_compiled_once(equation):
    system = compile_system(flow(equation))
    pieces = system.pieces
    assert (pieces.value_address, pieces.jacobian_address) == (system.value_address, system.jacobian_address)
    assert pieces.count == 0
    assert pieces.p_size == system.p_size == pieces.first_mode
