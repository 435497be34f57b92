"""The `.contin` file of a run that is not finished: every chunk in its own transaction, finished branches beside them.

    meta     key, value     'unfinished' is true; 'fingerprint' tells whether the same run is resumed
    chunk    arm, number, header, data      header: JSON of the scalars and the arrays' shapes; data: the arrays' bytes

The file is in write-ahead mode and locked while a run writes it; a process that is killed, however, leaves every chunk
whose transaction was committed. When the run ends, the file is replaced by the finished one (`contin.store.sqlite`).
"""

from __future__ import annotations

import hashlib
import json
import sqlite3
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.errors import InputError
from contin.store.json_format import FORMAT_VERSION
from contin.store.sqlite import APPLICATION_ID, SCHEMA

if TYPE_CHECKING:
    from contin.continuation.problem import Chunk

_CHUNKS: Final = (
    "CREATE TABLE chunk (arm TEXT, number INTEGER, header TEXT NOT NULL, data BLOB, PRIMARY KEY (arm, number))"
)


def fingerprint(*texts: str) -> str:
    """Of all that determines a run: model, run file, overrides, versions."""
    digest = hashlib.sha256()
    for text in texts:
        digest.update(text.encode())
        digest.update(b"\0")
    return digest.hexdigest()


class SqliteJournal:
    """A `contin.continuation.journal.Journal` in an SQLite file; `trouble` says why it stopped keeping, if it did."""

    def __init__(self, path: Path, mark: str, resume: bool) -> None:
        self.path, self.trouble = path, ""
        self.replayed = 0
        unfinished = path.exists() and _is_unfinished(path)  # also refuses a file that another process writes
        resume = resume and unfinished  # killed before anything was kept: begin anew
        if not resume:
            _discard(path)
        try:
            self._connection = sqlite3.connect(path, isolation_level=None, timeout=0.2)
            self._connection.execute("PRAGMA locking_mode = EXCLUSIVE")
            self._connection.execute("PRAGMA journal_mode = WAL")
            self._connection.execute("PRAGMA synchronous = NORMAL")
            if not resume:
                self._begin(mark)
            elif self._meta("fingerprint") != mark:
                raise InputError(
                    f"{path}: the unfinished run was another one (the model, the run file or contin changed since); "
                    "run without --resume to start anew"
                )
            self._connection.execute("BEGIN IMMEDIATE")
            self._connection.execute("COMMIT")
        except sqlite3.Error as error:
            raise InputError(_in_words(path, error)) from None

    def _begin(self, mark: str) -> None:
        self._connection.executescript(f"BEGIN; {SCHEMA} {_CHUNKS}; COMMIT;")
        self._connection.execute(f"PRAGMA application_id = {APPLICATION_ID}")
        self._connection.execute(f"PRAGMA user_version = {FORMAT_VERSION}")
        for key, value in (("unfinished", True), ("fingerprint", mark)):
            self._connection.execute("INSERT INTO meta VALUES (?, ?)", (key, json.dumps(value)))

    def _meta(self, key: str) -> Any:
        row = self._connection.execute("SELECT value FROM meta WHERE key = ?", (key,)).fetchone()
        return None if row is None else json.loads(row[0])

    def replay(self, key: str, number: int) -> Chunk | None:
        row = self._connection.execute("SELECT header, data FROM chunk WHERE arm = ? AND number = ?", (key, number))
        found = row.fetchone()
        if found is None:
            return None
        self.replayed += 1
        return unpacked(json.loads(found[0]), found[1])

    def record(self, key: str, number: int, chunk: Chunk) -> None:
        if self.trouble:
            return
        header, data = packed(chunk)
        try:
            self._connection.execute("INSERT INTO chunk VALUES (?, ?, ?, ?)", (key, number, json.dumps(header), data))
        except sqlite3.Error as error:  # the computation goes on: what is in memory can still be written elsewhere
            self.trouble = f"{_in_words(self.path, error)}; the run went on without it"

    def close(self) -> None:
        """Fold the write-ahead log into the file and release it."""
        self._connection.close()


def packed(chunk: Chunk) -> tuple[dict[str, Any], bytes]:
    """A chunk as JSON-ready scalars (with the arrays' types and shapes) and the arrays' bytes, one after the other."""
    scalars: dict[str, Any] = {}
    arrays: dict[str, list[Any]] = {}
    data = []
    for field in fields(chunk):
        value = getattr(chunk, field.name)
        if isinstance(value, np.ndarray):
            whole = np.ascontiguousarray(value)
            arrays[field.name] = [whole.dtype.str, list(whole.shape)]
            data.append(whole.tobytes())
        elif field.name == "stop":
            scalars["stop"] = value.value
        else:
            scalars[field.name] = value
    return {"scalars": scalars, "arrays": arrays}, b"".join(data)


def unpacked(header: Mapping[str, Any], data: bytes) -> Chunk:
    """The chunk that `packed` took apart, bit for bit."""
    from contin.continuation.problem import Chunk, Stop

    values: dict[str, Any] = dict(header["scalars"])
    values["stop"] = Stop(values["stop"])
    position = 0
    for name, (kind, shape) in header["arrays"].items():
        dtype = np.dtype(kind)
        if dtype.hasobject:
            raise InputError("a result file holds numbers only; this one is damaged")
        size = dtype.itemsize * int(np.prod(shape, dtype=int))
        values[name] = np.frombuffer(data[position : position + size], dtype).reshape(shape).copy()
        position += size
    return Chunk(**values)


def _is_unfinished(path: Path) -> bool:
    try:
        connection = sqlite3.connect(f"{path.resolve().as_uri()}?mode=rw", uri=True, timeout=0.2)
        try:
            row = connection.execute("SELECT value FROM meta WHERE key = 'unfinished'").fetchone()
        finally:
            connection.close()
    except sqlite3.OperationalError as error:
        if "locked" in str(error):
            raise InputError(_in_words(path, error)) from None
        return False
    except sqlite3.Error:
        return False
    return row is not None


def _discard(path: Path) -> None:
    """Remove what an earlier run left at this place."""
    try:
        for suffix in ("", "-wal", "-shm"):
            Path(f"{path}{suffix}").unlink(missing_ok=True)
    except OSError as error:
        raise InputError(f"{path}: cannot be replaced ({error.strerror})") from None


def _in_words(path: Path, error: sqlite3.Error) -> str:
    text = str(error)
    if "locked" in text:
        return f"{path}: in use by another process; wait for it, or save under another name"
    if "full" in text:
        return f"{path}: the disk is full"
    if "unable to open" in text or "readonly" in text:
        return f"{path}: cannot be written; the folder must exist and be writable"
    return f"{path}: {text}"
