"""Kernels compile once: one signature each, cached under a name that changes with any of their sources."""

import ast
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np

from contin import kernels
from contin.kernels.compile import fingerprint, kernel_cache_folder

SOURCES = Path(kernels.__file__).parent


EVERY_KIND = """
import contin
from tests.kernels.signatures import all_kernels
from tests.problems.cases import oscillator, zeros
from tests.problems.follow import follow

follow({"x": "p - x^2"}, {"x": 1.0}, {"p": 1.0}, (-1.0, 1.5))
follow({"x": "1 - x^2 - p^2", "y": "-y"}, {"x": 1.0, "y": 0.0}, {"p": 0.0, "q": 1.0}, (-2.0, 2.0))
cycle = contin.Model("m", kind="map", states={"x": 0.5}, parameters={"p": 2.0}, equations={"x": "p*x*(1 - x)"})
contin.continuation(contin.equilibrium(cycle), "p", (1.5, 3.5))
hopf = follow(oscillator("x", "y", "p"), zeros("x y"), {"p": -0.5}, (-0.5, 0.2))
contin.continuation(hopf["HB1"].switch(), "p", (-0.5, 0.2))
print({name: len(kernel.signatures) for name, kernel in all_kernels()})
"""


def test_every_kernel_has_one_signature_after_every_kind_of_run():
    """Flows, maps, several dimensions, closed loops, orbits: no call may bring a second compilation."""
    environment = os.environ | {"PYTHONPATH": str(SOURCES.parent.parent)}
    text = subprocess.check_output([sys.executable, "-c", EVERY_KIND], env=environment, text=True)
    counts = ast.literal_eval(text)
    assert {"algebraic.march", "algebraic.probe", "dense.lu_factor", "eigen.eigenvalues"} <= set(counts)
    assert counts["algebraic.march"] == 1
    assert {name: count for name, count in counts.items() if count > 1} == {}


def test_cache_folder_is_named_by_the_sources(tmp_path):
    copy = tmp_path / "kernels"
    shutil.copytree(SOURCES, copy, ignore=shutil.ignore_patterns("__pycache__"))
    before = fingerprint(copy)
    assert before == fingerprint(SOURCES)
    assert kernel_cache_folder().endswith(before)
    edited = copy / "dense.py"
    edited.write_text(edited.read_text() + "\n# edited\n")
    assert fingerprint(copy) != before


CALLER = """
from contin.kernels.compile import kernel
from contin.kernels.callee import value


@kernel
def twice(x):
    return 2.0 * value(x)
"""
CALLEE = """
from contin.kernels.compile import kernel


@kernel
def value(x):
    return {expression}
"""


def test_edited_callee_in_another_file_is_seen(tmp_path):
    """numba alone would go on running the old machine code of the caller, whose file did not change."""
    package = tmp_path / "contin"
    (package / "kernels").mkdir(parents=True)
    (package / "__init__.py").touch()
    for name in ("__init__.py", "compile.py", "clock.py", "turns.py"):
        shutil.copy(SOURCES / name, package / "kernels" / name)
    (package / "kernels" / "caller.py").write_text(CALLER)
    environment = os.environ | {"CONTIN_CACHE_DIR": str(tmp_path / "cache"), "PYTHONPATH": str(tmp_path)}

    def run():
        code = "from contin.kernels.caller import twice; print(twice(3.0))"
        return float(subprocess.check_output([sys.executable, "-c", code], env=environment, cwd=tmp_path, text=True))

    for expression, wanted in (("x + 1.0", 8.0), ("x + 2.0", 10.0)):
        (package / "kernels" / "callee.py").write_text(CALLEE.format(expression=expression))
        assert run() == wanted
    assert len(list((tmp_path / "cache").glob("kernels-*"))) == 2


def test_models_reach_the_kernel_by_address_so_a_new_model_compiles_nothing():
    from contin.kernels.algebraic import march
    from tests.problems.follow import follow

    for k in range(3):
        follow({"x": f"p - x^2 - {k}*x"}, {"x": 1.0}, {"p": 1.0 + k}, (-5.0, 5.0))
    assert len(march.signatures) == 1
    assert np.ndim(march.signatures[0]) == 1
