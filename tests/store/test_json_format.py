"""JSON results: exact numbers, no NaN, two ends, files replaced whole."""

import json
import math

import jsonschema
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from contin.continuation.branch import End
from contin.errors import FormatVersionError, InputError
from contin.store import json_format
from contin.store.result_schema import RESULT_SCHEMA
from tests.characters import texts
from tests.plot.sample import bautin, branch, hysteresis, pitchfork, special

MODEL = {"name": "m", "states": ["x"], "parameters": {"p": 1.0}}
VALIDATOR = jsonschema.Draft202012Validator(RESULT_SCHEMA)
TIMING = {"import": 0.1, "total": 1.0}
any_float = st.floats(allow_nan=True, allow_infinity=True, width=64)


def document(branches, **more):
    return json_format.result_document(MODEL, branches, timing=TIMING, **more)


@given(
    columns=st.integers(1, 6).flatmap(
        lambda rows: st.dictionaries(texts(min_size=1), arrays(np.float64, rows, elements=any_float), min_size=1)
    ),
    eigenvalue=st.complex_numbers(),
    coefficient=st.one_of(any_float, st.complex_numbers(), texts(), st.booleans(), st.integers(-9, 9)),
    name=texts(min_size=1),
    kind=st.sampled_from(["equilibrium", "fixed-point", "orbit", "locus"]),
)
def test_every_document_follows_the_schema_and_survives_reading_back(columns, eigenvalue, coefficient, name, kind):
    point = special("HB", "HB1", 0, {"p": 1.5}, [eigenvalue], l1=coefficient)
    made = document([branch(name, columns, [point], kind=kind)])
    VALIDATOR.validate(made)
    assert json.loads(json_format.dumps(made)) == made


@given(value=st.floats(allow_nan=False, allow_infinity=False))
def test_numbers_read_back_to_the_same_bits(value):
    made = json.loads(json_format.dumps(document([branch("b", {"x": np.array([value])})])))
    assert math.copysign(1, made["branches"][0]["columns"]["x"][0]) == math.copysign(1, value)
    assert made["branches"][0]["columns"]["x"][0] == value


def test_nan_and_infinity_are_null_everywhere():
    point = special("LP", "LP1", 0, {"p": math.nan}, [complex(math.inf, 0)], a=math.nan, list=[1.0, -math.inf])
    made = document([branch("b", {"x": np.array([math.nan, 1.0, math.inf])}, [point])])
    assert made["branches"][0]["columns"]["x"] == [None, 1.0, None]
    first = made["branches"][0]["points"][0]
    assert first["values"] == {"p": None}
    assert first["eigenvalues"] == [[None, 0.0]]
    assert first["normal_form"] == {"a": None, "list": [1.0, None]}


def test_orbits_and_maps_carry_multipliers_and_equilibria_eigenvalues():
    point = special("PD", "PD1", 0, {"p": 0.0}, [-1 + 0j])
    kinds = {"equilibrium": "eigenvalues", "locus": "eigenvalues", "orbit": "multipliers", "fixed-point": "multipliers"}
    for kind, key in kinds.items():
        written = document([branch("b", {"x": np.zeros(1)}, [point], kind=kind)])["branches"][0]["points"][0]
        assert written[key] == [[-1.0, 0.0]]
        assert len({"eigenvalues", "multipliers"} & set(written)) == 1


def test_keys_stand_in_the_order_of_the_format():
    made = document(pitchfork())
    assert list(made) == ["contin", "model", "branches", "built", "notes", "timing"]
    keys = "name kind locus parameters parent image_of columns points ends steps seconds effort".split()
    assert [list(b) for b in made["branches"]] == [keys] * 3
    keys = "label type index values residual error eigenvalues normal_form".split()
    assert list(made["branches"][0]["points"][0]) == keys


def test_relations_between_branches_are_names():
    line, fork, mirror = document(pitchfork())["branches"]
    assert line["parent"] is None
    assert fork["parent"] == {"branch": "line", "label": "BP1"}
    assert mirror["image_of"] == {"branch": "fork", "symmetry": "flip"}
    assert document(bautin())["branches"][2]["locus"] == "LPC"


def test_what_belongs_to_an_end_stands_beside_its_reason():
    saddle = {"at": {"p": 4.5}, "error": 1e-9, "saddle": {"x": np.float64(0.5)}, "eigenvalues": np.array([1 + 2j])}
    ends = (End("start", "born"), End("homoclinic", "the period grows without bound", saddle))
    written = document([branch("b", {"x": np.zeros(2)}, ends=ends)])["branches"][0]["ends"]
    assert written[0] == {"reason": "start", "text": "born"}
    assert written[1]["at"] == {"p": 4.5}
    assert written[1]["saddle"] == {"x": 0.5}
    assert written[1]["eigenvalues"] == [[1.0, 2.0]]


def test_orbits_are_added_to_points_that_have_one():
    def sampler(branch, point):
        orbit = {"t": np.array([0.0, 1.0]), "x": np.array([2.0, 2.0])}
        return {"orbit": orbit} if branch.kind == "orbit" else None

    rest, cycles, _ = document(bautin(), orbit=sampler)["branches"]
    assert cycles["points"][0]["orbit"] == {"t": [0.0, 1.0], "x": [2.0, 2.0]}
    assert "orbit" not in rest["points"][0]


def test_a_branch_takes_a_line_for_each_column_and_point():
    text = json_format.dumps(document(hysteresis()))
    assert sum(line.lstrip().startswith('"x": [') for line in text.splitlines()) == 1
    assert max(len(line) for line in text.splitlines() if '"label"' not in line) > 1000


def test_a_failed_write_leaves_the_old_file_and_no_part_of_the_new(tmp_path):
    path = tmp_path / "out.json"
    path.write_text("old")
    with pytest.raises(TypeError, match="no form"):
        json_format.write(json_format.plain({"a": object()}), path)
    assert path.read_text() == "old"
    json_format.write({"a": 1}, path)
    assert [file.name for file in tmp_path.iterdir()] == ["out.json"]
    with pytest.raises(InputError, match="folder must exist"):
        json_format.write({}, tmp_path / "absent" / "out.json")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", r":1:2: not JSON"),
        ("[]", "not a contin result"),
        ('{"branches": 1}', "not a contin result"),
        ("[" * 200_000, "not a contin result"),
    ],
)
def test_files_that_are_no_results_are_refused_with_a_reason(tmp_path, text, message):
    path = tmp_path / "x.json"
    path.write_text(text)
    with pytest.raises(InputError, match=message):
        json_format.read(path)


def test_a_newer_format_is_refused(tmp_path):
    path = tmp_path / "x.json"
    path.write_text('{"contin": 2, "branches": []}')
    with pytest.raises(FormatVersionError, match="format 2"):
        json_format.read(path)
