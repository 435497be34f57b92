"""One writer for each result file: a lock that ends with its process, whatever ends that.

The lock is on a hidden file beside the result (`.NAME.lock`), not on the result itself, which is replaced while the
lock is held.
"""

from __future__ import annotations

import os
import sqlite3
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from contin.errors import InputError
from contin.store.sqlite import in_words

IN_USE = "in use by another process; wait for it, or save under another name"


class Lock:
    """Held from its making until `release`, or until the process ends.

    Raises
    ------
    InputError
        Another process holds it, or the folder may not be written to.
    """

    def __init__(self, path: Path) -> None:
        self.path = path.with_name(f".{path.name}.lock")
        while True:
            try:
                handle = os.open(self.path, os.O_RDWR | os.O_CREAT, 0o666)
            except OSError as error:
                raise InputError(
                    f"{path}: cannot be written ({error.strerror}); the folder must exist and be writable"
                ) from None
            if not _locked(handle):
                os.close(handle)
                raise InputError(f"{path}: {IN_USE}")
            if self._is_still(handle):  # not removed between opening and locking
                self._handle: int | None = handle
                return
            os.close(handle)

    def _is_still(self, handle: int) -> bool:
        try:
            return os.path.samestat(os.fstat(handle), os.stat(self.path))
        except OSError:
            return False

    def release(self) -> None:
        """Let others write; may be called twice."""
        handle, self._handle = self._handle, None
        if handle is None:
            return
        with suppress(OSError):  # Windows removes no file that is open
            self.path.unlink()
        os.close(handle)
        with suppress(OSError):
            if sys.platform == "win32":
                self.path.unlink()


if sys.platform == "win32":
    import msvcrt

    def _locked(handle: int) -> bool:
        try:
            msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
        except OSError:
            return False
        return True

else:
    import errno
    import fcntl

    def _locked(handle: int) -> bool:
        """False where another holds it; a file system without locks cannot tell, and counts as free."""
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            return error.errno not in (errno.EWOULDBLOCK, errno.EACCES, errno.EAGAIN)
        return True


@contextmanager
def opening(lock: Lock, path: Path) -> Iterator[None]:
    """While a result file is opened: the lock is released where that fails, and what a database says is put in words.

    Raises
    ------
    InputError
        The file cannot be read or written.
    """
    try:
        yield
    except (sqlite3.Error, UnicodeDecodeError) as error:
        lock.release()
        raise InputError(in_words(path, error)) from None
    except BaseException:
        lock.release()
        raise
