"""`contin lyapunov`, and `exponents:` of a simulation in a run file."""

import json

import numpy as np

import contin
from tests.cli.calls import call

LOGISTIC = "contin: 1\nname: map\nkind: map\nstates: {x: 0.1}\nparameters: {a: 4}\nequations: {x: a*x*(1 - x)}\n"


def test_one_trajectory_is_told_with_errors(tmp_path, capsys):
    (tmp_path / "map.yaml").write_text(LOGISTIC)
    assert call("lyapunov", tmp_path / "map.yaml", "--time", "4000") == 0
    told = capsys.readouterr().out
    assert "0.69" in told
    assert "signs +" in told


def test_exponents_along_a_parameter_are_drawn_written_and_read_back(tmp_path):
    (tmp_path / "map.yaml").write_text(LOGISTIC)
    files = ["--plot", tmp_path / "e.png", "--csv", tmp_path / "e.csv", "--json", tmp_path / "e.json"]
    assert call("lyapunov", tmp_path / "map.yaml", "a", "2.5", "4.5", "--points", "5", "--time", "500", *files) == 1
    found = contin.read(tmp_path / "e.json")
    assert found.signs[:4] == ["-", "-", "-", "+"]
    assert found.signs[4] == "?"  # at 4.5 iterates leave every bound
    assert "left all bounds" in found.outcomes[4]
    assert abs(found.exponents[0, 0] - np.log(0.5)) < 1e-6
    assert (tmp_path / "e.png").stat().st_size > 10_000
    assert (tmp_path / "e.csv").read_text().startswith("a,exponent.1,error.1,dimension,time,outcome")
    found.plot()


def test_a_run_file_asks_for_those_of_its_simulation(tmp_path, capsys):
    (tmp_path / "map.yaml").write_text(LOGISTIC)
    run = tmp_path / "run.yaml"
    run.write_text(
        "contin: 1\nmodel: map.yaml\nsimulate: [{name: chaos, time: 4000, transient: 100, exponents: 1}]\n"
        "outputs: {json: run.json}\n"
    )
    assert call("run", run) == 0
    assert "Lyapunov exponents 0.69" in capsys.readouterr().out
    found = json.loads((tmp_path / "run.json").read_text())["simulations"][0]["lyapunov"]
    assert abs(found["exponents"][0] - np.log(2.0)) < 1.5 * found["errors"][0] < 0.02
    assert found["dimension"] == 1.0


def test_what_is_missing_is_said(tmp_path, capsys):
    (tmp_path / "map.yaml").write_text(LOGISTIC)
    assert call("lyapunov", tmp_path / "map.yaml", "a") == 2
    assert "two different numbers" in capsys.readouterr().err
    assert call("lyapunov", tmp_path / "map.yaml", "b", "1", "2") == 2
    assert "no parameter 'b'" in capsys.readouterr().err
    assert call("lyapunov", tmp_path / "map.yaml", "--plot", tmp_path / "e.png") == 2
    assert "over a parameter" in capsys.readouterr().err
