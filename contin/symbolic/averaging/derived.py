"""Models that passes derived before: kept in the user's folder, under a hash of all that they were derived from.

That is the model, node by node, the options, the text of the code that derives, the versions of what it uses, and what
their last digits depend on. What is read back is built exactly as what was derived (`contin.model.graph_text`), so a
run gives the same bytes either way. Files hold data, never code, and carry a checksum; a damaged one is made anew.
"""

from __future__ import annotations

import hashlib
import os
import sys
import time
from collections.abc import Callable
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Final

from contin.machine import environment, progress, target
from contin.machine.folder import DERIVED, Folder, folder
from contin.model.graph_text import from_graph_text, to_graph_text
from contin.model.model import Model

WORTH_KEEPING: Final = 0.1  # seconds of a derivation, the import of what it needs included
MOST_FILES: Final = 200
LARGEST: Final = 4_000_000  # characters
BEHIND: Final = ("symbolic", "model", "machine/elementary")
PACKAGES: Final = ("numpy", "scipy", "sympy", "mpmath")


def derived(name: str, model: Model, options: tuple[object, ...], derive: Callable[[], Model]) -> Model:
    """`derive()`, or what it gave before for the same model and options."""
    place = folder(DERIVED)
    if place is None:
        return derive()
    try:
        text = to_graph_text(model)
    except (TypeError, ValueError):  # a model that holds more than formulas
        return derive()
    parts = (name, repr(options), *_made_with(), text)
    file = f"{name}-{hashlib.sha256(chr(0).join(parts).encode()).hexdigest()[:32]}"
    found = _read(place, file)
    if found is not None:
        return found
    began = time.perf_counter()
    made = derive()
    if time.perf_counter() - began > WORTH_KEEPING:
        _keep(place, file, made)
    return made


def _read(place: Folder, file: str) -> Model | None:
    data = place.read(file)
    if data is None:
        return None
    digest, _, body = data.partition(b"\n")
    try:
        if hashlib.sha256(body).hexdigest().encode() == digest:
            return from_graph_text(body.decode())
    except ValueError:
        pass
    progress.note(f"{place.path / file} was damaged: it is made anew")
    place.remove(file)
    return None


def _keep(place: Folder, file: str, made: Model) -> None:
    try:
        text = to_graph_text(made)
        if len(text) > LARGEST or from_graph_text(text) != made:
            return
    except (TypeError, ValueError):
        return
    body = text.encode()
    place.write(file, hashlib.sha256(body).hexdigest().encode() + b"\n" + body)
    place.thin_out(MOST_FILES)


@cache
def _made_with() -> tuple[str, ...]:
    """What a derivation uses, with what the last digits of its quadrature rules depend on."""
    digest = hashlib.sha256()
    home = Path(__file__).parents[2]
    for part in BEHIND:
        for path in sorted((home / part).rglob("*.py")):
            digest.update(path.relative_to(home).as_posix().encode() + b"\0" + path.read_bytes())
    versions = []
    for package in PACKAGES:
        try:
            versions.append(version(package))
        except PackageNotFoundError:
            versions.append("none")
    return (digest.hexdigest(), *versions, sys.version, target.label(), *_libraries())


def _libraries() -> tuple[str, ...]:
    """What linear algebra's last digits depend on, where `environment` did not fix it."""
    if environment.fixed():
        return ("fixed",)
    import llvmlite.binding as llvm

    chosen = ("OPENBLAS_CORETYPE", "MKL_CBWR", "NPY_DISABLE_CPU_FEATURES", "GLIBC_TUNABLES")
    return (llvm.get_host_cpu_name(), *(os.environ.get(name, "") for name in chosen), *_threads())


def _threads() -> tuple[str, ...]:
    return tuple(os.environ.get(name, "") for name in environment.THREADS)
