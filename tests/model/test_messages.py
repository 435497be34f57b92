"""What a user reads when a model file is wrong: place, path, what is wrong, what to write; several at once."""

import textwrap

import pytest

from contin.errors import InputError
from contin.model import scope
from contin.model.model import Model
from contin.model.yaml_loader import load_model, load_model_text, model_from_mapping
from contin.model.yaml_reader import read_text

GOOD = """\
contin: 1
name: good
states:
  x: 1.0
  y: {value: 3.0}
parameters:
  mu: {value: 1, range: [0, 3]}
  beta: 2
functions:
  f(u): u^2
definitions:
  r2: x^2 + y^2
equations:
  x: mu*x - beta*y
  y: f(x) - y
observables:
  size: sqrt(r2)
symmetries: {}
starts:
  rest: {x: 0}
"""


def message(text: str) -> str:
    with pytest.raises(InputError) as caught:
        load_model_text(text, "m.yaml")
    return str(caught.value)


def test_the_text_that_the_cases_start_from_is_good():
    assert load_model_text(GOOD).name == "good"


def test_a_mistake_is_shown_in_its_line_with_carets():
    assert message(GOOD.replace("mu*x - beta*y", "mu*x - bate*y")) == textwrap.dedent("""\
        m.yaml:14:13: equations.x: unknown name 'bate': did you mean 'beta'?
           14 |   x: mu*x - bate*y
              |             ^^^^""")


def test_several_mistakes_are_reported_at_once_in_the_order_of_the_file():
    text = GOOD.replace("name: good", "name: good\ntitel: oops").replace("range: [0, 3]", "range: [3, 0, 1]")
    text = text.replace("sqrt(r2)", "sqrt(r2").replace("f(x) - y", "f(x, y) - y")
    lines = [line for line in message(text).splitlines() if line.startswith("m.yaml")]
    assert lines == [
        "m.yaml:3:1: titel: unknown key: did you mean 'title'?",
        "m.yaml:8:25: parameters.mu.range: expected two values [low, high], got a list",
        "m.yaml:16:6: equations.y: f(u) takes 1 argument, got 2",
        "m.yaml:18:13: observables.size: '(' is never closed",
    ]


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("contin: 1\n", "", "m.yaml:1:1: the format version is missing; add `contin: 1`"),
        ("contin: 1", "contin: one", "m.yaml:1:9: contin: expected the format version 1, got 'one'"),
        ("definitions:", "expressions:", "unknown key: names for parts of equations stand under definitions: {name: "),
        ("observables:", "initial:", "unknown key: states, with the values that runs start from, stand under states"),
        ("name: good\n", "", "'name' is missing; add `name: my-model`"),
        ("value: 3.0", "value: abc", "m.yaml:5:14: states.y.value: unknown name 'abc'"),
        ("value: 3.0", "value: true", "m.yaml:5:14: states.y.value: expected a number or a formula, got true"),
        ("value: 3.0", "value: .inf", "m.yaml:5:14: states.y.value: .inf is no number here: write a finite one"),
        ("value: 3.0", "guess: 3.0", "m.yaml:5:7: states.y.guess: unknown key: allowed are value, unit"),
        ("{value: 3.0}", "", "m.yaml:5:3: states.y: expected a number or a formula, got nothing"),
        ("{value: 3.0}", "[1]", "m.yaml:5:6: states.y: expected a number or a formula, got a list"),
        ("value: 3.0", "value: 3.0, period: 0", "states.y.period: a period must be positive and finite, got 0"),
        ("value: 3.0", "value: x", "m.yaml:5:14: states.y.value: x is a state; values here are formulas in the param"),
        ("value: 3.0", "value: r2", "states.y.value: r2 depends on states"),
        ("beta: 2", "beta: mu\n  mu: 2", "m.yaml:9:3: the key 'mu' is already on line 7; remove one of them"),
        ("beta: 2", "beta: 2*gamma\n  gamma: beta", "parameters are defined in a circle: beta -> gamma -> beta"),
        ("beta: 2", "beta: 1/0", "parameters: parameter beta: '1/0' is infinite: division by zero"),
        ("range: [0, 3]", "range: [3, 0]", "parameters.mu.range: expected [low, high] with low < high, got [3, 0]"),
        ("  beta: 2", "  x: 2\n  beta: 2", "m.yaml:8:3: parameters.x: x is already declared under states"),
        ("  beta: 2", "  period: 2\n  beta: 2", "m.yaml:8:3: parameters.period: 'period' is taken"),
        ("  beta: 2", "  and: 2\n  beta: 2", "parameters.and: 'and' is a word of the formula language"),
        ("  beta: 2", "  k.on: 2\n  beta: 2", "parameters.k.on: names may not contain a dot; write k_on"),
        ("  beta: 2", "  2k: 2\n  beta: 2", "parameters.2k: '2k' is not a name: letters, digits and underscores"),
        ("  f(u): u^2", "  f(u, u): u^2", "functions.f(u, u): two arguments have the same name"),
        ("  f(u): u^2", "  f(): 2", "functions.f(): a function needs an argument"),
        ("  f(u): u^2", "  f: 2", "functions.f: expected a heading such as g(u, v)"),
        ("  f(u): u^2", "  f(u): f(u - 1)", "functions.f(u): the function uses itself: f -> f"),
        ("  f(u): u^2", "  f(u): 2*w", "m.yaml:10:11: functions.f(u): unknown name 'w'"),
        ("r2: x^2 + y^2", "r2: a1\n  a1: sin(a2)\n  a2: 1 + r2", "defined in a circle: r2 -> a1 -> a2 -> r2"),
        ("r2: x^2 + y^2", "r2: size", "size is an observable; put it under definitions"),
        ("  y: f(x) - y\n", "", "m.yaml:13:1: equations: no equation for y; add `y: ...`"),
        ("  y: f(x) - y", "  y: f(x) - y\n  z: 0", "m.yaml:16:3: equations.z: z is not a state: states are x, y"),
        ("y: f(x) - y", "y: x > 1", "equations.y: a condition is not a number"),
        ("y: f(x) - y", "y: x - t\nkind: map", "unknown name 't': there is time in flows alone (kind: flow)"),
        ("y: f(x) - y", 'y: "f(x) \\u002d z"', "m.yaml:15:6: equations.y: unknown name 'z'"),
        ("y: f(x) - y", "y: >-\n    f(x)\n    - zz*y", "m.yaml:17:7: equations.y: unknown name 'zz'"),
        ("y: f(x) - y", "y: f(x)\n    - zz*y", "m.yaml:16:7: equations.y: unknown name 'zz'"),
        ("size: sqrt(r2)", "x: sqrt(r2)", "observables.x: x is already declared under states"),
        ("symmetries: {}", "symmetries: {flip: {beta: 1}}", "beta is a parameter; a symmetry maps states"),
        ("symmetries: {}", "symmetries: {flip: 3}", "symmetries.flip: expected a mapping {name: value}, got 3"),
        ("rest: {x: 0}", "rest: {z: 0}", "m.yaml:20:10: starts.rest.z: not a state: there are x, y"),
        ("rest: {x: 0}", "rest: {x: y}", "starts.rest.x: y is a state; values here are formulas in the parameters"),
        ("rest: {x: 0}", "rest: {x: 0, parameters: {b: 1}}", "starts.rest.parameters.b: not a parameter"),
        ("rest: {x: 0}", "a/b: {x: 0}", "starts.a/b: 'a/b' cannot name a branch"),
        ("symmetries: {}", "averaging: {small: x, oscillators: [{position: x, velocity: x}]}",
         "averaging.oscillators[0].velocity: x already belongs to an oscillator"),
        ("symmetries: {}", "averaging: {small: x}", "'oscillators' is missing"),
        ("symmetries: {}", "averaging: {small: x, oscillators: []}", "averaging.oscillators: is empty"),
        ("symmetries: {}", "kind: map\nforcing: {period: 1}", "forcing: a map has no time; use kind: flow"),
        ("symmetries: {}", "kind: maps", "m.yaml:18:7: kind: expected flow, map, bvp, algebraic or pde, got 'maps'"),
        ("symmetries: {}", "expect: [{label: HB, at: 3}]", "expect[0].at: expected a mapping {name: value}, got 3"),
        ("symmetries: {}", "expect: [{label: HB, at: [], run: {parameter: nu}}]", "'nu' is not a parameter"),
        ("symmetries: {}", "symmetries: !!python/object/apply:os.system [ls]", "is not allowed; write the plain value"),
    ],
)  # fmt: skip
def test_each_mistake_has_its_sentence(old, new, expected):
    assert old in GOOD
    assert expected in message(GOOD.replace(old, new, 1))


def test_a_call_from_python_names_the_call_and_shows_the_formula():
    with pytest.raises(InputError) as caught:
        Model("m", states={"x": 0}, parameters={"a": 1}, equations={"x": "a - x*b + 1"})
    assert str(caught.value) == "Model('m'): equations.x: unknown name 'b': declared are x, a, t\n" + (
        "      a - x*b + 1\n            ^"
    )


def test_a_mapping_inside_another_file_is_located_there():
    from contin.model.source import PartSource

    document = read_text("model:\n  name: m\n  states: {x: 0}\n  equations: {x: 1 + z}\n", "run.yaml")
    with pytest.raises(InputError, match=r"run.yaml:4:22: model.equations.x: unknown name 'z'"):
        model_from_mapping(document.data["model"], PartSource(document.source, ("model",)))


def test_text_in_messages_cannot_steer_a_terminal():
    text = message(GOOD.replace("mu*x - beta*y", '"\\e[2Jx"'))
    assert "\x1b" not in text


def test_very_many_mistakes_end_with_a_count():
    lines = "".join(f"  u{i}: q\n" for i in range(100))
    text = message(f"contin: 1\nname: m\nstates:\n{lines}equations: {{}}\n")
    assert text.count("m.yaml:") == 20
    assert text.endswith("... and 81 more")


@pytest.mark.parametrize(
    ("raw", "expected"),
    [
        (b"\xff\xfe\x00", "not UTF-8 text"),
        (b"contin: 1\x00", "not valid YAML"),
        (b"a: [1, 2", "not valid YAML"),
        (b"a: b: c", "a formula with ': ' in it needs quotes"),
        (b"[" * 100_000, "nested deeper than 40 levels"),
        (b"{" * 100_000, "a key must be a name"),
        (b"a: &a [*a]", "repeats a value that is not complete"),
        (b"a: 1\n---\nb: 2", "a second YAML document"),
        (b"? [a]\n: 1", "a key must be a name"),
        (b"", "expected a model"),
        (b"- 1\n- 2", "expected a model"),
    ],
)
def test_files_that_are_no_model_are_refused_in_words(tmp_path, raw, expected):
    path = tmp_path / "m.yaml"
    path.write_bytes(raw)
    with pytest.raises(InputError, match=r"m.yaml") as caught:
        load_model(path)
    assert expected in str(caught.value)


def test_files_that_cannot_be_read_are_refused_in_words(tmp_path):
    for path in (tmp_path, tmp_path / "absent.yaml", "a\0b"):
        with pytest.raises(InputError):
            load_model(path)


def test_an_alias_bomb_stops_at_the_budget():
    bomb = "a0: &a0 [1, 1]\n" + "".join(f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]\n" for i in range(1, 12))
    assert "values, aliases written out" in message(bomb)


def test_aliases_repeat_values():
    data = read_text("a: &p {value: 1e-3}\nb: *p\nc: [&s x, *s]\n").data
    assert data == {"a": {"value": 1e-3}, "b": {"value": 1e-3}, "c": ["x", "x"]}


def test_scalars_are_those_of_yaml_1_2():
    text = "{a: 1e-3, b: on, c: 0o17, d: yes, e: 1_000, f: 12:30:45, g: ~, h: True, i: '1', j: .5, k: -7, l: 20-01}"
    assert read_text(text).data == {
        "a": 1e-3, "b": "on", "c": "0o17", "d": "yes", "e": "1_000", "f": "12:30:45", "g": None, "h": True, "i": "1",
        "j": 0.5, "k": -7, "l": "20-01",
    }  # fmt: skip


def test_json_with_escapes_is_read_as_json_reads_it():
    import json

    value = {"title": "a \U0001f600 and µ", "x": [1, 2.5, None, True], "tab": "a\tb"}
    assert read_text(json.dumps(value)).data == value
    with pytest.raises(InputError, match="half of a character"):
        read_text('{"title": "\\ud83d"}')


def test_a_file_of_mistakes_stops_being_read():
    lines = "".join(f"  x: {i}\n" for i in range(5_000))
    assert message(f"contin: 1\nname: m\nstates:\n{lines}").endswith("... and at least 180 more")


def test_formulas_that_double_at_every_step_stop_at_the_budget(monkeypatch):
    monkeypatch.setattr(scope, "NODE_BUDGET", 20_000)
    functions = {"f0(x)": "sin(x)*x + 1"} | {f"f{i}(x)": f"f{i - 1}(x + 1)*f{i - 1}(x^2)" for i in range(1, 60)}
    with pytest.raises(InputError, match="grow beyond"):
        Model("m", states={"x": 0}, equations={"x": "f59(x)"}, functions=functions)


@pytest.mark.seldom
def test_thousands_of_definitions_in_a_chain_are_no_problem():
    chain = {"d0": "x"} | {f"d{i}": f"sin(d{i - 1}) + 1" for i in range(1, 3000)}
    model = Model("m", states={"x": 0}, equations={"x": "d2999"}, definitions=dict(reversed(chain.items())))
    assert load_model_text(model.text()) == model
