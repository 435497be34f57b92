"""A model's graph text: read back, every node is the identical one; anything but a model is refused."""

import json

import pytest
from hypothesis import example, given, settings

from contin.model.bundled import folder
from contin.model.expression import exactly, number, power, symbol
from contin.model.graph_text import from_graph_text, to_graph_text
from contin.model.model import Model
from contin.model.parts import State
from contin.model.registry import load
from tests.model.trees import expressions

BUNDLED = sorted(f"{path.parent.name}/{path.stem}" for path in folder().glob("*/*.yaml") if path.parent.name != "pde")


def holding(expression):
    return Model.from_parts(name="m", states=(State("x", number(0)),), parameters=(), equations=(expression,))


@settings(max_examples=100, deadline=None)
@given(expressions())
@example(number(float("inf")) * symbol("x"))
@example(number(float("nan")) + symbol("x"))
@example(number(-0.1 - 0.2) * symbol("x:y"))
@example(exactly("add", (number(1), number(2))))  # what no constructor builds is read back as it was
@example(power(number(0), number(-1)))
def test_formulas_are_read_back_as_the_identical_nodes(expression):
    assert from_graph_text(to_graph_text(holding(expression))).equations[0] is expression


@pytest.mark.parametrize("name", BUNDLED)
def test_bundled_models_are_read_back_equal(name):
    model = load(name)
    again = from_graph_text(to_graph_text(model))
    assert again == model
    assert to_graph_text(again) == to_graph_text(model)
    assert list(again.definitions) == list(model.definitions)


@pytest.mark.parametrize(
    "change",
    [
        lambda d: d["nodes"].append(["__import__", 0]),
        lambda d: d["nodes"].insert(0, ["add", 5, 6]),
        lambda d: d["nodes"].append(["add", -1, 0]),
        lambda d: d["nodes"].append(["number", "os"]),
        lambda d: d["parts"].update(states=["part", "Model", 1]),
        lambda d: d["parts"].update(states=["call", "print"]),
        lambda d: d["parts"].update(name2="x"),
        lambda d: d.pop("nodes"),
    ],
)  # fmt: skip
def test_anything_else_is_refused(change):
    data = json.loads(to_graph_text(holding(symbol("x"))))
    change(data)
    with pytest.raises(ValueError, match=r"\S"):
        from_graph_text(json.dumps(data))
    with pytest.raises(ValueError, match=r"\S"):
        from_graph_text("{")


def test_a_model_that_holds_something_else_has_no_text():
    with pytest.raises(TypeError, match="object"):
        to_graph_text(holding(symbol("x")).replace(source=object()))
