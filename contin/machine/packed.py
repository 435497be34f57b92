"""Machine code that came with the wheel: one archive a target, in `contin/_kernels`."""

from __future__ import annotations

import zipfile
import zlib
from functools import cache
from pathlib import Path
from typing import Final

from contin.machine import objects, progress, target
from contin.machine.objects import MachineCode

FOLDER: Final = Path(__file__).parents[1] / "_kernels"


def find(name: str, text_key: str) -> MachineCode | None:
    """The machine code of a kernel with this text; None where the wheel has none, or none that is whole."""
    archive = _archive()
    if archive is None:
        return None
    try:
        found = objects.from_bytes(archive.read(name))
    except (KeyError, OSError, zipfile.BadZipFile, zlib.error):
        found = None
    if found is None:
        progress.note(f"{archive.filename} is damaged at {name}: reinstall contin")
        return None
    return found if found.key == text_key else None  # another key: somebody edited the installed sources


def path(label: str) -> Path:
    """The archive of a target."""
    return FOLDER / f"{label}.zip"


@cache
def _archive() -> zipfile.ZipFile | None:
    try:
        return zipfile.ZipFile(path(target.label()))
    except FileNotFoundError:
        return None
    except (OSError, zipfile.BadZipFile):
        progress.note(f"{path(target.label())} is damaged: reinstall contin")
        return None
