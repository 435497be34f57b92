"""The `.contin` file of a run that is not finished: every chunk in its own transaction, finished branches beside them.

    meta     key, value     as in a finished file; 'unfinished' (true); 'fingerprint': whether the same run is resumed
    chunk    number (in all), arm, place (in its arm), header, data, sha256
             header: JSON of the scalars and the arrays' shapes; data: the arrays' bytes; sha256: of all these and of
             the sha256 of the chunk before, so that a chunk that is damaged, missing or out of order is found
    branch, series, checksum     the branches that are finished, as in a finished file

The file is in write-ahead mode and locked while a run writes it; a process that is killed leaves every chunk whose
transaction was committed. It stands at the place of the result, or beside an earlier result (NAME.contin.unfinished),
which stays until the run has ended and the finished file (`contin.store.sqlite`) takes its place.
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contin.continuation.sample import Chunk, Stop
from contin.errors import InputError
from contin.records import Fields, Record
from contin.store.digest import parts_digest
from contin.store.json_format import FORMAT_VERSION, branch_document
from contin.store.lock import Lock, opening
from contin.store.places import State, cleared, discard, states_of
from contin.store.sqlite import APPLICATION_ID, begin, in_words, insert_branch, insert_meta

if TYPE_CHECKING:
    from contin.continuation.branch import Branch
    from contin.continuation.sample import Chunk

_CHUNKS: Final = (
    "CREATE TABLE chunk (number INTEGER PRIMARY KEY, arm TEXT NOT NULL, place INTEGER NOT NULL, header TEXT NOT NULL, "
    "data BLOB NOT NULL, sha256 TEXT NOT NULL, UNIQUE (arm, place));"
)


def fingerprint(*texts: str) -> str:
    """Of all that determines a run: model, run file, overrides, versions."""
    return parts_digest(*texts)


class Kept(NamedTuple):
    """A row of `chunk` without its number."""

    arm: str
    place: int
    header: str
    data: bytes
    sha256: str


class SqliteJournal:
    """A `contin.continuation.journal.Journal` in an SQLite file.

    `trouble` says why it stopped keeping, if it did; `notes` what of the earlier run was damaged and is computed anew.
    """

    def __init__(self, path: Path, mark: str, resume: bool, model: Record | None = None) -> None:
        self.path, self.trouble, self.replayed = path, "", 0
        self.notes: list[str] = []
        self._lock = Lock(path)
        with opening(self._lock, path):
            self._open(mark, resume, model or {})
            self._branches = dict(self._connection.execute("SELECT name, position FROM branch").fetchall())
            found = self._connection.execute("SELECT number, sha256 FROM chunk ORDER BY number DESC LIMIT 1").fetchone()
            self._number: int = 0 if found is None else found[0] + 1
            self._last: str = "" if found is None else found[1]

    def _open(self, mark: str, resume: bool, model: Record) -> None:
        """The file of the earlier run if it is resumed, or a new one: where nothing stands, else beside."""
        states = states_of(self.path, APPLICATION_ID)
        for place, state in states.items():
            if resume and state is State.DAMAGED:
                self.notes.append(f"{place.name}: damaged, cannot be read: computed anew")
            elif resume and state is State.UNFINISHED:
                self.place = place
                self._go_on(mark)
                return
        self.place = cleared(self.path, states[self.path])
        self._begin(mark, model)

    def _begin(self, mark: str, model: Record) -> None:
        self._connection = _connected(self.place)
        self._connection.execute("BEGIN IMMEDIATE")
        begin(self._connection)
        self._connection.execute(_CHUNKS)
        head = {"contin": FORMAT_VERSION, "model": dict(model), "unfinished": True, "fingerprint": mark}
        for key, value in head.items():
            insert_meta(self._connection, key, value)
        self._connection.execute("COMMIT")

    def _go_on(self, mark: str) -> None:
        """Open the file of the earlier run; chunks from the first damaged one on are dropped."""
        whole, damage = 0, ""
        with closing(_connected(self.place)) as connection:
            known = connection.execute("SELECT value FROM meta WHERE key = 'fingerprint'").fetchone()
            model = connection.execute("SELECT value FROM meta WHERE key = 'model'").fetchone()
            try:
                whole = sum(1 for _ in _whole(connection))
                there = connection.execute("SELECT count(*) FROM chunk").fetchone()[0]
                damage = f"{there - whole} of {there} stored parts" if there > whole else _pages(connection)
            except (sqlite3.Error, UnicodeDecodeError) as error:
                damage = f"a stored part ({error})"
            kept = _taken(connection, whole) if damage else []
        if known is None or known[0] != json.dumps(mark):
            raise InputError(
                f"{self.path}: the unfinished run was another one (the model, the run file or contin changed since); "
                "run without --resume to start anew"
            )
        if damage:
            self.notes.append(
                f"{self.path.name}: {damage} of the unfinished run failed the check, or followed one that did: "
                "computed anew"
            )
            discard(self.place)
            self._begin(mark, json.loads(model[0]) if model else {})
            rows = [(number, *chunk) for number, chunk in enumerate(kept)]
            self._connection.execute("BEGIN")
            self._connection.executemany("INSERT INTO chunk VALUES (?, ?, ?, ?, ?, ?)", rows)
            self._connection.execute("COMMIT")
        else:
            self._connection = _connected(self.place)

    def replay(self, key: str, number: int) -> Chunk | None:
        row = self._connection.execute("SELECT header, data FROM chunk WHERE arm = ? AND place = ?", (key, number))
        found = row.fetchone()
        if found is None:
            return None
        self.replayed += 1
        return unpacked(json.loads(found[0]), found[1])

    def record(self, key: str, number: int, chunk: Chunk) -> None:
        if self.trouble:
            return
        scalars, data = packed(chunk)
        header = json.dumps(scalars)
        digest = parts_digest(self._last, key, number, header, data)
        try:
            values = (self._number, key, number, header, data, digest)
            self._connection.execute("INSERT INTO chunk VALUES (?, ?, ?, ?, ?, ?)", values)
            self._number, self._last = self._number + 1, digest
        except sqlite3.Error as error:  # the computation goes on: what is in memory can still be written elsewhere
            self.trouble = f"{in_words(self.path, error)}; the run went on without it"

    def finished(self, branch: Branch) -> None:
        """Keep a whole branch, readable (`contin.store.sqlite.load`) before the run is over."""
        if self.trouble:
            return
        position = self._branches.setdefault(branch.name, len(self._branches))
        try:
            self._connection.execute("BEGIN")
            insert_branch(self._connection, position, branch_document(branch))
            self._connection.execute("COMMIT")
        except sqlite3.Error as error:
            self.trouble = f"{in_words(self.path, error)}; the run went on without it"
            if self._connection.in_transaction:
                self._connection.execute("ROLLBACK")

    def rest(self) -> None:
        """Fold the write-ahead log into the file: it can be replaced now. Its place stays locked until `close`."""
        self._connection.close()

    def give_up(self) -> None:
        """The user wants no result now: `--resume` can still finish it."""

    def close(self, saved: bool = False) -> None:
        """Let others write here; what was kept beside is removed once the finished result is `saved` at its place."""
        self._connection.close()
        if saved and self.place != self.path:
            discard(self.place)
        self._lock.release()


def _connected(place: Path) -> sqlite3.Connection:
    connection = sqlite3.connect(place, isolation_level=None, timeout=0.2)
    connection.execute("PRAGMA locking_mode = EXCLUSIVE")
    connection.execute("PRAGMA journal_mode = WAL")
    connection.execute("PRAGMA synchronous = NORMAL")
    return connection


def _pages(connection: sqlite3.Connection) -> str:
    """What SQLite finds wrong with the file's structure: an index may miss what the table has; empty if nothing."""
    found = [str(row[0]) for row in connection.execute("PRAGMA integrity_check(1)")]
    return "" if found == ["ok"] else f"a stored part ({found[0]})"


def _rows(connection: sqlite3.Connection) -> Iterator[tuple[int, Kept]]:
    query = "SELECT number, arm, place, header, data, sha256 FROM chunk ORDER BY number"
    for number, *row in connection.execute(query):
        yield number, Kept(*row)


def _whole(connection: sqlite3.Connection) -> Iterator[Kept]:
    """The chunks up to the first that is damaged, missing or out of order."""
    last = ""
    for expected, (number, kept) in enumerate(_rows(connection)):
        if number != expected or not isinstance(kept.data, bytes) or kept.sha256 != parts_digest(last, *kept[:4]):
            return
        last = kept.sha256
        yield kept


def _taken(connection: sqlite3.Connection, count: int) -> list[Kept]:
    return [kept for _, kept in zip(range(count), _whole(connection), strict=False)]


def packed(chunk: Chunk) -> tuple[Fields, bytes]:
    """A chunk as JSON-ready scalars (with the arrays' types and shapes) and the arrays' bytes, one after the other."""
    scalars: Fields = {}
    arrays: dict[str, list[object]] = {}
    data = []
    for field in fields(chunk):
        if field.name == "gauge":
            continue
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


def unpacked(header: Record, data: bytes) -> Chunk:
    """The chunk that `packed` took apart, bit for bit."""
    values: Fields = dict(header["scalars"])
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
