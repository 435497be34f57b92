"""Whatever a run file holds, reading it ends soon, with a plan or with an InputError that names the file."""

import tempfile
from pathlib import Path

from hypothesis import given, settings
from hypothesis import strategies as st

from contin.errors import InputError
from contin.model.yaml_reader import read_text
from contin.runs.load import read_run
from contin.runs.plan import make_plan
from tests.characters import texts

GOOD = """\
contin: 1
model: classics/brusselator
parameters: {A: 1}
diagram: {parameter: B, range: [0, 4], start: [rest], budget: {branches: 3}, settings: {max_step: 0.1}}
continuations:
  - {name: line, start: rest, parameter: B, range: [0, 4], values: {B: [1, 2.5]}, direction: up}
  - {name: cycles, from: line.HB1, parameter: B, range: [0, 4], settings: {intervals: 20}}
  - {name: hopfs, from: line.HB1, parameter: [B, A], range: {B: [0, 4], A: [0, 2]}}
outputs: {plot: a.png, save: a.contin, json: a.json, x: B, y: x}
"""
PIECES = st.sampled_from(
    [": ", "\n", "  ", "- ", "{", "}", "[", "]", "&a ", "*a", "!!python/name:os.system ", "|", "'", '"', "#", "~",
     "<<: ", "1e999", "\t", "x", "line.HB1", "../x.png", "/etc/passwd", "parameter", "null", "true", "nan",
     "-", "9" * 400]
)  # fmt: skip
VALUES = st.recursive(
    st.one_of(st.none(), st.booleans(), st.integers(), st.floats(), texts(max_size=8), st.just("rest"), st.just("B")),
    lambda inner: st.one_of(st.lists(inner, max_size=3), st.dictionaries(texts(max_size=4), inner, max_size=3)),
    max_leaves=6,
)
KEYS = ("name", "start", "from", "as", "parameter", "range", "direction", "values", "settings", "outputs", "transform")


def refused(text: str) -> bool:
    """True where the text is refused with an InputError; another exception, or a file written, fails the test."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "run.yaml"
        message = ""
        try:
            document = read_text(text, str(file))
            make_plan(read_run(document.data, document.source), document.source, file, {})
        except InputError as error:
            message = str(error)
        assert message == "" or message.startswith(str(file))
        assert list(Path(folder).iterdir()) == []
    return bool(message)


def test_the_file_itself_is_a_plan():
    assert not refused(GOOD)


@settings(max_examples=60, deadline=5000)
@given(st.data())
def test_mutated_run_files_are_plans_or_are_refused_in_words(data):
    text = GOOD
    for _ in range(data.draw(st.integers(1, 3))):
        start = data.draw(st.integers(0, len(text)))
        end = data.draw(st.sampled_from([start, start, start + 1, start + 5, start + 40]))
        text = text[:start] + data.draw(PIECES) + text[end:]
    refused(text)


@settings(max_examples=60, deadline=5000)
@given(st.dictionaries(st.sampled_from(KEYS), VALUES, min_size=1, max_size=3))
def test_any_values_in_a_continuation_are_a_plan_or_are_refused_in_words(entry):
    import json

    text = json.dumps({"contin": 1, "model": "classics/brusselator", "continuations": [{"parameter": "B", **entry}]})
    refused(text)
