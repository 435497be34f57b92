"""The atlas of a folder: a model that works, one with a conserved total, one that cannot be read."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
SWITCH = """contin: 1
name: switch
states: {X: 0.7, XP: 0.3}
parameters: {k1: 1, k2: 0.9}
equations: {X: -k1*X/(0.1+X) + k2*XP/(0.1+XP), XP: k1*X/(0.1+X) - k2*XP/(0.1+XP)}
"""


def test_a_folder_becomes_a_page_with_a_line_for_each_model(tmp_path):
    folder = tmp_path / "models"
    folder.mkdir()
    (folder / "brusselator.yaml").write_text((ROOT / "models/classics/brusselator.yaml").read_text())
    (folder / "switch.yaml").write_text(SWITCH)
    (folder / "broken.yaml").write_text("contin: 1\nname: <b>broken</b>\nstates: {x: 1}\n")
    out = tmp_path / "atlas.html"
    command = [sys.executable, "examples/atlas.py", str(folder), "--out", str(out), "--processes", "2"]
    subprocess.run(command, check=True, cwd=ROOT, capture_output=True, timeout=300)
    rows = {row["file"]: row for row in json.loads(out.with_suffix(".json").read_text())}
    assert rows["brusselator.yaml"]["bifurcations"] == {"HB": 1}  # B = 1 + A^2 from above; A = 0 is below 0.1
    assert rows["switch.yaml"]["totals"] == ["total_X"]
    assert rows["switch.yaml"]["simulated"] == "done"
    assert (rows["broken.yaml"]["stage"], rows["broken.yaml"]["error"]) == ("load", "InputError")
    page = out.read_text()
    assert "Atlas of 3 models" in page
    assert "<b>" not in page
