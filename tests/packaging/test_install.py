"""A wheel carries the bundled models; an editable install reads the repository's folder; both give the command."""

import os
import subprocess
import sys
import sysconfig
import venv
import zipfile
from functools import cache
from pathlib import Path

import pytest

from contin._version import __version__
from contin.machine import target

ROOT = Path(__file__).resolve().parents[2]
SITE = sysconfig.get_paths()["purelib"]


def run(*arguments: object, cwd: Path, **environment: str) -> str:
    """Standard output of a command that must succeed."""
    given = {**os.environ, "CONTIN_KERNELS": "no", **environment}
    given.pop("PYTHONPATH", None)  # the installed package is what is tried
    done = subprocess.run([str(a) for a in arguments], capture_output=True, text=True, cwd=cwd, check=False, env=given)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def build(tmp_path_factory):
    """Builds a wheel of one kind with hatchling, which needs no network."""
    pytest.importorskip("hatchling")

    @cache
    def make(kind: str, kernels: str = "no") -> Path:
        folder = tmp_path_factory.mktemp(kind)
        code = f"import hatchling.build as b; print(b.build_{kind}({str(folder)!r}))"
        run(sys.executable, "-c", code, cwd=ROOT, CONTIN_KERNELS=kernels)
        [wheel] = folder.glob("*.whl")
        return wheel

    return make


@pytest.fixture(scope="module")
def install(tmp_path_factory):
    """Installs a wheel into a fresh environment that borrows the dependencies of the one the tests run in."""

    @cache
    def make(wheel: Path) -> Path:
        tmp_path = tmp_path_factory.mktemp("installed")
        home = tmp_path / "venv"
        venv.create(home, with_pip=False, symlinks=True)
        site = Path(
            run(
                home / "bin" / "python", "-c", "import sysconfig; print(sysconfig.get_paths()['purelib'])", cwd=tmp_path
            ).strip()
        )
        pip = [sys.executable, "-m", "pip", "--python", home / "bin" / "python"]
        run(*pip, "install", "--quiet", "--no-deps", "--no-index", "--no-compile", wheel, cwd=tmp_path)
        # Appended, not .pth-processed: the tests' own editable contin must not be found through it.
        (site / "borrowed.pth").write_text(f"import sys; sys.path.append({SITE!r})\n")
        return home / "bin"

    return make


def models_folder(binaries: Path, cwd: Path) -> Path:
    text = run(binaries / "python", "-c", "from contin.model.bundled import folder; print(folder())", cwd=cwd)
    return Path(text.strip())


def test_a_wheel_carries_every_bundled_model_and_what_the_package_needs(build):
    names = set(zipfile.ZipFile(build("wheel")).namelist())
    models = {path.relative_to(ROOT / "models").as_posix() for path in (ROOT / "models").rglob("*.yaml")}
    assert models
    assert {f"contin/_models/{name}" for name in models} <= names
    assert {"contin/plot/viewer.html", "contin/py.typed"} <= names
    assert not any(name.startswith(("tests/", "models/", "hatch_build")) for name in names)


def test_an_installed_wheel_has_the_command_and_its_own_models(build, install, tmp_path):
    binaries = install(build("wheel", target.label()))  # the dear one: the test without numba needs it, too
    assert run(binaries / "contin", "--version", cwd=tmp_path) == f"contin {__version__}\n"
    assert "metronomes/pair" in run(binaries / "contin", "models", cwd=tmp_path)
    folder = models_folder(binaries, tmp_path)
    assert folder.name == "_models"
    assert folder.is_relative_to(binaries.parent.resolve())


@pytest.mark.seldom
def test_an_editable_install_reads_the_folder_of_the_repository(build, install, tmp_path):
    wheel = build("editable")
    assert not any("_models" in name for name in zipfile.ZipFile(wheel).namelist())
    binaries = install(wheel)
    assert "metronomes/pair" in run(binaries / "contin", "models", cwd=tmp_path)
    assert models_folder(binaries, tmp_path) == ROOT / "models"


WITHOUT_NUMBA = """
import sys
sys.modules["numba"] = None  # not installed
import contin
line = contin.continuation(contin.equilibrium(contin.load("brusselator")), "B", (0, 4))
orbit = contin.continuation(line["HB1"].switch(), "B", (0, 4), settings={"steps": 5})
from contin.machine import packed
from contin.machine.folder import folder
print(folder(), len(packed._archive().namelist()) > 100, line["HB1"].values["B"], len(orbit))
"""


@pytest.mark.seldom
def test_a_wheel_with_machine_code_needs_no_numba_and_no_home(build, install, tmp_path):
    """Archives for this processor's target: what is made here anyway. The other targets differ in name alone."""
    wheel = build("wheel", target.label())
    with zipfile.ZipFile(wheel) as archive:
        assert f"contin/_kernels/{target.label()}.zip" in archive.namelist()
        [metadata] = [name for name in archive.namelist() if name.endswith("METADATA")]
        assert "Requires-Dist: numba" not in archive.read(metadata).decode()
    home = {"HOME": "/dev/null", "XDG_CACHE_HOME": "/dev/null", "CONTIN_CACHE_DIR": ""}
    told = run(install(wheel) / "python", "-c", WITHOUT_NUMBA, cwd=tmp_path, **home)
    assert told.split()[:2] == ["None", "True"]
    assert float(told.split()[2]) == pytest.approx(2.0, abs=1e-9)
    assert int(told.split()[3]) > 5


def test_a_wheel_without_machine_code_needs_numba(build):
    with zipfile.ZipFile(build("wheel")) as archive:
        [metadata] = [name for name in archive.namelist() if name.endswith("METADATA")]
        assert "Requires-Dist: numba" in archive.read(metadata).decode()
