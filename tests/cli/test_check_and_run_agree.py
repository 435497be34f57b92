"""`contin check` refuses a run file exactly where `contin run` does."""

import pytest

from tests.cli.calls import FOLD, call, run_file

RUN = {"name": "a", "parameter": "p", "range": [0.5, 1.5], "settings": {"steps": 3}}
CASES = [
    {}, {"range": [3, 4]}, {"parameter": "zz"}, {"start": "nobody"}, {"start": {"x": "log(-1)"}}, {"from": "b.LP1"},
    {"settings": {"min_step": 1, "max_step": 0.1}}, {"settings": {"max_step": -1}}, {"range": [1, 1]}, {"free": ["q"]},
    {"conditions": ["x = 1"]}, {"conditions": ["zz = 1"], "free": ["q"]}, {"extrema": ["zz"]}, {"samples": "no.csv"},
    {"as": "connection"}, {"parameter": ["p", "q"]}, {"values": {"zz": [1]}}, {"range": {"q": [0, 1]}},
]  # fmt: skip


@pytest.mark.parametrize("change", CASES, ids=str)
def test_check_and_run_refuse_the_same_files(change, tmp_path):
    path = run_file(tmp_path, FOLD, {**RUN, **change})
    assert (call("check", path) == 2) == (call("run", path, "-q") == 2)
