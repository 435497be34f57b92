"""All kernels that contin has."""

from __future__ import annotations

import importlib
from pathlib import Path

from contin.kernels import sources
from contin.kernels.compile import Kernel
from contin.kernels.mode import Declaration


def every() -> dict[str, Declaration]:
    """Every declared kernel by name. Imports all their modules."""
    found: dict[str, Declaration] = {}
    for path in sorted(sources.HERE.rglob("*.py")):
        module = _module(path)
        if b"contin.kernels.compile" in path.read_bytes() and not module.startswith("building"):
            values = vars(importlib.import_module(sources.BASE + module)).values()
            declared = [value.declaration for value in values if isinstance(value, Kernel)]
            found |= {d.name: d for d in declared}
    return found


def _module(path: Path) -> str:
    return ".".join(path.relative_to(sources.HERE).with_suffix("").parts)
