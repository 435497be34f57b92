"""Machine code is freed with its last user, and shared by equal models before that."""

from __future__ import annotations

import copy
import gc
import weakref

import pytest

import contin
from contin.api.machine_code import compiled
from contin.model.kept import kept_with
from contin.model.model import Model


def ring(name: str, equation: str = "p*{x} - {x}^3 + 0.1*{y}", n: int = 3) -> Model:
    names = [f"x{k}" for k in range(n)]
    equations = {x: equation.format(x=x, y=y) for x, y in zip(names, names[1:] + names[:1], strict=True)}
    return Model(name, states=dict.fromkeys(names, 0.0), parameters={"p": -1.0}, equations=equations)


def live(references: list[weakref.ref[object]]) -> int:
    gc.collect()
    return sum(reference() is not None for reference in references)


@pytest.mark.parametrize("equation", ["p*{x} - {x}^3 + 0.1*{y}", "p*{x} + abs({x}) - {x}^3 + 0.1*{y}",
                                      "p*{x} - 0.1*heaviside({y} - 2)"])  # fmt: skip
def test_no_engine_of_a_model_lives_on_after_its_runs(equation):
    engines: list[weakref.ref[object]] = []
    for k in range(4):
        model = ring(f"ring{k}", equation)
        branch = contin.continuation(contin.equilibrium(model), "p", (-1.0, -0.5))
        engines.append(weakref.ref(compiled(model)))
        assert len(branch.z) > 1
        del model, branch
        assert live(engines) == 0


def test_no_engine_lives_on_after_a_curve_in_two_parameters():
    model = Model("hopf", states={"x": 0.0, "y": 0.0}, parameters={"p": -1.0, "q": 1.0},
                  equations={"x": "p*x - q*y - x^3", "y": "q*x + p*y"})  # fmt: skip
    branch = contin.continuation(contin.equilibrium(model), "p", (-1.0, 1.0))
    curve = contin.continuation(branch["HB1"].locus(("p", "q")), ("p", "q"), {"p": (-1, 1), "q": (0.5, 2)})
    engine = weakref.ref(compiled(model))
    assert len(curve.z) > 1
    del model, branch, curve
    assert live([engine]) == 0


def test_a_branch_keeps_its_machine_code_when_the_model_is_gone():
    model = ring("kept")
    branch = contin.continuation(contin.equilibrium(model), "p", (-1.0, 1.0))
    engine = weakref.ref(compiled(model))
    del model
    assert live([engine]) == 1
    assert len(contin.continuation(branch.points[0].switch(), "p", (-1.0, 1.0)).z) > 1


def test_equal_models_share_their_machine_code_and_copies_of_one_carry_none():
    one, two = ring("ring"), ring("ring")
    assert compiled(one) is compiled(two)
    for other in (copy.copy(one), copy.deepcopy(one)):
        assert "_kept" not in vars(other) or not vars(other)["_kept"].things


def test_what_is_kept_is_made_once():
    model, made = ring("once"), []
    for _ in range(2):
        kept_with(model, "list", lambda: made.append(1))
    assert made == [1]
