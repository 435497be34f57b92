"""Starts of boundary-value problems in run files."""

from tests.cli.calls import call, results, run_file

MODEL = {
    "contin": 1, "name": "buckling", "kind": "bvp", "time": {"name": "s", "from": 0, "to": 1},
    "states": {"u": 0, "v": 0}, "parameters": {"lam": 0, "b": 0}, "observables": {"left": "integral(u*sin(2*pi*s))"},
    "equations": {"u": "v", "v": "-lam*(u - u^3) - b"}, "conditions": ["u(start) = 0", "u(end) = 0"],
}  # fmt: skip


def test_a_start_may_be_formulas_in_the_independent_variable(tmp_path):
    """The guess sin(2 pi s) leads to the second mode, which branches off at 4 pi^2."""
    start = {"u": "b + 0.5*sin(2*pi*s)", "v": "pi*cos(2*pi*s)", "parameters": {"lam": 50}}
    path = run_file(tmp_path, MODEL, {"start": start, "parameter": "lam", "range": [39, 60], "direction": "up"})
    assert call("run", path, "--json", tmp_path / "r.json") == 0
    (branch,) = results(tmp_path / "r.json")["branches"]
    assert min(abs(value) for value in branch["columns"]["left"]) > 0.1


def test_other_names_are_refused_with_those_there_are(tmp_path, capsys):
    path = run_file(tmp_path, MODEL, {"start": {"u": "sin(t)"}, "parameter": "lam", "range": [0, 60]})
    assert call("run", path) == 2
    error = capsys.readouterr().err
    assert "continuations[0].start.u: unknown name 't'" in error
    assert "Traceback" not in error
