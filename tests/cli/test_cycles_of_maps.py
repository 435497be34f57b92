"""Runs that start on a cycle of a map: `as: orbit` iterates, and follows the cycle that is reached."""

from __future__ import annotations

import math

import pytest

from tests.cli.calls import call, results, run_file

LOGISTIC = {
    "contin": 1, "name": "logistic", "kind": "map", "states": {"x": 0.5}, "parameters": {"r": 3.84},
    "equations": {"x": "r*x*(1 - x)"},
}  # fmt: skip


def test_the_cycle_of_three_of_the_logistic_map_is_born_at_its_fold(tmp_path):
    """1 + sqrt 8, and the sum of the three iterates at the fold is (3 + 1/r)/2."""
    run = {"name": "three", "start": {"x": 0.3}, "as": "orbit", "parameter": "r", "range": [3.7, 4]}
    out = tmp_path / "out.json"
    assert call("run", str(run_file(tmp_path, LOGISTIC, run)), "--json", str(out), "--quiet") == 0
    (branch,) = results(out)["branches"]
    (fold,) = [point["values"] for point in branch["points"] if point["type"] == "LP"]
    assert fold["r"] == pytest.approx(1.0 + math.sqrt(8.0), rel=1e-10)
    total = sum(fold[f"x.{k}"] for k in (1, 2, 3))
    assert total == pytest.approx(0.5 * (3.0 + 1.0 / fold["r"]), rel=1e-6)
