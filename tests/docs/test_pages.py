"""The code in the documentation runs, page by page, each in a fresh folder; the gallery gives the right numbers."""

import importlib.util
import os
import re
import runpy
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

DOCS = Path(__file__).resolve().parents[2] / "docs"
CELL = re.compile(r"^```\{code-cell\}[^\n]*\n(.*?)^```$", re.M | re.S)
PAGES = sorted(page.relative_to(DOCS).as_posix() for page in DOCS.rglob("*.md") if CELL.search(page.read_text("utf-8")))
COMMAND = [sys.executable, "-m", "contin"]


def shell(line: str, noted: bool = False) -> None:
    """`!command` of a notebook: contin must succeed, or refuse bad input, or note something where the page says so.

    Other programs are left out.
    """
    words = shlex.split(line.split("|")[0])
    if words[0] != "contin":
        return
    done = subprocess.run([*COMMAND, *words[1:]], capture_output=True, text=True, check=False)
    assert done.returncode in ((1,) if noted else (0, 2)), done.stderr
    assert "Traceback" not in done.stderr


def as_python(cell: str) -> str:
    """One cell: a file that it writes, or Python with lines for the shell."""
    lines = [line for line in cell.splitlines() if not line.startswith(":tags:")]
    if lines and lines[0].startswith("%%writefile "):
        text = "\n".join(lines[1:]) + "\n"
        return f"Path({lines[0].split()[1]!r}).write_text({text!r}, encoding='utf-8')"
    lines = [line for line in lines if line != "from IPython.display import Image"]
    noted = [before.startswith("# exit code 1") for before in ["", *lines]]
    return "\n".join(
        f"shell({line[1:]!r}, {told})" if line.startswith("!") else line
        for line, told in zip(lines, noted, strict=False)
    )


@pytest.mark.long  # the build of the documentation, a part of `.ci/run`, carries all of them out, and an error ends it
@pytest.mark.parametrize("page", PAGES)
def test_the_code_of_the_page_runs(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("CONTIN_PLUGINS", "1")  # a page changes it
    monkeypatch.setattr(sys, "path", [str(DOCS / "metronomes"), str(DOCS / "gallery"), *sys.path])
    scripts = str(Path(sys.executable).parent)  # where the command is when the environment is not activated
    monkeypatch.setenv("PATH", scripts + os.pathsep + os.environ["PATH"])
    cells = CELL.findall((DOCS / page).read_text("utf-8"))
    assert cells
    Path("page.py").write_text("\n".join(map(as_python, cells)), encoding="utf-8")
    runpy.run_path("page.py", {"shell": shell, "Path": Path, "Image": show})


def show(name: str, **_: object) -> None:
    """In place of the notebook's picture: it must have been written."""
    assert Path(name).stat().st_size > 1000


def script(name: str):
    """A script of the gallery, imported."""
    spec = importlib.util.spec_from_file_location(name, DOCS / "gallery" / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_cusp_of_the_budworm_is_where_the_closed_form_says():
    gallery = script("budworm_cusp")
    assert gallery.cusp(gallery.compute()[1]) == pytest.approx(3 * np.sqrt(3), rel=1e-9)


def test_the_doublings_of_the_logistic_map_approach_the_ratio_of_feigenbaum():
    """The first doublings are at 3 and 1 + sqrt(6); the limit of the ratios is 4.6692 (Feigenbaum 1978)."""
    gallery = script("logistic_doublings")
    branches = gallery.compute()
    found = [branch["PD1"].values["r"] for branch in branches[:2]]
    assert found == pytest.approx([3, 1 + np.sqrt(6)], rel=1e-11)
    assert gallery.ratio(branches) == pytest.approx(4.669, abs=0.02)


def test_the_neuron_fires_from_a_fold_of_cycles_below_the_hopf_point():
    gallery = script("neuron")
    rest, firing = gallery.compute()
    hopf = rest["HB1"]
    assert hopf.normal_form["criticality"] == "subcritical"
    assert gallery.onset(firing) < hopf.values["I"]
