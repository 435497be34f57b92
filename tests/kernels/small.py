"""A copy of what makes and loads kernels in contin, with two small kernels, in a folder of its own."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import contin

SOURCES = Path(contin.__file__).parent
CORE = (
    "__init__",
    "clock",
    "compile",
    "library",
    "mode",
    "callees",
    "pool",
    "signature",
    "sources",
    "vector",
)
CALLEE = """
from contin.kernels.compile import kernel


@kernel("f -> f")
def value(x):
    return {expression}
"""
CALLER = """
from contin.kernels.callee import value
from contin.kernels.compile import kernel


@kernel("f -> f")
def twice(x):
    return 2.0 * value(x)
"""
USE = "from contin.kernels.caller import twice; print(twice(3.0))"


def copy(folder, expression="x + 1.0"):
    """The copy, in which `contin.kernels.caller.twice(x)` is twice the expression."""
    kernels = folder / "contin" / "kernels"
    kernels.mkdir(parents=True)
    (folder / "contin" / "__init__.py").touch()
    for name in ("errors.py", "abi.py"):
        shutil.copy(SOURCES / name, folder / "contin" / name)
    shutil.copytree(SOURCES / "machine", folder / "contin" / "machine")
    shutil.copytree(SOURCES / "kernels" / "building", kernels / "building")
    for name in CORE:
        shutil.copy(SOURCES / "kernels" / f"{name}.py", kernels)
    (kernels / "caller.py").write_text(CALLER)
    (kernels / "callee.py").write_text(CALLEE.format(expression=expression))
    return folder


def run(folder, code=USE, cache=None, **environment):
    """(standard output, standard error) of a process that sees the copy. Without a cache folder there is no home."""
    given = {k: v for k, v in os.environ.items() if k not in ("CONTIN_CACHE_DIR", "HOME", "XDG_CACHE_HOME")}
    given |= {"PYTHONPATH": str(folder), "CONTIN_CACHE_DIR": str(cache)} if cache else {"PYTHONPATH": str(folder)}
    done = subprocess.run(
        [sys.executable, "-c", code], env=given | environment, cwd=folder, text=True, capture_output=True, timeout=300
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.strip(), done.stderr
