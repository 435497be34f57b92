"""`contin simulate` and `contin sweep` as they are typed."""

import csv
import json

from tests.cli.calls import call


def rows(path):
    with path.open() as stream:
        return list(csv.DictReader(stream))


def test_a_simulation_writes_table_and_picture(tmp_path, capsys):
    arguments = ("--start", "in-phase", "--state", "x2=1.2", "--time", "30", "--samples", "61")
    files = ("--csv", tmp_path / "t.csv", "--plot", tmp_path / "t.png")
    assert call("simulate", "metronomes/pair", *arguments, *files) == 0
    table = rows(tmp_path / "t.csv")
    assert len(table) == 61
    assert float(table[0]["x2"]) == 1.2
    assert float(table[-1]["t"]) == 30.0
    assert (tmp_path / "t.png").stat().st_size > 10_000
    assert "DOP853" in capsys.readouterr().out


def test_json_on_standard_output_stands_there_alone(capsys):
    assert call("simulate", "classics/logistic", "--time", "5", "--json", "-") == 0
    document = json.loads(capsys.readouterr().out)
    assert document["columns"]["t"] == [0, 1, 2, 3, 4, 5]


def test_a_solution_that_leaves_the_box_ends_with_code_1(tmp_path, capsys):
    model = tmp_path / "grow.yaml"
    model.write_text("contin: 1\nname: grow\nstates: {x: 1}\nparameters: {a: 1}\nequations: {x: a*x}\n")
    assert call("simulate", model, "--box", "100") == 1
    assert "left the box" in capsys.readouterr().out


def test_an_unknown_state_is_bad_input(capsys):
    assert call("simulate", "metronomes/pair", "--state", "z=1") == 2
    assert "z" in capsys.readouterr().err


def test_a_sweep_reports_its_jump(tmp_path, capsys):
    model = tmp_path / "cusp.yaml"
    model.write_text("contin: 1\nname: cusp\nstates: {x: -2}\nparameters: {p: 0}\nequations: {x: p + 3*x - x^3}\n")
    code = call("sweep", model, "p", "-3.05", "3.05", "--steps", "61", "--window", "20", "--longest", "4000",
                "--csv", tmp_path / "s.csv", "--plot", tmp_path / "s.png")  # fmt: skip
    assert code in (0, 1)
    assert "x jumps on the way up between p = 1.95 and 2.05" in capsys.readouterr().out
    assert len(rows(tmp_path / "s.csv")) == 124
    assert (tmp_path / "s.png").stat().st_size > 10_000
