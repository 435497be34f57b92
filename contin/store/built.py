"""The versions and the machine that results were computed with: where these agree, so do the digits."""

from __future__ import annotations

import os
import platform
from functools import cache
from importlib.metadata import version

from contin._version import __version__
from contin.machine import environment, target


@cache
def built() -> dict[str, str]:
    """Versions and level; `libraries` says whether the choices of numpy and BLAS were fixed before they loaded."""
    names = getattr(os, "confstr_names", {})
    system = os.confstr("CS_GNU_LIBC_VERSION") if "CS_GNU_LIBC_VERSION" in names else None
    return {
        "version": __version__,
        "target": target.name(),
        "libraries": "fixed" if environment.fixed() else "by processor",
        **{name: version(name) for name in ("numpy", "scipy", "llvmlite")},
        "libc": system or platform.system(),
    }
