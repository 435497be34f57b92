"""A package of models, installed by pip into a fresh environment, is listed, loaded, run, broken and switched off."""

import json
import os
import subprocess
import sys
import sysconfig
import venv
from math import pi
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
RUN = """
contin: 1
model: sample/ecology/logistic-harvest
continuations: [{name: line, parameter: h}]
"""


class Environment:
    """A virtual environment with contin (from the repository) and what `pip install` put there."""

    def __init__(self, home: Path) -> None:
        self.python, self.folder = home / "bin" / "python", home.parent

    def run(self, code: str, *, good: bool = True, **variables: str) -> subprocess.CompletedProcess:
        done = subprocess.run(
            [str(self.python), "-c", code],
            capture_output=True,
            text=True,
            cwd=self.folder,
            env={**os.environ, **variables},
            check=False,
        )
        assert (done.returncode == 0) == good, done.stderr
        return done

    def command(self, *arguments: str, good: bool = True, **variables: str) -> subprocess.CompletedProcess:
        code = f"from contin.cli.main import main; main({list(arguments)!r})"
        return self.run(code, good=good, **variables)


@pytest.fixture(scope="module")
def environment(tmp_path_factory):
    pytest.importorskip("hatchling")
    home = tmp_path_factory.mktemp("plugin") / "venv"
    venv.create(home, with_pip=False, symlinks=True)
    found = Environment(home)
    site = Path(found.run("import sysconfig; print(sysconfig.get_paths()['purelib'])").stdout.strip())
    borrowed = [str(ROOT), sysconfig.get_paths()["purelib"]]  # contin, its dependencies and the builder
    (site / "borrowed.pth").write_text(f"import sys; sys.path.extend({borrowed!r})\n")
    pip = [sys.executable, "-m", "pip", "--python", str(found.python)]
    offline = ["install", "--quiet", "--no-index", "--no-deps", "--no-build-isolation", "--no-cache-dir"]
    done = subprocess.run([*pip, *offline, str(HERE)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return found


def test_the_models_are_listed_with_their_package_and_not_imported(environment):
    lines = environment.command("models").stdout.splitlines()
    assert any(line.split()[0] == "ring" and line.endswith("[contin-sample-models]") for line in lines)
    assert any(line.split()[0] == "sample" and line.endswith("[contin-sample-models]") for line in lines)
    assert any(line.split()[0] == "classics/brusselator" for line in lines)
    code = "import sys, contin.model.registry as r; r.listing(); print('contin_sample_models' in sys.modules)"
    assert environment.run(code).stdout.strip() == "False"


def test_a_run_file_names_a_model_of_the_package(environment):
    (environment.folder / "run.yaml").write_text(RUN)
    environment.command("run", "run.yaml", "--json", "out.json", "--quiet")
    [branch] = json.loads((environment.folder / "out.json").read_text())["branches"]
    [fold] = branch["points"]
    assert fold["type"] == "LP"
    assert fold["values"]["h"] == pytest.approx(0.5, abs=1e-12)  # r/4


def test_what_the_models_expect_holds(environment):
    code = """
import contin
from contin.runs.expect import verify_expectations
for name in ("sample/ecology/logistic-harvest", "sample/ecology/critical-strip", "ring"):
    for report in verify_expectations(contin.load(name)):
        print(report.holds, report.text)
"""
    lines = environment.run(code).stdout.splitlines()
    assert len(lines) == 3
    assert all(line.startswith("True") for line in lines), lines


def test_plugins_are_switched_off_by_the_environment_variable(environment):
    assert "sample" not in environment.command("models", CONTIN_PLUGINS="0").stdout
    failed = environment.command("diagram", "ring", "p", "-1", "1", good=False, CONTIN_PLUGINS="0")
    assert failed.returncode == 2
    assert "no model is called 'ring'" in failed.stderr


TAKENS = """
import contin, json
takens = contin.Model("takens", states={"x": 1, "y": 0}, parameters={"b1": -1.0, "b2": -0.5},
                      equations={"x": "y", "y": "b1 + b2*y + x^2 + x*y"})
saddles = contin.continuation(contin.equilibrium(takens), "b1", (-1, -0.01))
[point] = saddles.points
curve = contin.continuation(point.locus(), ("b1", "b2"), {"b1": (-1, 0.01), "b2": (-0.9, 0.5)})
rows = {k: curve.columns[k].tolist() for k in ("b1", "b2", "kappa")}
print(json.dumps({"type": point.type, "values": dict(point.values), "form": dict(point.normal_form),
                  "points": [p.type for p in curve.points], "rows": rows, "curve": curve.locus}))
from contin.plot.vocabulary import style_of
print(style_of("NSA").words)
"""


def test_a_special_point_of_the_package_is_found_and_followed(environment):
    """x' = y, y' = b1 + b2 y + x^2 + x y has saddles x = sqrt(-b1) with trace b2 + x: neutral at b1 = -b2^2."""
    line, words = environment.run(TAKENS).stdout.splitlines()
    found = json.loads(line)
    assert (found["type"], words, found["curve"]) == ("NSA", "neutral saddle", "HB")
    assert found["values"]["b1"] == pytest.approx(-0.25, abs=1e-9)
    assert found["form"]["eigenvalue"] == pytest.approx(1.0, abs=1e-9)  # det f_u = -2 x
    assert found["points"] == ["BT"]  # beyond which the points are Hopf points
    for b1, b2, kappa in zip(*(found["rows"][k] for k in ("b1", "b2", "kappa")), strict=True):
        assert b1 == pytest.approx(-(b2**2), abs=1e-8)
        assert kappa == pytest.approx(2.0 * b2, abs=1e-6)


def test_without_packages_there_is_no_such_point(environment):
    code = "from contin.special.table import table; print('NSA' in table())"
    assert environment.run(code).stdout.strip() == "True"
    assert environment.run(code, CONTIN_PLUGINS="0").stdout.strip() == "False"


SCATTERING = """
import json
import contin
from contin_sample_models.scattering import seed
for nodes in (4, 12):
    branch = contin.continuation(seed(nodes), "c", (0.0, 1.5), settings={"steps": 100})
    columns = {name: branch.columns[name].tolist() for name in ("c", "s")}
    points = [(p.type, p.values["c"], p.values["s"], p.error) for p in branch.points]
    print(json.dumps({"points": points, "columns": columns, "notes": list(branch.notes)}))
"""


def test_a_problem_of_the_package_is_followed_through_its_fold(environment):
    """s = 2/c (1 -+ sqrt(1 - c)) on both sides of the fold at c = 1, whatever the number of nodes."""
    lines = environment.run(SCATTERING).stdout.splitlines()
    assert len(lines) == 2
    for line in lines:
        found = json.loads(line)
        [(type_, c, s, error)] = found["points"]
        assert (type_, found["notes"]) == ("LP", [])
        assert abs(c - 1.0) <= error < 1e-10
        assert s == pytest.approx(2.0, abs=1e-6)
        for c, s in zip(found["columns"]["c"], found["columns"]["s"], strict=True):
            assert (c * s / 2 - 1) ** 2 == pytest.approx(1 - c, abs=1e-10)
        assert max(found["columns"]["s"]) > 4.0  # the branch has passed the fold


ENERGY = """
import contin
from contin.symbolic.passes.metronomes import metronomes
slow = contin.average(contin.load("metronomes/pair"), form="energy")
branch = contin.continuation(contin.equilibrium(slow, "in-phase"), "mu", (0.05, 8), name="line")
[point] = [p for p in branch.points if p.type == "BP"]
print(slow.state_names, float(point.values["mu"]), float(point.values["E1"]))
print(contin.average(metronomes(2, escapement="brass")).parameter_names)
"""


def test_a_form_and_an_escapement_of_the_package_are_used(environment):
    states, names = environment.run(ENERGY).stdout.splitlines()
    assert states.startswith("('E1', 'E2', 'psi')")
    mu, energy = (float(x) for x in states.split(")")[1].split())
    r = ((12 + (144 - 48 * pi * 0.8) ** 0.5) / 4) ** 0.5
    assert energy == pytest.approx(r**2 / 2, abs=1e-8)
    a, b, beta = 4, 1, 0.8
    root = (9 * a**2 - 48 * pi * b * beta) ** 0.5
    assert mu == pytest.approx(-15 * pi * beta / 8 + 27 * a**2 / (64 * b) + 9 * a * root / (64 * b), abs=1e-8)
    assert "'a'" in names
    code = "import contin; contin.average(contin.load('metronomes/pair'), form='energy')"
    failed = environment.run(code, good=False, CONTIN_PLUGINS="0")
    assert "averaging has no form 'energy'" in failed.stderr


def test_an_output_of_the_package_writes_its_files(environment):
    code = "from contin.cli.main import main; main(['export', 'ring', 'ring.mac'])"
    assert "values of p, d are not written" in environment.run(code).stderr
    unknowns, equations = (environment.folder / "ring.mac").read_text().splitlines()
    assert unknowns == "unknowns: [x0, x1, x2, x3]$"
    assert equations.startswith("equations: [")
    assert equations.count(" = 0") == 4
