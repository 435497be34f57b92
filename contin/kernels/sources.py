"""What a kernel's machine code is made from, as a hash: the key under which it is kept.

The text of the kernel's file, of all kernel files that it imports, and of the compiler's own files; the versions of
numba and llvmlite; the target. Not the path and date of anything: copies of one version share one cache. An edit
anywhere in that text gives another key, so old machine code is never taken for new.
"""

from __future__ import annotations

import hashlib
import re
import sys
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Final

HERE: Final = Path(__file__).parent
BASE: Final = "contin.kernels."
COMPILER: Final = (
    "compile.py", "mode.py", "signature.py", "building/emit.py", "building/entry.py", "building/functions.py",
    "building/types.py", "building/pointer_calls.py", "building/lean.py", "building/references.py",
    "building/vectors.py", "building/lanes.py", "building/targets.py",
)  # fmt: skip
_STRUCTURE: Final = re.compile(rb"^structure\(\s*(\w+)", re.M)
_WORD: Final = re.compile(rb"\w+")
_IMPORT: Final = re.compile(rb"^\s*from contin\.kernels\.([\w.]+) import|^\s*from contin\.kernels import (\w+)", re.M)


@cache
def text_key(module: str) -> str:
    """Hash of the text behind the kernels of a module (`algebraic`, `piecewise.flight`)."""
    digest = hashlib.sha256(_compiler())
    for name in sorted(behind(module)):
        digest.update(name.encode() + b"\x00" + _text(name))
    return digest.hexdigest()


@cache
def key(module: str, target: str) -> str:
    """... and of the versions and the target: the key in a cache."""
    parts = (text_key(module), target, *versions().values())
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()[:24]


@cache
def versions() -> dict[str, str]:
    """Those of the programs that make the code."""
    found = {"python": f"{sys.version_info.major}.{sys.version_info.minor}"}
    for package in ("numba", "llvmlite"):
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "none"
    return found


@cache
def _compiler() -> bytes:
    digest = hashlib.sha256()
    for name in COMPILER:
        digest.update(name.encode() + b"\x00" + (HERE / name).read_bytes())
    return digest.digest()


@cache
def behind(module: str) -> frozenset[str]:
    """The module, and all kernel modules that it imports or whose structures its signatures name, directly or not."""
    found, todo = set[str](), [module]
    while todo:
        name = todo.pop()
        if name not in found:
            found.add(name)
            todo += _named_in(name)
    return frozenset(found)


@cache
def _named_in(module: str) -> frozenset[str]:
    """Kernel modules that the text of this one imports, or whose structures it names."""
    text = _text(module)
    imported = {part.decode() for pair in _IMPORT.findall(text) for part in pair if part}
    words = set(_WORD.findall(text))  # once: every process that calls kernels reads them
    named = {home for structure, home in _structures().items() if structure in words}
    return frozenset(name for name in imported | named if _is_kernel(name))


@cache
def _structures() -> dict[bytes, str]:
    """The module that declares each structure."""
    found = {}
    for path in sorted(HERE.rglob("*.py")):
        module = ".".join(path.relative_to(HERE).with_suffix("").parts)
        found.update(dict.fromkeys(_STRUCTURE.findall(path.read_bytes()), module))
    return found


def _is_kernel(module: str) -> bool:
    return module not in ("compile", "mode", "signature", "clock") and _path(module) is not None


@cache
def _text(module: str) -> bytes:
    path = _path(module)
    return path.read_bytes() if path else b""


@cache
def _path(module: str) -> Path | None:
    base = HERE.joinpath(*module.split("."))
    for path in (base.with_suffix(".py"), base / "__init__.py"):
        if path.is_file():
            return path
    return None
