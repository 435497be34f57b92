"""Structured fuzzers: whatever a model, a run, a result or a command line holds, the answer is a result or one message.

Good documents are damaged in one to three places by values that have done harm somewhere; formulas are grown towards
deep and long ones. The short version is part of every run; `-m long` tries `LONG` of each (docs/reliability.md).
"""

import copy
import json
import sqlite3
import warnings
from contextlib import closing
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings, target
from hypothesis import strategies as st

import contin
from contin.errors import ContinError, ExpressionError
from contin.model.expression import postorder
from contin.model.parser import parse
from contin.store.results import export_results, read_results, save_branches
from tests.faults.command import Answer, contin_command

SHORT, LONG = 20, 5000
NASTY = [
    None, True, False, 0, -1, 1, 2, 3, 10**9, 10**18, 10**320, -(10**400), 0.5, 1e308, -1e-308, 5e-324, "", " ", "x",
    "a", "b", "q", "t", "1/0", "x^x^x", "2^99999", "((", "a" * 3000, "9" * 400, "\x1b[31m", "\x00", "\ud7ff", "../x",
    "/etc/passwd", "l.LP1", "l.LP99", "k.BP1", "all", "low", "nan", ".inf", "lambda", "__import__('os')", "{x}", "%s",
    [], {}, [[]], [{}], [1], [0, 1], [1, 0], [0, 1, 2], ["x", "x"], {"x": 1}, {"q": 0}, {"": 1}, {"x": {"x": {}}},
    [None], {"parameters": {}}, {"average": {}}, ["average"], {"low": {"x": 1}}, list(range(200)),
]  # fmt: skip
KEYS = [
    "x",
    "a",
    "value",
    "range",
    "name",
    "from",
    "start",
    "settings",
    "period",
    "contin",
    "",
    "\x07",
    "kind",
    "index",
]
MODEL = {
    "contin": 1, "name": "m", "title": "t", "states": {"x": {"value": 1, "unit": "V"}, "y": 0},
    "parameters": {"a": {"value": 1, "range": [-1, 2]}, "b": 0}, "functions": {"g(u)": "u^2"},
    "definitions": {"d": "g(x)"}, "equations": {"x": "a - d + b*y", "y": "-y"}, "observables": {"o": "x + y"},
    "symmetries": {"s": {"x": "x"}}, "starts": {"low": {"x": -1, "parameters": {"b": 0}}},
    "expect": [{"label": "LP", "at": {"a": 0}, "tolerance": 1e-8, "run": {"parameter": "a", "range": [-1, 2]}}],
}  # fmt: skip
RUN = {
    "contin": 1, "model": {**MODEL, "symmetries": {}}, "title": "t", "transform": ["linearise"], "parameters": {"b": 0},
    "diagram": {
        "parameter": "a", "range": [-1, 2], "start": ["low"], "values": {"x": [1]},
        "settings": {"step": 0.1, "steps": 9}, "budget": {"branches": 2},
    },
    "continuations": [
        {"name": "l", "start": {"x": 1}, "parameter": "a", "range": [-1, 2], "settings": {"points": 4}},
        {"name": "k", "from": "l.LP1", "parameter": ["a", "b"], "range": {"a": [-1, 2], "b": [0, 1]}},
    ],
    "simulate": [{"time": 1, "samples": 9, "x": "t", "y": "x", "csv": "s.csv"}],
    "sweep": {"parameter": "a", "range": [0, 1], "steps": 2, "measures": {"z": "x"}, "settle": {"window": 1}},
    "outputs": {"plot": "p.png", "json": "j.json", "x": "a", "y": ["x"]},
}  # fmt: skip
SCAN = {
    "contin": 1, "model": MODEL, "parameters": {"b": 0}, "outputs": {"save": "s.scan"},
    "scan": {
        "axes": {"a": {"from": 0, "to": 1, "points": 2}, "y": [0, 1]}, "starts": {"one": {"x": 1}},
        "measures": {"z": "x"}, "classes": {"up": "z_max > 0"}, "settle": {"window": 1},
    },
}  # fmt: skip


def places(document, path=()):
    """Paths of everything in a document."""
    yield path
    if isinstance(document, dict | list):
        for key, value in document.items() if isinstance(document, dict) else enumerate(document):
            yield from places(value, (*path, key))


@st.composite
def damaged(draw, document):
    """The document with one to three places replaced, removed, repeated, or with a new key."""
    result = copy.deepcopy(document)
    for _ in range(draw(st.integers(1, 3))):
        path = draw(st.sampled_from([p for p in places(result) if p] or [()]))
        if not path:
            break
        parent = result
        for key in path[:-1]:
            parent = parent[key]
        action = draw(st.sampled_from(["replace", "replace", "remove", "add"]))
        value = copy.deepcopy(draw(st.sampled_from(NASTY)))
        if action == "remove":
            del parent[path[-1]]
        elif action == "add" and isinstance(parent, dict):
            parent[draw(st.sampled_from(KEYS))] = value
        else:
            parent[path[-1]] = value
    return result


def checked(folder: Path, document, *command: str) -> Answer:
    """What the command says of a document: a result, or one message of bounded length that begins with the file."""
    file = folder / "f.yaml"
    file.write_text(json.dumps(document), encoding="utf-8")
    before = set(folder.iterdir())
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        answer = contin_command(*(command or ("check",)), file)
    said = answer.out + answer.err
    assert "Traceback" not in said
    assert len(said) < 40_000
    assert not any(c in said for c in "\x1b\x07\x00")
    assert answer.code == 0 or answer.err.strip(), answer
    assert set(folder.iterdir()) == before
    return answer


def sized(strategy):
    """A test of SHORT examples, and the same with LONG ones under the mark `long`."""

    def wrap(body):
        quiet = {"deadline": None, "suppress_health_check": list(HealthCheck)}

        @pytest.mark.parametrize("examples", [SHORT, pytest.param(LONG, marks=pytest.mark.long)])
        def test(examples, tmp_path_factory):
            folder = tmp_path_factory.mktemp("fuzz")

            @settings(max_examples=examples, **quiet)
            @given(strategy)
            def run(case):
                body(case, folder)

            run()

        test.__doc__ = body.__doc__
        return test

    return wrap


@sized(damaged(MODEL))
def test_damaged_models_load_or_are_refused(case, folder):
    checked(folder, case)


@sized(damaged(RUN))
def test_damaged_run_files_are_plans_or_are_refused(case, folder):
    checked(folder, case)


@sized(damaged(SCAN))
def test_damaged_scan_files_are_plans_or_are_refused(case, folder):
    checked(folder, case)


OPERANDS = st.sampled_from("x y 1 2.5 1e300 pi sin(x) (x+y) 0 a_b é ² ( ) if else not".split())
TOKENS = st.one_of(
    OPERANDS, st.sampled_from("+ - * / ^ ** < == and or , ( ) if else if x>0 [ ' \x00 sin( min( max(".split(" "))
)


@sized(st.lists(TOKENS, max_size=80).map(" ".join))
def test_formulas_grown_towards_large_graphs_parse_or_are_refused(text, folder):
    """Guided by the size of what the parser builds: hypothesis keeps to the texts that reach furthest."""
    try:
        size, position = len(postorder([parse(text, ["x", "y", "a_b"])])), len(text)
    except ExpressionError as error:
        size, position = 0, error.position
    assert 0 <= position <= len(text)
    target(float(size), label="nodes")
    target(float(position), label="characters understood")


@pytest.fixture(scope="session")
def good_results(tmp_path_factory):
    """A result in both formats, of a fold with a curve of folds and an orbit-free orbit column."""
    folder = tmp_path_factory.mktemp("good")
    model = contin.Model("m", states={"x": 1}, parameters={"a": 1, "b": 0}, equations={"x": "a - x^2 + b"})
    line = contin.continuation(contin.equilibrium(model), "a", (-1, 2), name="l", settings={"max_step": 0.2})
    fold = contin.continuation(line["LP1"].locus(), ("a", "b"), {"a": (-1, 2), "b": (-1, 1)}, name="k")
    for ending in ("json", "contin"):
        save_branches([line, fold], folder / f"r.{ending}")
    return folder


def read_or_refused(file: Path, folder: Path) -> None:
    """A damaged result is refused in words, or whatever is read can be exported and listed."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            document = read_results(file)
            export_results(document, folder / "out.csv")
            export_results(document, folder / "out.json")
        except ContinError:
            return


@pytest.mark.parametrize("examples", [SHORT, pytest.param(LONG, marks=pytest.mark.long)])
def test_damaged_json_results_are_refused_or_read(examples, good_results, tmp_path):
    document = json.loads((good_results / "r.json").read_text())
    for branch in document["branches"]:
        branch["columns"] = {name: column[:4] for name, column in branch["columns"].items()}
        branch["points"] = [{**point, "index": 1} for point in branch["points"]]

    @settings(max_examples=examples, deadline=None, suppress_health_check=list(HealthCheck))
    @given(damaged(document))
    def run(case):
        file = tmp_path / "r.json"
        file.write_text(json.dumps(case))
        read_or_refused(file, tmp_path)

    run()


@pytest.mark.parametrize("examples", [SHORT, pytest.param(LONG, marks=pytest.mark.long)])
def test_damaged_stores_are_refused_or_read(examples, good_results, tmp_path):
    raw = (good_results / "r.contin").read_bytes()
    cells = [("meta", "value"), ("branch", "header"), ("branch", "name"), ("series", "data"), ("series", "kind"),
             ("series", "name"), ("series", "position")]  # fmt: skip

    @settings(max_examples=examples, deadline=None, suppress_health_check=list(HealthCheck))
    @given(st.data())
    def run(data):
        file = tmp_path / "r.contin"
        if data.draw(st.booleans()):
            place, bit = data.draw(st.integers(0, len(raw) - 1)), data.draw(st.integers(0, 7))
            cut = data.draw(st.sampled_from([len(raw), len(raw), len(raw) // 2, 100, 0]))
            file.write_bytes((raw[:place] + bytes([raw[place] ^ (1 << bit)]) + raw[place + 1 :])[:cut])
        else:
            file.write_bytes(raw)
            table, column = data.draw(st.sampled_from(cells))
            value = data.draw(
                st.sampled_from([None, 0, -1, "", "{}", "[]", "null", "x", b"", b"\x00" * 7, 1e308, "9" * 5000])
            )
            with closing(sqlite3.connect(file)) as connection, connection:
                try:
                    connection.execute(f"UPDATE {table} SET {column} = ? WHERE rowid = 1", (value,))
                except sqlite3.Error:
                    return
        read_or_refused(file, tmp_path)

    run()


WORDS = st.sampled_from(
    ["run", "check", "plot", "export", "diagram", "phase", "simulate", "sweep", "scan", "show", "derive", "models",
     "new", "schema", "--json", "-", "--set", "a=1", "a=nan", "a=1e999", "q=1", "=", "--start", "low", "--samples",
     "0", "-1", "1e9", "--time", "nan", "--resume", "--orbits", "-q", "--help", "--version", "f.yaml", "absent.yaml",
     "m.json", ".", "..", "", "\x1b[31m", "--x", "x", "--y", "q", "--out", "o.png", "o.txt", "a", "b", "inf",
     "--threads", "--method", "Radau", "classics/brusselator", "no/such", "--orbit", "l.LP1", "--over", "--form",
     "polar", "--latex"]
)  # fmt: skip


@sized(st.lists(WORDS, max_size=6).filter(lambda words: "run" not in words[:1] or len(words) > 2))
def test_any_command_line_ends_with_a_result_or_a_message(words, folder):
    import os

    (folder / "f.yaml").write_text(json.dumps({**MODEL, "expect": []}))
    (folder / "m.json").write_text(json.dumps(MODEL))
    here = Path.cwd()
    os.chdir(folder)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            answer = contin_command(*words)
    finally:
        os.chdir(here)
    assert "Traceback" not in answer.out + answer.err


def test_the_documents_themselves_are_good(tmp_path):
    for document in (MODEL, {**RUN, "transform": []}, SCAN):
        assert checked(tmp_path, document).code == 0
