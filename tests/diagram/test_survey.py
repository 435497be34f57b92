"""Surveys: the first bifurcation each way in every parameter, against closed forms."""

from __future__ import annotations

import csv
import json

import numpy as np
import pytest

import contin
from contin.errors import InputError
from tests.cli.calls import call
from tests.problems.follow import model


def rows_of(found):
    return {(row.attractor, row.parameter): row for row in found.rows}


def test_the_brusselator_loses_its_rest_at_b_equal_to_one_plus_a_squared():
    """B = 1.5: HB at B = 1 + A^2 = 2 above, in A at sqrt(B - 1) below."""
    found = contin.survey(contin.load("brusselator"), {"B": 1.5, "A": 1.0}, processes=1)
    rows = rows_of(found)
    assert (rows["rest", "B"].above.type, rows["rest", "B"].above.at) == ("HB", pytest.approx(2.0, rel=1e-9))
    assert (rows["rest", "A"].below.type, rows["rest", "A"].below.at) == ("HB", pytest.approx(np.sqrt(0.5), rel=1e-9))
    assert (rows["rest", "A"].above.type, rows["rest", "A"].above.at) == ("", pytest.approx(10.0))
    assert found.rows[0].parameter == "B"  # 2/1.5 is nearer than sqrt(2)
    assert rows["rest", "B"].above.detail == "supercritical"


def test_each_attractor_of_a_bistable_system_has_its_own_fold():
    """x' = p + q x - x^3 has folds at p = -+ 2 (q/3)^1.5, the upper state's below and the lower one's above 0."""
    bistable = contin.Model(
        "two", states={"x": 1.0}, parameters={"p": 0.1, "q": 3.0}, equations={"x": "p + q*x - x^3"},
        starts={"low": {"x": -2}, "high": {"x": 2}},
    )  # fmt: skip
    rows = rows_of(contin.survey(bistable, processes=1, factor=50.0))
    assert {name for name, _ in rows} == {"rest1", "rest2"}
    above = {name: row.above for (name, p), row in rows.items() if p == "p"}
    assert sorted(side.type for side in above.values()) == ["", "LP"]
    assert next(side.at for side in above.values() if side.type) == pytest.approx(2.0, rel=1e-9)
    below = [row.below for (_, p), row in rows.items() if p == "q" and row.below.type]
    assert [side.at for side in below] == [pytest.approx(3 * (0.1 / 2) ** (2 / 3), rel=1e-8)]


def test_a_cycle_is_followed_to_where_it_is_born():
    """Radius sqrt(mu) around rest: born at mu = 0.2 d."""
    cycle = model(
        {"x": "(mu - d)*x - y - x*(x^2 + y^2)", "y": "x + (mu - d)*y - y*(x^2 + y^2)"}, {"x": 0.5, "y": 0.0},
        {"mu": 1.0, "d": 0.3},
    )  # fmt: skip
    rows = rows_of(contin.survey(cycle, processes=1))
    assert (rows["cycle", "mu"].below.type, rows["cycle", "mu"].below.at) == ("HB", pytest.approx(0.3, rel=1e-6))
    assert (rows["cycle", "d"].above.type, rows["cycle", "d"].above.at) == ("HB", pytest.approx(1.0, rel=1e-6))


def test_totals_are_surveyed_like_parameters_and_processes_change_nothing():
    switch = contin.Model(
        "switch", states={"X": 0.7, "XP": 0.3}, parameters={"k1": -1.0, "k2": 0.9, "unused": 2.0, "zero": 0.0},
        equations={"X": "k1*X/(0.1+X) + k2*XP/(0.1+XP) + zero", "XP": "-k1*X/(0.1+X) - k2*XP/(0.1+XP) - zero"},
    )  # fmt: skip
    alone, shared = (contin.survey(switch, processes=count) for count in (1, 2))
    assert alone.columns == shared.columns
    assert set(alone.columns["parameter"]) == {"k1", "k2", "total_X"}
    assert alone.columns["above"][alone.columns["parameter"].index("k1")] == pytest.approx(-10.0)
    assert any("unused: the equations do not depend on it" in note for note in alone.notes)
    assert any("zero is 0" in note for note in alone.notes)
    assert any("X + XP is conserved" in note for note in alone.notes)


def test_what_is_asked_wrongly_is_refused_with_the_names_that_there_are():
    with pytest.raises(InputError, match="no parameter 'C'"):
        contin.survey(contin.load("brusselator"), names=["C"])
    with pytest.raises(InputError, match="factor must be above 1"):
        contin.survey(contin.load("brusselator"), factor=1.0)


def test_the_command_writes_table_picture_and_json(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    arguments = ["--csv", "s.csv", "--json", "s.json", "--plot", "s.svg", "--set", "B=1.5", "--processes", "1"]
    assert call("survey", "brusselator", *arguments) == 0
    assert "HB at 2 (supercritical)" in capsys.readouterr().out
    with (tmp_path / "s.csv").open() as stream:
        table = list(csv.DictReader(stream))
    document = json.loads((tmp_path / "s.json").read_text())
    assert [row["parameter"] for row in table] == document["survey"]["parameter"] == ["B", "A"]
    assert float(table[0]["above"]) == pytest.approx(2.0, rel=1e-9)
    assert "parameter / its value" in (tmp_path / "s.svg").read_text() or (tmp_path / "s.svg").stat().st_size > 5000


def test_an_equilibrium_of_a_line_is_named_once_and_not_followed():
    line = model({"x": "a*sin(y - x)", "y": "2*a*sin(x - y)*cos(x - y)"}, {"x": 0.1, "y": 0.1}, {"a": 1.0})
    found = contin.survey(line, processes=1)
    assert found.rows == ()
    (note,) = found.notes
    assert "x, y are shifted together" in note
    assert len(found.plot().axes) == 1
