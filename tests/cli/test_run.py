"""`contin run`: results, exit codes, where output goes, and which value of a parameter wins."""

import json

import jsonschema
import pytest

import contin
from contin.store.result_schema import RESULT_SCHEMA
from tests.cli.calls import FOLD, PITCHFORK, call, results, run_file

LINE = {"name": "line", "parameter": "p"}


def points(document, branch):
    [found] = [b for b in document["branches"] if b["name"] == branch]
    return {point["label"]: point for point in found["points"]}


def test_a_run_finds_the_fold_and_writes_results_that_follow_the_schema(tmp_path):
    out = tmp_path / "out.json"
    assert call("run", run_file(tmp_path, FOLD, LINE), "--json", out) == 0
    document = results(out)
    jsonschema.validate(document, RESULT_SCHEMA)
    assert abs(points(document, "line")["LP1"]["values"]["p"]) < 1e-12
    [branch] = document["branches"]
    residuals = [p - x**2 for p, x in zip(branch["columns"]["p"], branch["columns"]["x"], strict=True)]
    assert max(map(abs, residuals)) < 1e-9
    assert document["model"]["parameters"] == {"p": 1.0, "q": 1.0}
    assert document["timing"]["total"] > 0


def test_a_later_run_starts_from_a_point_and_its_image_is_not_computed_twice(tmp_path):
    out = tmp_path / "out.json"
    fork = {"name": "fork", "from": "line.BP1", "parameter": "p", "range": [-1, 1]}
    path = run_file(tmp_path, PITCHFORK, {**LINE, "range": [-1, 1]}, fork)
    assert call("run", path, "--json", out) == 0
    branches = {b["name"]: b for b in results(out)["branches"]}
    assert list(branches) == ["line", "fork", "fork~flip"]
    assert branches["fork"]["parent"] == {"branch": "line", "label": "BP1"}
    assert branches["fork"]["ends"][0]["reason"] == "start"
    assert branches["fork~flip"]["image_of"] == {"branch": "fork", "symmetry": "flip"}
    assert branches["fork~flip"]["columns"]["x"] == [-x for x in branches["fork"]["columns"]["x"]]


def test_json_on_standard_output_stands_there_alone(tmp_path, capsys):
    assert call("run", run_file(tmp_path, FOLD, LINE), "--json", "-") == 0
    printed = capsys.readouterr()
    assert json.loads(printed.out)["branches"][0]["name"] == "line"
    assert "LP1" in printed.err


def test_the_report_says_types_numbers_and_ends_in_words(tmp_path, capsys):
    assert call("run", run_file(tmp_path, FOLD, LINE)) == 0
    text = capsys.readouterr().out
    for expected in ("line  equilibria in p", "LP1", "fold", "first row: ", "last row: ", "1 branch, "):
        assert expected in text


def test_quiet_prints_nothing(tmp_path, capsys):
    assert call("run", run_file(tmp_path, FOLD, LINE), "-q") == 0
    printed = capsys.readouterr()
    assert (printed.out, printed.err) == ("", "")


@pytest.mark.parametrize(
    ("reference", "note"),
    [("line.BP1", "has no point BP1 (points: LP1)"), ("line.2.LP1", "there is no branch 'line.2' (branches: line)")],
)
def test_a_start_that_does_not_exist_skips_the_run_and_those_that_need_it(tmp_path, reference, note):
    out = tmp_path / "out.json"
    second = {"name": "second", "from": reference, "parameter": "p"}
    third = {"name": "third", "from": "second.LP1", "parameter": "p"}
    assert call("run", run_file(tmp_path, FOLD, LINE, second, third, dict(LINE, name="last")), "--json", out) == 1
    document = results(out)
    assert [b["name"] for b in document["branches"]] == ["line", "last"]
    assert note in document["notes"][0]
    assert "there is no branch 'second'" in document["notes"][1]


def test_a_start_without_a_solution_is_a_note_and_not_a_crash(tmp_path):
    out = tmp_path / "out.json"
    path = run_file(tmp_path, FOLD, {**LINE, "start": {"x": 1, "parameters": {"p": -0.5}}}, dict(LINE, name="good"))
    assert call("run", path, "--json", out) == 1
    document = results(out)
    assert [b["name"] for b in document["branches"]] == ["good"]
    assert document["notes"][0].startswith("line skipped: no equilibrium found")


def test_a_branch_cut_short_by_its_budget_is_written_with_exit_code_1(tmp_path):
    out = tmp_path / "out.json"
    path = run_file(tmp_path, FOLD, {**LINE, "settings": {"steps": 3}})
    assert call("run", path, "--json", out) == 1
    [branch] = results(out)["branches"]
    assert {end["reason"] for end in branch["ends"]} == {"steps"}
    assert branch["steps"] == 6


def test_values_win_in_the_order_model_start_run_file_command_line(tmp_path):
    def start_value(parameters, *arguments):
        out = tmp_path / "out.json"
        run = {**LINE, "start": "half", "direction": "up"}
        assert call("run", run_file(tmp_path, FOLD, run, parameters=parameters), "--json", out, *arguments) == 0
        return results(out)["branches"][0]["columns"]["p"][0]

    assert start_value({}) == 0.25  # the start's own parameters win over the model's p = 1
    assert start_value({"p": 0.5}) == 0.5
    assert start_value({"p": 0.5}, "--set", "p=0.75") == 0.75
    assert start_value({"p": 0.5}, "--set", "p=q/4 + 0.125") == 0.375


def test_numbers_may_be_formulas_in_the_parameters(tmp_path):
    out = tmp_path / "out.json"
    run = {**LINE, "start": {"x": "sqrt(p/q)"}, "range": ["-q", "2*q"], "values": {"p": ["pi/2"]}}
    assert call("run", run_file(tmp_path, FOLD, run, parameters={"q": "1/2"}), "--json", out) == 0
    document = results(out)
    assert document["model"]["parameters"]["q"] == 0.5
    assert max(document["branches"][0]["columns"]["p"]) == 1.0
    assert points(document, "line")["LP1"]["values"]["p"] == pytest.approx(0, abs=1e-12)


def test_runs_without_a_name_are_numbered_by_their_place(tmp_path):
    out = tmp_path / "out.json"
    unnamed = {"parameter": "p"}
    path = run_file(tmp_path, FOLD, unnamed, dict(LINE), {"from": "run1.LP1", "parameter": "p"}, unnamed)
    assert call("run", path, "--json", out) == 1  # a fold has no other branch
    document = results(out)
    assert [b["name"] for b in document["branches"]] == ["run1", "line", "run4"]
    assert document["notes"][0].startswith("run3 skipped: run1.LP1")


def test_a_user_value_starts_a_run_in_another_parameter(tmp_path):
    out = tmp_path / "out.json"
    first = {**LINE, "values": {"p": [0.5]}}
    second = {"name": "other", "from": "line.UZ1", "parameter": "q", "range": [0.5, 2]}
    third = {"name": "fold", "from": "line.LP1", "as": "equilibrium", "parameter": "p"}
    assert call("run", run_file(tmp_path, FOLD, first, second, third), "--json", out) == 0
    _, other, fold = results(out)["branches"]
    assert other["parameters"] == ["q"]
    q, x = other["columns"]["q"], other["columns"]["x"]
    assert max(abs(0.5 - b * a**2) for a, b in zip(x, q, strict=True)) < 1e-9
    assert [min(q), max(q)] == [0.5, 2.0]
    assert [point["type"] for point in fold["points"]] == ["LP"]


def test_models_are_found_beside_the_run_file_and_by_bundled_name(tmp_path, monkeypatch):
    (tmp_path / "models").mkdir()
    (tmp_path / "models" / "m.yaml").write_text(json.dumps(FOLD))
    monkeypatch.chdir("/")
    path = run_file(tmp_path, "models/m.yaml", LINE)
    assert call("run", path, "-q") == 0
    bundled = run_file(tmp_path, "metronomes/pair-averaged", {"start": "in-phase", "parameter": "mu"}, name="pair.yaml")
    assert call("run", bundled, "-q") == 0


def test_outputs_are_written_beside_the_run_file(tmp_path, monkeypatch):
    (tmp_path / "away").mkdir()
    monkeypatch.chdir(tmp_path / "away")
    outputs = {"plot": "a.png", "html": "sub/a.html", "save": "a.contin", "json": "a.json", "y": "x"}
    assert call("run", run_file(tmp_path, FOLD, LINE, outputs=outputs), "-q") == 0
    written = {path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*") if path.is_file()}
    assert written == {"case.yaml", "a.png", "sub/a.html", "a.contin", "a.json"}


def test_an_output_folder_that_is_missing_is_found_before_computing(tmp_path, capsys):
    assert call("run", run_file(tmp_path, FOLD, LINE), "--json", tmp_path / "absent" / "out.json") == 2
    assert "there is no folder" in capsys.readouterr().err


def test_points_of_codimension_two_state_the_errors_of_both_parameters_and_the_states(tmp_path):
    """x' = p - 0.1 + (q - 0.2) x - x^3 has its cusp at (0.1, 0.2)."""
    model = {
        "contin": 1, "name": "cusp", "states": {"x": 1.0}, "parameters": {"p": 0.1, "q": 1.2},
        "equations": {"x": "p - 0.1 + (q - 0.2)*x - x^3"},
    }  # fmt: skip
    line = {"name": "line", "parameter": "p", "range": [-1, 1]}
    folds = {"name": "folds", "from": "line.LP1", "parameter": ["p", "q"], "range": {"p": [-1, 1], "q": [-1, 2]}}
    out, saved = tmp_path / "out.json", tmp_path / "case.contin"
    assert call("run", run_file(tmp_path, model, line, folds, outputs={"save": saved.name}), "--json", out) == 0
    document = results(out)
    jsonschema.validate(document, RESULT_SCHEMA)
    on_line = points(document, "line")
    assert set(on_line) == {"LP1", "LP2"}
    assert all("errors" not in point for point in on_line.values())
    cusp = points(document, "folds")["CP1"]
    assert set(cusp["errors"]) == {"p", "q", "x"}
    assert cusp["errors"]["p"] == cusp["error"]
    for name, exact in (("p", 0.1), ("q", 0.2)):
        assert abs(cusp["values"][name] - exact) <= cusp["errors"][name] < 1e-9
    assert abs(cusp["values"]["x"]) <= cusp["errors"]["x"] < 1e-4
    stored = contin.read(saved)["folds"]["CP1"]
    assert stored.errors == cusp["errors"]
