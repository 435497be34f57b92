"""Whatever the text, reading it ends soon, with a model or with an InputError; nothing in it is ever executed."""

import sys

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from contin.errors import ExpressionError, InputError
from contin.model.parser import parse
from contin.model.yaml_loader import load_model_text, model_from_mapping
from tests.characters import texts
from tests.model.test_messages import GOOD
from tests.model.test_model import EVERY_KEY

WORDS = st.sampled_from(
    "x y beta f sin min if else and or not pi ( ) , + - * / ^ ** < <= == != = 1 2.5 1e9 1e-400 .5 __import__ os . [ ' "
    "é ² eval exec lambda \x00 \n".split(" ")
)


def refusal(read, *arguments) -> InputError | None:
    """The InputError with which `read` refuses its arguments; any other exception is a failure of the test."""
    try:
        read(*arguments)
    except InputError as error:
        return error
    return None


EVENTS = frozenset({"exec", "compile", "import", "os.system", "subprocess.Popen", "open", "pickle.find_class"})


@settings(max_examples=150, deadline=2000)
@given(
    st.one_of(
        texts(max_size=60), st.lists(WORDS, max_size=25).map(" ".join), st.lists(WORDS, max_size=25).map("".join)
    )
)
@example("if" * 30)
@example("((((((((((1")
@example("1if x>0else 2")
def test_any_text_is_a_formula_or_an_input_error(text):
    error = refusal(parse, text, ["x", "y", "beta"])
    assert error is None or (isinstance(error, ExpressionError) and 0 <= error.position <= len(text))


PIECES = st.sampled_from(
    [": ", "\n", "  ", "- ", "{", "}", "[", "]", "&a ", "*a", "!!python/name:os.system ", "|", ">", "'", '"', "#", "?",
     "%", "~", "<<: ", "1e999", "\t", "\x07", "x", "parameters:", "contin: 9", ",", "---\n", "\ud7ff", "null", "true"]
)  # fmt: skip


@settings(max_examples=100, deadline=3000)
@given(st.data())
def test_mutated_model_files_load_or_are_refused_in_words(data):
    text = data.draw(st.sampled_from([GOOD, EVERY_KEY]))
    for _ in range(data.draw(st.integers(1, 4))):
        start = data.draw(st.integers(0, len(text)))
        end = data.draw(st.sampled_from([start, start, start + 1, start + 5, start + 40]))
        text = text[:start] + data.draw(PIECES) + text[end:]
    error = refusal(load_model_text, text, "m.yaml")
    assert error is None or str(error).startswith("m.yaml")


VALUES = st.recursive(
    st.one_of(
        st.none(), st.booleans(), st.integers(), st.floats(), texts(max_size=8), st.sampled_from(["x", "-y", "1/0"])
    ),
    lambda inner: st.one_of(st.lists(inner, max_size=3), st.dictionaries(texts(max_size=4), inner, max_size=3)),
    max_leaves=6,
)
SECTIONS = st.sampled_from(
    "contin name title kind states parameters functions definitions equations observables symmetries starts averaging "
    "forcing expect other".split()
)


@settings(max_examples=100, deadline=3000)
@given(st.lists(st.tuples(SECTIONS, st.sampled_from(["", "x", "value", "parameters"]), VALUES), min_size=1, max_size=3))
def test_any_values_in_any_section_give_a_model_or_an_input_error(changes):
    mapping = {
        "name": "m",
        "states": {"x": 0, "y": {"value": 1}},
        "parameters": {"a": 1},
        "equations": {"x": "y", "y": "-x"},
        "starts": {"s": {"x": 1}},
    }
    for section, key, value in changes:
        if key and isinstance(mapping.get(section), dict):
            mapping[section] = {**mapping[section], key: value}
        else:
            mapping[section] = value
    error = refusal(model_from_mapping, mapping, "m")
    assert error is None or str(error).startswith("m:")


def test_nothing_in_a_model_file_is_executed_or_opened():
    load_model_text(EVERY_KEY)  # imports what reading needs
    seen: list[str] = []
    watching = True

    def watch(event: str, arguments: tuple[object, ...]) -> None:
        if watching and event in EVENTS:
            seen.append(f"{event} {arguments}")

    sys.addaudithook(watch)
    for attack in ("__import__('os').system('x')", "().__class__", "open('/etc/passwd')", "exec('1')", "x; import os"):
        with pytest.raises(InputError):
            load_model_text(GOOD.replace("u^2", f'"{attack}"'), "m.yaml")
    with pytest.raises(InputError):
        load_model_text(GOOD.replace("u^2", "!!python/object/apply:os.system ['x']"), "m.yaml")
    load_model_text(GOOD, "m.yaml")
    watching = False
    assert seen == []
