"""The other commands, and what starting the command costs."""

import json
import os
import subprocess
import sys
from pathlib import Path

import jsonschema
import numpy as np
import pytest

from contin._version import __version__
from contin.model.bundled import folder
from contin.model.yaml_reader import read_text
from tests.cli.calls import FOLD, call, results, run_file

HEAVY = {"numpy", "scipy", "sympy", "numba", "llvmlite", "matplotlib", "networkx", "pandas", "pydantic", "ruamel"}


@pytest.mark.parametrize("argument", ["--help", "--version"])
def test_help_and_version_load_no_heavy_library(argument):
    code = (
        "import sys\nfrom contin.cli.main import main\n"
        f"try:\n    main([{argument!r}])\nexcept SystemExit:\n    pass\n"
        "print(*sorted({name.split('.')[0] for name in sys.modules}), file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert HEAVY & set(done.stderr.split()) == set()
    assert ("diagram" if argument == "--help" else __version__) in done.stdout


def test_checking_a_run_file_computes_nothing_and_lists_its_runs(tmp_path, capsys):
    path = run_file(tmp_path, FOLD, {"name": "line", "parameter": "p"}, outputs={"plot": "a.png"})
    assert call("check", path) == 0
    assert capsys.readouterr().out == f"{path}: good. Model fold, 1 states; runs: line\n"
    assert [file.name for file in tmp_path.iterdir()] == ["case.yaml"]


def test_checking_a_model_carries_out_what_it_expects(tmp_path, capsys):
    def expecting(*at):
        path = tmp_path / "m.yaml"
        path.write_text(json.dumps({**FOLD, "expect": [{"label": "LP", "at": list(at), "run": {"parameter": "p"}}]}))
        return path

    assert call("check", expecting()) == 0
    assert call("check", "--run", expecting({"p": 0, "x": 0})) == 0
    assert "holds: LP over p: 1 found, 1 expected" in capsys.readouterr().out
    assert call("check", "--run", expecting()) == 1
    assert "FAILS: LP over p: 1 found, 0 expected; unexpected" in capsys.readouterr().out
    assert call("check", "--run", expecting({"p": 0.001})) == 1
    assert "missing [{'p': 0.001}]; unexpected" in capsys.readouterr().out
    assert call("check", "--run", expecting({"p": 0}, {"p": 0})) == 1


def test_a_wrong_model_file_is_named_by_check(tmp_path, capsys):
    path = tmp_path / "m.yaml"
    path.write_text(json.dumps({**FOLD, "equations": {"x": "p +"}}))
    assert call("check", path) == 2
    assert f"{path}:1:" in capsys.readouterr().err


def test_models_lists_the_bundled_ones(capsys):
    assert call("models") == 0
    names = [line.split()[0] for line in capsys.readouterr().out.splitlines() if line]
    assert "metronomes/pair" in names


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    folder = tmp_path_factory.mktemp("saved")
    run = {"name": "line", "parameter": "p"}
    assert call("run", run_file(folder, FOLD, run, outputs={"save": "r.contin", "json": "r.json"}), "-q") == 0
    return folder


@pytest.mark.parametrize("source", ["r.contin", "r.json"])
def test_saved_results_can_be_drawn(saved, source, capsys):
    assert call("plot", saved / source) == 0
    assert (saved / "r.png").read_bytes().startswith(b"\x89PNG")
    assert call("plot", saved / source, "--out", saved / "r.html", "-x", "x", "-y", "p") == 0
    assert '"views":[{"x":"x","y":"p"}]' in (saved / "r.html").read_text()
    assert call("plot", saved / source, "-y", "z") == 2
    assert "no branch has columns" in capsys.readouterr().err


def test_saved_results_can_be_exported(saved):
    assert call("export", saved / "r.contin", saved / "copy.json") == 0
    assert results(saved / "copy.json") == results(saved / "r.json")
    assert call("export", saved / "r.contin", saved / "r.csv") == 0
    assert (saved / "r.csv").read_text().startswith("branch,label,p,x,")
    assert call("export", saved / "r.contin", saved / "r.pickle") == 2


def test_new_writes_files_that_pass_check_and_never_overwrites(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert call("new", "mine") == 0
    assert call("check", "mine.yaml") == 0
    assert call("check", "mine-run.yaml") == 0
    assert call("check", "mine.yaml", "--run") == 0
    assert call("new", "mine") == 2
    assert call("new", "../mine") == 2
    assert sorted(file.name for file in tmp_path.iterdir()) == ["mine-run.yaml", "mine.yaml"]
    assert call("run", "mine-run.yaml", "--quiet") == 0
    rest, cycles = results(tmp_path / "mine.json")["branches"]
    [hopf] = rest["points"]
    assert (hopf["label"], hopf["values"]["mu"]) == ("HB1", pytest.approx(0, abs=1e-12))
    radius = np.array(cycles["columns"]["x.max"])  # the orbits are circles of radius sqrt(mu)
    np.testing.assert_allclose(radius**2, cycles["columns"]["mu"], atol=1e-6)
    assert (tmp_path / "mine.png").stat().st_size > 1000


def test_the_schema_of_run_files_accepts_a_good_one_and_refuses_a_bad_one(capsys):
    assert call("schema", "run") == 0
    schema = json.loads(capsys.readouterr().out)
    good = {
        "contin": 1,
        "model": "metronomes/pair-averaged",
        "parameters": {"beta": "1/2"},
        "transform": ["average", {"average": {"form": "polar"}}],
        "diagram": {"parameter": "mu", "range": [0, 1], "start": ["in-phase", {"r1": 1}]},
        "continuations": [
            {"name": "a", "start": "in-phase", "parameter": "mu", "range": [0, 1], "settings": {"max_step": 0.1}},
            {"from": "a.LP1", "as": "locus", "parameter": ["mu", "beta"], "range": {"mu": [0, 1], "beta": [0, 1]}},
        ],
        "outputs": {"json": "a.json", "y": "r1"},
    }
    jsonschema.validate(good, schema)
    for wrong in ({"paramters": {}}, {"contin": 2}, {"continuations": [{"name": "a.b", "parameter": "mu"}]}):
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate({**good, **wrong}, schema)


def test_the_schema_of_model_files_accepts_every_bundled_file(capsys):
    schemas = {}
    for kind in ("model", "pde"):
        assert call("schema", kind) == 0
        schemas[kind] = jsonschema.Draft202012Validator(json.loads(capsys.readouterr().out))
    files = sorted(Path(folder()).glob("*/*.yaml"))
    assert len(files) > 20
    for file in files:
        data = read_text(file.read_text(encoding="utf-8")).data
        schemas["pde" if data.get("kind") == "pde" else "model"].validate(data)
    with pytest.raises(jsonschema.ValidationError, match="equation"):
        schemas["model"].validate({"contin": 1, "name": "m", "states": {"x": 1}, "equation": {"x": "-x"}})


def test_the_schema_of_results_is_the_one_the_results_follow(capsys, saved):
    assert call("schema", "result") == 0
    jsonschema.validate(results(saved / "r.json"), json.loads(capsys.readouterr().out))
    assert call("schema", "model of a car") == 2


def test_a_broken_package_of_models_is_a_warning_in_words_and_the_run_goes_on(tmp_path):
    """Two packages offer `decay`; one of them cannot be imported."""
    for name, target in (("broken", "broken_models:make"), ("whole", "whole_models:make")):
        metadata = tmp_path / f"{name}_models-1.0.dist-info"
        metadata.mkdir()
        (metadata / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}-models\nVersion: 1.0\n")
        (metadata / "entry_points.txt").write_text(f"[contin.models]\ndecay = {target}\n")
    (tmp_path / "broken_models.py").write_text("raise RuntimeError('licence expired')\n")
    (tmp_path / "whole_models.py").write_text(
        "import contin\ndef make():\n"
        "    return contin.Model('decay', states={'x': 1}, parameters={'p': 1}, equations={'x': 'p - x'})\n"
    )
    path = os.pathsep.join([str(tmp_path), str(Path(__file__).parents[2])])
    done = subprocess.run(
        [sys.executable, "-m", "contin", "diagram", "decay", "p", "0", "1", "--json", "out.json", "--quiet"],
        cwd=tmp_path, env={**os.environ, "PYTHONPATH": path}, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0
    assert done.stderr == (
        "warning: models 'decay' of the package broken-models cannot be loaded: RuntimeError: licence expired\n"
    )
    assert len(results(tmp_path / "out.json")["branches"]) == 1


def test_a_bundled_model_is_checked_by_its_name(capsys):
    assert call("check", "oscillators/huygens-clocks") == 0
    assert "good. Model huygens-clocks" in capsys.readouterr().out
    assert call("check", "metronomes/pair-phase") == 0  # a bundled run of that name comes first
    assert "phase diagram" in capsys.readouterr().out
