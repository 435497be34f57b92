"""Conserved totals in run files: names, starts, columns and what the report says."""

from __future__ import annotations

import json

import pytest

from tests.cli.calls import call

RUN = """contin: 1
model:
  name: switch
  states: {X: 0.7, XP: 0.3}
  parameters: {k1: 1, k2: 0.9}
  equations: {X: -k1*X/(0.1+X) + k2*XP/(0.1+XP), XP: k1*X/(0.1+X) - k2*XP/(0.1+XP)}
parameters: {total_X: 2}
continuations:
  - {name: line, start: {X: 1, XP: 0.5}, parameter: k1, range: [0.1, 3], values: {X: [1]}}
  - {name: total, start: {XP: 0.5}, parameter: total_X, range: [0.1, 3]}
simulate:
  - {time: 1, samples: 3}
"""


def test_a_run_file_names_totals_and_gives_starts_in_all_states(tmp_path, monkeypatch, capsys):
    (tmp_path / "run.yaml").write_text(RUN)
    monkeypatch.chdir(tmp_path)
    assert call("run", "run.yaml", "--json", "out.json") == 0
    assert "X + XP is conserved" in capsys.readouterr().out.replace("\n", " ")
    document = json.loads((tmp_path / "out.json").read_text())
    assert document["model"]["conserved"] == {"total_X": {"states": ["X", "XP"], "eliminated": "X"}}
    line, total = (b["columns"] for b in document["branches"])
    assert [a + b for a, b in zip(line["X"], line["XP"], strict=True)] == pytest.approx([2.0] * len(line["X"]))
    assert total["total_X"][0] == pytest.approx(0.1)
    assert document["branches"][0]["points"][0]["values"]["X"] == pytest.approx(1.0, abs=1e-8)
    assert document["simulations"][0]["columns"]["X"][0] + document["simulations"][0]["columns"]["XP"][0] == 2.0
    assert sum("is conserved" in note for note in document["notes"]) == 1
