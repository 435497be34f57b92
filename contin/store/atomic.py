"""Files that are replaced whole: a reader, a crash or a power failure never leaves half of one.

The new content is written beside the file, flushed to the disk (fsync), and only then renamed; the folder, which holds
the names, is flushed after the renaming.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from contin.errors import InputError


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A new, empty file beside `path`, which takes its place when the block ends without an error.

    A symbolic link is followed. On an error the earlier file is left as it was, and the new one is removed.

    Raises
    ------
    InputError
        The folder is missing or may not be written to, the disk is full, or `path` is a pipe or a device.
    """
    if path.is_symlink():
        path = _resolved(path)
    if is_special(path):
        raise InputError(f"{path}: is a pipe or a device; name a file")
    temporary: Path | None = None
    try:
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=".part")
        os.close(handle)
        temporary = Path(name)
        yield temporary
        _flush(temporary)
        os.chmod(temporary, 0o666 & ~_umask())  # mkstemp makes files that only their owner can read
        os.replace(temporary, path)
        temporary = None
        flush_folder(path.parent)
    except OSError as error:
        advice = "" if temporary else "; the folder must exist and be writable"
        raise InputError(f"{path}: cannot be written ({error.strerror or error}){advice}") from None
    finally:
        if temporary is not None:
            with suppress(OSError):
                temporary.unlink()


def write_bytes(path: Path, data: bytes) -> None:
    """Replace `path` by these bytes; what is not a file (a pipe, a device such as /dev/stdout) is written to instead.

    Raises
    ------
    InputError
        The folder is missing or may not be written to, or the disk is full; an earlier file is left as it was.
    """
    if is_special(path):
        _write_through(path, data)
        return
    with replacing(path) as temporary:
        temporary.write_bytes(data)


def is_special(path: Path) -> bool:
    """True for pipes and devices, which are written to and never replaced."""
    return path.exists() and not path.is_file() and not path.is_dir()


def write_text(path: Path, text: str) -> None:
    """`write_bytes` of the text in UTF-8; halves of surrogate pairs, which it has no form for, as `?`."""
    write_bytes(path, text.encode("utf-8", "replace"))


def flush_folder(folder: Path) -> None:
    """Flush a folder's names to the disk, where the system can do that."""
    with suppress(OSError):  # Windows does not open folders
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def _flush(path: Path) -> None:
    handle = os.open(path, os.O_RDWR)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


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


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
