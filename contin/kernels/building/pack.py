"""All kernels for several targets, an archive each: what wheels hold as `contin/_kernels`."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Sequence
from pathlib import Path

from contin.kernels import library, pool, sources
from contin.kernels.building.targets import EVERY
from contin.kernels.catalogue import every
from contin.machine import objects, target
from contin.machine.elementary import FUNCTIONS
from contin.machine.elementary.code import machine_code

DAY_ONE = (1980, 1, 1, 0, 0, 0)  # archives of the same code are the same bytes


def pack(folder: Path, labels: Sequence[str]) -> list[Path]:
    """Make and write the archives `LABEL.zip`; numba works once a kernel, LLVM once a kernel and target."""
    wanted = every()
    if list(labels) == [target.label()]:  # for this machine: what its cache has is not made again
        made = library.complete(wanted)
    else:
        made = pool.make(list(wanted.values()), labels=labels)
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for place, label in enumerate(labels):
        path = folder / f"{label}.zip"
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
            for machine_codes in sorted(made, key=lambda machine_codes: machine_codes[0].name):
                one = machine_codes[place]
                archive.writestr(zipfile.ZipInfo(one.name, DAY_ONE), objects.to_bytes(one), zipfile.ZIP_DEFLATED)
            for function in FUNCTIONS:
                for looped in (False, True):
                    own = machine_code(function, EVERY[label].machine(), looped=looped)
                    archive.writestr(zipfile.ZipInfo(own.name, DAY_ONE), objects.to_bytes(own), zipfile.ZIP_DEFLATED)
            about = {"target": label, "versions": sources.versions(), "kernels": len(made)}
            archive.writestr(zipfile.ZipInfo("about.json", DAY_ONE), json.dumps(about))
        written.append(path)
    return written
