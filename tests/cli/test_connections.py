"""Connecting orbits in a run file."""

import math

import pytest

from tests.cli.calls import call, results, run_file

NAGUMO = {
    "contin": 1,
    "name": "nagumo",
    "states": {"u": 0.0, "v": 0.0},
    "parameters": {"a": 0.25, "c": 0.35},
    "equations": {"u": "v", "v": "-c*v - u*(1 - u)*(u - a)"},
    "starts": {"behind": {"u": 1}, "ahead": {"u": 0}},
}
FRONT = {
    "name": "front", "as": "connection", "start": "behind", "to": "ahead", "parameter": ["c", "a"],
    "range": {"c": [-1, 1], "a": [0.1, 0.4]},
}  # fmt: skip


def test_a_run_follows_a_front_from_one_saddle_to_another(tmp_path):
    path = run_file(tmp_path, NAGUMO, continuations=[FRONT], outputs={"json": "out.json"})
    assert call("run", path, "--quiet") == 0
    (branch,) = results(tmp_path / "out.json")["branches"]
    assert (branch["locus"], [end["reason"] for end in branch["ends"]]) == ("HOM", ["bound", "bound"])
    for a, c in zip(branch["columns"]["a"], branch["columns"]["c"], strict=True):
        assert c == pytest.approx((1 - 2 * a) / math.sqrt(2), abs=1e-7)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"as": None}, "write `as: connection`"),
        ({"parameter": ["c"]}, "two parameters"),
        ({"to": "nowhere"}, "no start 'nowhere'"),
    ],
)
def test_mistakes_are_named(tmp_path, capsys, change, message):
    entry = {key: value for key, value in (FRONT | change).items() if value is not None}
    assert call("run", run_file(tmp_path, NAGUMO, continuations=[entry])) == 2
    assert message in capsys.readouterr().err


def test_a_front_that_no_trajectory_comes_near_is_skipped_in_words(tmp_path, capsys):
    path = run_file(tmp_path, NAGUMO, parameters={"c": -0.9}, continuations=[FRONT])
    assert call("run", path) == 1
    assert "front skipped: no connecting orbit nearby" in capsys.readouterr().out
