"""Manifolds in a run file."""

import pytest

from tests.cli.calls import call, results, run_file

SADDLE = {
    "contin": 1, "name": "saddle", "states": {"x": 0.0, "y": 0.0}, "parameters": {"a": 1.0},
    "equations": {"x": "x", "y": "-y + a*x^2"}, "starts": {"rest": {"x": 0}},
}  # fmt: skip
LINE = {"name": "line", "start": "rest", "parameter": "a", "range": [0.5, 4], "values": {"a": [3]}}
CURVE = {"name": "wu", "as": "manifold", "of": "line.UZ1", "length": 1}


def test_a_run_grows_manifolds_of_a_start_and_of_a_label(tmp_path):
    """y = a x^2/3."""
    stable = {"name": "ws", "as": "manifold", "of": {"x": 0}, "side": "stable", "length": 2}
    outputs = {"json": "out.json", "plot": "out.png", "save": "out.contin"}
    path = run_file(tmp_path, SADDLE, continuations=[LINE, CURVE, stable], outputs=outputs)
    assert call("run", path, "--quiet") == 0
    _, unstable, other = results(tmp_path / "out.json")["branches"]
    assert (unstable["kind"], unstable["parameters"], unstable["locus"]) == ("manifold", [], None)
    assert unstable["columns"]["y"] == pytest.approx([x * x for x in unstable["columns"]["x"]], abs=1e-8)
    assert [other["columns"]["y"][0], other["columns"]["y"][-1]] == pytest.approx([-2, 2])
    assert (tmp_path / "out.png").stat().st_size > 1000
    assert call("export", tmp_path / "out.contin", tmp_path / "again.json") == 0


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"length": None}, "give `of`"), ({"of": "nothing.UZ1"}, "no run 'nothing'"), ({"parameter": "a"}, "leave out"),
        ({"as": "orbit"}, "as: manifold"), ({"of": "nowhere"}, "no start 'nowhere'"),
    ],
)  # fmt: skip
def test_mistakes_are_named(tmp_path, capsys, change, message):
    entry = {key: value for key, value in (CURVE | change).items() if value is not None}
    assert call("run", run_file(tmp_path, SADDLE, continuations=[LINE, entry])) == 2
    assert message in capsys.readouterr().err


def test_a_run_without_a_parameter_is_refused(tmp_path, capsys):
    entry = {key: value for key, value in LINE.items() if key != "parameter"}
    assert call("run", run_file(tmp_path, SADDLE, continuations=[entry])) == 2
    assert "needs `parameter`" in capsys.readouterr().err


def test_a_manifold_that_is_none_is_skipped(tmp_path, capsys):
    node = SADDLE | {"equations": {"x": "-x", "y": "-y + a*x^2"}}
    path = run_file(tmp_path, node, continuations=[LINE, CURVE], outputs={"json": "out.json"})
    assert call("run", path) == 1
    assert "wu skipped: manifold: there is no unstable direction" in capsys.readouterr().out


def test_a_run_grows_the_tangle_of_a_forced_flow(tmp_path):
    """Duffing's double well at rest: the energy y^2/2 - x^2/2 + x^4/4 is 0 on the curve, a is small."""
    forced = {
        "contin": 1, "name": "duffing", "states": {"x": 0.0, "y": 0.0}, "parameters": {"a": 0.0},
        "forcing": {"period": "2*pi"}, "equations": {"x": "y", "y": "x - x^3 + a*cos(t)"}, "starts": {"rest": {"x": 0}},
    }  # fmt: skip
    line = {"name": "line", "as": "orbit", "start": "rest", "parameter": "a", "range": [0, 1e-3]}
    line |= {"values": {"a": [1e-6]}}
    curve = {"name": "wu", "as": "manifold", "of": "line.UZ1", "length": 2}
    outputs = {"json": "out.json", "plot": "out.png", "save": "out.contin"}
    path = run_file(tmp_path, forced, continuations=[line, curve], outputs=outputs)
    assert call("run", path, "--quiet") == 0
    _, unstable = results(tmp_path / "out.json")["branches"]
    assert sorted(unstable["columns"]) == ["orbit", "s", "x", "y"]
    x, y = unstable["columns"]["x"], unstable["columns"]["y"]
    energy = [v * v / 2 - u * u / 2 + u**4 / 4 for u, v in zip(x, y, strict=True)]
    assert energy == pytest.approx([0] * len(x), abs=1e-5)
    assert max(x) > 1
    assert call("export", tmp_path / "out.contin", tmp_path / "again.json") == 0
