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
        ({"parameter": ["c"], "to": None}, "two parameters"),
        ({"parameter": ["c"], "range": {"c": [-1, 1]}}, "name two parameters"),
        ({"truncation": 2.0}, "truncation"),
        ({"samples": "nothing.csv"}, "nothing.csv"),
        ({"to": "nowhere"}, "no start 'nowhere'"),
        ({"to": "cycle.UZ1"}, "there is no run 'cycle'"),
        ({"reversor": {"u": "-u"}, "as": None, "to": None, "parameter": "c"}, "write `as: connection`"),
    ],
)
def test_mistakes_are_named(tmp_path, capsys, change, message):
    entry = {key: value for key, value in (FRONT | change).items() if value is not None}
    assert call("run", run_file(tmp_path, NAGUMO, continuations=[entry])) == 2
    assert message in capsys.readouterr().err


def test_a_front_far_from_its_speed_is_found_by_homotopy(tmp_path):
    path = run_file(tmp_path, NAGUMO, parameters={"c": -0.9}, continuations=[FRONT], outputs={"json": "out.json"})
    assert call("run", path, "--quiet") == 0
    (branch,) = results(tmp_path / "out.json")["branches"]
    c = [(1 - 2 * a) / math.sqrt(2) for a in branch["columns"]["a"]]
    assert branch["columns"]["c"] == pytest.approx(c, abs=1e-7)


def test_what_is_not_found_is_skipped_in_words_and_other_runs_go_on(tmp_path, capsys):
    """Where c does nothing, no front from u = 1 to u = 0 exists at a = 1/4: the bistable front has one speed."""
    fixed = NAGUMO | {"equations": {"u": "v", "v": "-0.9*v - u*(1 - u)*(u - a/(1 + c^2)/100)"}}
    line = {"name": "line", "start": "ahead", "parameter": "a", "range": [0.1, 0.4]}
    path = run_file(tmp_path, fixed, continuations=[FRONT, line], outputs={"json": "out.json"})
    assert call("run", path) == 1
    assert "front skipped: no connecting orbit" in capsys.readouterr().out
    assert [branch["name"] for branch in results(tmp_path / "out.json")["branches"]] == ["line"]


def test_a_loop_from_samples_and_from_a_long_orbit(tmp_path):
    """x'' = x - k x^3 + m y: homoclinic for m = 0; x = sqrt(2/k)/cosh(t)."""
    model = {
        "contin": 1, "name": "duffing", "states": {"x": 0.0, "y": 0.0}, "parameters": {"m": 0.0, "k": 1.0},
        "equations": {"x": "y", "y": "x - k*x^3 + m*y"},
    }  # fmt: skip
    rows = [(t, math.sqrt(2) / math.cosh(t), -math.sqrt(2) * math.sinh(t) / math.cosh(t) ** 2) for t in range(-6, 7)]
    (tmp_path / "loop.csv").write_text("t,x,y\n" + "\n".join(",".join(map(str, row)) for row in rows))
    entry = {
        "name": "loop", "as": "connection", "start": {"x": 0}, "samples": "loop.csv", "parameter": ["m", "k"],
        "range": {"m": [-1, 1], "k": [0.5, 2]}, "truncation": 1e-4,
    }  # fmt: skip
    path = run_file(tmp_path, model, continuations=[entry], outputs={"json": "out.json"})
    assert call("run", path, "--quiet") == 0
    (branch,) = results(tmp_path / "out.json")["branches"]
    assert branch["columns"]["m"] == pytest.approx([0] * len(branch["columns"]["m"]), abs=1e-9)
    amplitudes = [math.sqrt(2 / k) for k in branch["columns"]["k"]]
    assert branch["columns"]["x.max"] == pytest.approx(amplitudes, abs=1e-6)


def test_fronts_that_persist_are_followed_in_one_parameter(tmp_path):
    """Fisher's equation: fronts from u = 1 to u = 0 at every speed; u = (1 + exp(s/sqrt(6)))^-2 at c = 5/sqrt(6).

    Its steepest slope is -(8/27)/sqrt(6).
    """
    fisher = NAGUMO | {"name": "fisher", "parameters": {"c": 2.5}, "equations": {"u": "v", "v": "-c*v - u*(1 - u)"}}
    entry = {
        "name": "front", "as": "connection", "start": "behind", "to": "ahead", "parameter": "c", "range": [1, 4],
        "values": {"c": [5 / math.sqrt(6)]},
    }  # fmt: skip
    path = run_file(tmp_path, fisher, continuations=[entry], outputs={"json": "out.json", "plot": "out.png"})
    assert call("run", path, "--quiet") == 0
    (branch,) = results(tmp_path / "out.json")["branches"]
    assert (branch["kind"], branch["locus"], branch["parameters"]) == ("connection", None, ["c"])
    assert [end["reason"] for end in branch["ends"]] == ["bound", "bound"]
    (point,) = branch["points"]
    assert point["values"]["v.min"] == pytest.approx(-8 / 27 / math.sqrt(6), abs=1e-6)


def test_a_run_follows_symmetric_orbits(tmp_path, capsys):
    """u'' = m u - k u^3: u = sqrt(2 m / k) / cosh(sqrt(m) t)."""
    model = {
        "contin": 1, "name": "pulse", "states": {"u": 0.0, "v": 0.0}, "parameters": {"k": 1.0, "m": 1.0},
        "equations": {"u": "v", "v": "m*u - k*u^3"},
    }  # fmt: skip
    entry = {
        "name": "pulse", "as": "connection", "start": {"u": 0}, "reversor": {"v": "-v"}, "parameter": "k",
        "range": {"k": [0.5, 2]}, "values": {"k": [1.5]},
    }  # fmt: skip
    path = run_file(tmp_path, model, continuations=[entry], outputs={"json": "out.json"})
    assert call("run", path, "--quiet", "--orbits") == 0
    (branch,) = results(tmp_path / "out.json")["branches"]
    assert branch["kind"] == "connection"
    columns = branch["columns"]
    largest = [max(-low, high) for low, high in zip(columns["u.min"], columns["u.max"], strict=True)]
    assert largest == pytest.approx([math.sqrt(2 / k) for k in columns["k"]], abs=1e-9)
    orbit = branch["points"][0]["orbit"]
    assert abs(orbit["v"][0] + orbit["v"][-1]) < 1e-12
    assert max(map(abs, orbit["u"])) == pytest.approx(math.sqrt(2 / 1.5), abs=1e-6)
    bad = run_file(tmp_path, model, continuations=[entry | {"reversor": {"u": "v"}}])
    assert call("run", bad) == 2
    assert "reversor" in capsys.readouterr().err
