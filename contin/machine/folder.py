"""The folders of machine code and of models, derived and compiled: where they are, and whether they can be trusted.

Whoever can write there can make this process run what they like. So a folder is used only if it is a real directory
that belongs to this user and that nobody else may enter (mode 0700), and it is opened once: what is read and written
goes through that opened directory, whatever its path is made to mean later. Without such a folder contin works from
memory, and says so in `contin kernels where`.
"""

from __future__ import annotations

import os
import stat
import sys
import uuid
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Final

MACHINE_CODE: Final = "machine-code"
DERIVED: Final = "derived-models"
COMPILED: Final = "compiled-models"
BY_DESCRIPTOR: Final = os.open in os.supports_dir_fd and os.name == "posix"


def place(name: str = MACHINE_CODE) -> Path | None:
    """Where a folder is, or would be; `CONTIN_CACHE_DIR` says otherwise. None for a user without a home."""
    chosen = os.environ.get("CONTIN_CACHE_DIR")
    if chosen:
        return Path(chosen) / name
    try:
        if sys.platform == "win32":
            base = Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
        elif sys.platform == "darwin":
            base = Path.home() / "Library" / "Caches"
        else:
            base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    except RuntimeError:  # no home, and no entry for this user
        return None
    return base / "contin" / name


@dataclass(frozen=True)
class Folder:
    """An opened folder of files that are written whole or not at all."""

    path: Path
    descriptor: int | None

    def read(self, name: str) -> bytes | None:
        """A file's bytes; None where it cannot be read."""
        try:
            with open(self._at(name), "rb", opener=self._open) as file:
                return file.read()
        except OSError:
            return None

    def write(self, name: str, data: bytes) -> bool:
        """Put a file there, whole; False where that fails (a full disk): nothing is lost but time."""
        temporary = f".{uuid.uuid4().hex}"
        try:
            with open(self._at(temporary), "xb", opener=self._open) as file:
                file.write(data)
            os.replace(self._at(temporary), self._at(name), src_dir_fd=self.descriptor, dst_dir_fd=self.descriptor)
        except OSError:
            self.remove(temporary)
            return False
        return True

    def remove(self, name: str) -> None:
        """Delete a file, if it is there and can be."""
        with suppress(OSError):
            os.unlink(self._at(name), dir_fd=self.descriptor)

    def names(self) -> list[str]:
        """The files in it."""
        try:
            return sorted(os.listdir(self.path if self.descriptor is None else self.descriptor))
        except OSError:
            return []

    def thin_out(self, most: int) -> None:
        """Delete the oldest files beyond this many."""
        names = self.names()
        if len(names) > most:
            for name in sorted(names, key=self._age)[: len(names) - most]:
                self.remove(name)

    def _age(self, name: str) -> int:
        try:
            return os.stat(self._at(name), dir_fd=self.descriptor).st_mtime_ns
        except OSError:
            return 0

    @contextmanager
    def building(self, there: Callable[[], bool]) -> Iterator[None]:
        """One process makes code at a time; another one waits for its end, or until what it needs is `there`."""
        from filelock import FileLock, Timeout

        lock = FileLock(self.path / "building", thread_local=False)
        while True:
            try:
                lock.acquire(timeout=0.5)
                break
            except Timeout:
                if there():
                    break
            except (OSError, NotImplementedError):  # a file system without locks: the same code may be made twice
                break
        try:
            yield
        finally:
            lock.release()

    def _at(self, name: str) -> str:
        return name if self.descriptor is not None else str(self.path / name)

    def _open(self, name: str, flags: int) -> int:
        return os.open(name, flags | getattr(os, "O_NOFOLLOW", 0), 0o600, dir_fd=self.descriptor)


@cache
def folder(name: str = MACHINE_CODE) -> Folder | None:
    """This user's folder, made if need be; None where there is none that can be trusted."""
    return open_folder(place(name))


def open_folder(path: Path | None) -> Folder | None:
    """The folder at a path, made if need be; None unless it is this user's alone."""
    if path is None:
        return None
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with suppress(FileExistsError):
            path.mkdir(mode=0o700)
        if not BY_DESCRIPTOR:
            return Folder(path, None) if path.is_dir() and not path.is_symlink() else None
        descriptor = os.open(path, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    except OSError:
        return None
    found = os.fstat(descriptor)
    if found.st_uid != os.getuid() or stat.S_IMODE(found.st_mode) != 0o700:
        os.close(descriptor)
        return None
    return Folder(path, descriptor)
