"""Files that are replaced whole: a reader, or a crash, never sees half of one."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from contin.errors import InputError


def write_bytes(path: Path, data: bytes) -> None:
    """Write to a temporary file beside `path`, then rename it to `path` (atomic on one file system).

    A symbolic link is followed; what is not a file (a pipe, a device such as /dev/stdout) is written to, not replaced.

    Raises
    ------
    InputError
        The folder is missing or may not be written to, or the disk is full; an earlier file is left as it was.
    """
    if path.exists() and not path.is_file():
        _write_through(path, data)
        return
    if path.is_symlink():
        path = _resolved(path)
    try:
        handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=".part")
    except OSError as error:
        raise InputError(
            f"{path}: cannot be written ({error.strerror}); the folder must exist and be writable"
        ) from None
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(data)
        os.chmod(temporary, 0o666 & ~_umask())  # mkstemp makes files that only their owner can read
        os.replace(temporary, path)
    except OSError as error:
        os.unlink(temporary)
        raise InputError(f"{path}: cannot be written ({error.strerror})") from None
    except BaseException:
        os.unlink(temporary)
        raise


def _resolved(path: Path) -> Path:
    try:
        return path.resolve()
    except (OSError, RuntimeError):
        raise InputError(f"{path}: leads nowhere: a loop of symbolic links") from None


def _write_through(path: Path, data: bytes) -> None:
    try:
        with path.open("wb") as stream:
            stream.write(data)
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror})") from None


def replace_file(path: Path, source: Path) -> None:
    """Put the content of `source` at `path`, whole or not at all; `source` may be on another file system."""
    write_bytes(path, source.read_bytes())


def write_text(path: Path, text: str) -> None:
    """`write_bytes` of the text in UTF-8."""
    write_bytes(path, text.encode("utf-8"))


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
