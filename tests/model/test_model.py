"""Models: from files and from Python alike, with values resolved by the documented precedence."""

import pickle

import numpy as np
import pytest

import contin
from contin.errors import FormatVersionError, InputError, NotFiniteError
from contin.model.evaluate import evaluate_all
from contin.model.expression import symbol
from contin.model.model import Model
from contin.model.yaml_loader import load_model, load_model_text, model_from_mapping

EVERY_KEY = """\
contin: 1
name: everything
title: A model that uses every key
source: "Somebody (2020): a book, p. 1"
description: >-
  Two lines
  of text
kind: flow
states:
  x: 1.0
  v: {value: 3.0*A, unit: mol/L, description: second species}
  psi: {value: 0, period: 2*pi}
parameters:
  A: 1.0
  B: {value: 2.5, range: [0, 4*A], unit: 1/s}
  C: A + B
  eps: 1e-3
functions:
  g(u, v): "A*u^3 - h(v)^5 if u*v > 0 else 0"
  h(x): x*r2
definitions:
  amplitude: sqrt(r2)
  r2: x^2 + v^2
  inside: r2 < 1
equations:
  v: -x + eps*g(v, x)
  x: v if inside else v/2
  psi: 1 + cos(t*C)
observables:
  amplitude: amplitude
  size: max(x, v, 0)
symmetries: {}
starts:
  rest: {x: 0, v: 0}
  far off: {x: sqrt(A), v: B + C, parameters: {B: 2, A: 4}}
averaging:
  small: eps
  oscillators: [{position: x, velocity: v}]
forcing: {period: 2*pi/C}
expect:
  - {label: HB, at: [{B: 2}, {B: A/3}], tolerance: 1e-8, run: {parameter: B, range: [0, 4]}}
  - {label: LP, at: []}
"""


@pytest.fixture(scope="module")
def everything():
    return load_model_text(EVERY_KEY, "everything.yaml")


def test_printed_model_loads_to_an_equal_model(everything):
    again = load_model_text(everything.text())
    assert again == everything
    assert hash(again) == hash(everything)
    assert again.text() == everything.text()
    assert pickle.loads(pickle.dumps(everything)) == everything  # noqa: S301


def test_python_twin_equals_the_loaded_file(everything):
    from contin.model.yaml_reader import read_text

    data = read_text(EVERY_KEY).data
    del data["contin"]
    twin = contin.Model(**data)
    assert twin == everything
    assert str(twin) == str(everything)
    assert twin.text() == everything.text()


def test_expressions_and_numbers_of_numpy_are_as_good_as_text():
    x, y, mu = symbol("x"), symbol("y"), symbol("mu")
    by_operators = Model(
        "m",
        states={"x": np.float64(0.1), "y": 0},
        parameters={"mu": {"value": np.int64(2), "range": (0, 3)}},
        equations={"x": mu * x - x**3 + y + 1, "y": -y},
    )
    by_text = Model(
        name="m",
        states={"x": "0.1", "y": 0.0},
        parameters={"mu": {"value": 2, "range": [0, 3]}},
        equations={"x": "mu*x - x^3 + y + 1", "y": "-y"},
    )
    assert by_operators == by_text


def test_functions_and_definitions_are_inserted_in_any_order(everything):
    env = {"x": 0.6, "v": 0.7, "psi": 0.0, "A": 1.5, "B": 2.0, "C": 3.0, "eps": 0.1, "t": 0.25}
    r2 = 0.6**2 + 0.7**2
    g = 1.5 * 0.7**3 - (0.6 * r2) ** 5
    expected = [0.7, -0.6 + 0.1 * g, 1 + np.cos(0.75)]
    np.testing.assert_allclose(evaluate_all(everything.equations, env), expected, rtol=1e-14)
    assert set(everything.observables) == {"amplitude", "size"}


def test_an_argument_is_never_mistaken_for_a_state_of_the_same_name():
    model = Model(
        "m", states={"x": 0, "y": 0}, equations={"x": "f(2*y)", "y": "0"}, functions={"f(x)": "x + z"},
        definitions={"z": "10*x"},
    )  # fmt: skip
    assert evaluate_all(model.equations, {"x": 1.0, "y": 3.0}) == [16.0, 0.0]


def test_definitions_that_share_a_part_are_one_node():
    model = Model(
        "m", states={"x": 0, "y": 0}, definitions={"r2": "x^2 + y^2"}, equations={"x": "-x*r2", "y": "exp(r2)"}
    )
    assert model.equations[1].args[0] is model.definitions["r2"]
    assert "x: -x*r2" in model.text()


def test_precedence_of_parameters_is_model_start_call(everything):
    assert everything.default_parameters() == {"A": 1.0, "B": 2.5, "C": 3.5, "eps": 1e-3}
    u, p = everything.start_point("far off")
    np.testing.assert_array_equal(p, [4.0, 2.0, 6.0, 1e-3])  # C = A + B follows
    np.testing.assert_allclose(u, [2.0, 8.0, 0.0])
    u, p = everything.start_point("far off", {"B": 5})
    np.testing.assert_array_equal(p, [4.0, 5.0, 9.0, 1e-3])
    u, _ = everything.start_point({"x": "A/2", "parameters": {"A": 3}})
    np.testing.assert_allclose(u, [1.5, 9.0, 0.0])  # v keeps its default 3*A
    np.testing.assert_allclose(everything.periods(), [0, 0, 2 * np.pi])
    assert everything.parameter_range("B", {"A": 2}) == (0.0, 8.0)
    assert everything.parameter_range("A") is None


def test_a_start_outside_the_domain_says_why():
    model = Model("m", states={"r": "sqrt(1 - a)"}, parameters={"a": 0}, equations={"r": "1 - r"})
    with pytest.raises(NotFiniteError, match=r"state r: 'sqrt\(1 - a\)' is not a number.*'1 - a' = -3"):
        model.start_point(None, {"a": 4})


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("nowhere",), "has no start 'nowhere': there are rest, far off"),
        (({"X": 0},), "not a state: did you mean 'x'"),
        (({"x": "v"},), "v is a state; values here are formulas in the parameters"),
        (({"x": None},), "expected a number or a formula, got nothing"),
        ((None, {"b": 1}), "no parameter 'b': did you mean 'B'"),
        ((None, {"B": "A +"}), "the formula ends too early"),
        ((None, {"A": "B", "B": "A"}), "defined in a circle"),
        ((None, {"B": float("nan")}), "expected a finite number"),
        ((None, {"B": True}), "expected a number or a formula"),
    ],
)
def test_wrong_starts_and_parameters_are_named(everything, arguments, message):
    with pytest.raises(InputError, match=message):
        everything.start_point(*arguments)


def test_parts_can_be_exchanged(everything):
    half = everything.replace(name="half", equations=tuple(e / 2 for e in everything.equations))
    assert half.name == "half"
    assert half.states is everything.states
    assert half != everything
    with pytest.raises(TypeError, match="no part equation"):
        everything.replace(equation=())
    with pytest.raises(TypeError, match="needs states"):
        Model.from_parts(name="m", parameters=(), equations=())


def test_a_newer_format_is_refused_as_such():
    with pytest.raises(FormatVersionError, match=r"model.yaml:1:9: contin: format version 2 is newer"):
        load_model_text("contin: 2\nbrand-new-key: 1\n", "model.yaml")


def test_a_map_is_printed_as_a_map():
    henon = Model("henon", kind="map", states={"x": 0, "y": 0}, parameters={"a": 1.4, "b": 0.3},
                  equations={"x": "1 - a*x^2 + y", "y": "b*x"})  # fmt: skip
    assert "x -> 1 - a*x^2 + y" in str(henon)
    assert load_model_text(henon.text()).kind == "map"


def test_files_and_mappings_load_alike(tmp_path):
    path = tmp_path / "m.yaml"
    path.write_text("contin: 1\nname: m\nstates: {x: 0.1}\nequations: {x: -x}\n")
    mapping = {"name": "m", "states": {"x": 0.1}, "equations": {"x": "-x"}}
    assert load_model(path) == model_from_mapping(mapping) == contin.load(mapping) == contin.load(path)


def test_json_schema_accepts_what_loads_and_refuses_other_shapes(everything):
    import jsonschema

    from contin.model.json_schema import model_schema
    from contin.model.yaml_reader import read_text

    schema = model_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    jsonschema.validate(read_text(EVERY_KEY).data, schema)
    jsonschema.validate(read_text(everything.text()).data, schema)
    for change in ("titel: x", "kind: flo", "equations: 1", "states: []"):
        broken = read_text(EVERY_KEY).data | read_text(change).data
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate(broken, schema)
