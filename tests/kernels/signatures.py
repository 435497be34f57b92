"""Every kernel of the package, with the signatures it was compiled for in this process."""

import importlib
import pkgutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from contin import kernels


def all_kernels() -> Iterator[tuple[str, Any]]:
    """(module.name, dispatcher) of the kernels in all modules of contin.kernels."""
    for info in pkgutil.walk_packages([str(Path(kernels.__file__).parent)], "contin.kernels."):
        module = importlib.import_module(info.name)
        for name, value in vars(module).items():
            if hasattr(value, "signatures") and value.__module__ == module.__name__:
                yield f"{info.name.removeprefix('contin.kernels.')}.{name}", value
