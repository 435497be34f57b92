"""The `.scan` file of a scan: every finished run a row, so that a killed scan resumes where it was.

    meta     key, value        'fingerprint': whether the same scan is resumed; 'head': JSON, what was asked for
    run      job, label, outcome, time, statistics (JSON)

SQLite in write-ahead mode: a process that is killed leaves all that was committed, at most a second before.
"""

from __future__ import annotations

import json
import sqlite3
import time
from collections.abc import Mapping
from contextlib import closing
from pathlib import Path
from typing import Any, Final

from contin.errors import InputError
from contin.simulate.scan.grid import Outcome, table

APPLICATION_ID: Final = 0x636F6E73  # "cons"
SCHEMA: Final = """
CREATE TABLE meta (key TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE run (job INTEGER PRIMARY KEY, label TEXT NOT NULL, outcome TEXT NOT NULL, time REAL NOT NULL,
                  statistics TEXT NOT NULL);
"""
LATEST: Final = 1.0  # seconds after which finished runs are committed


class ScanStore:
    """Rows of finished runs; `rows` are those of the earlier scan that is resumed."""

    def __init__(self, path: Path, mark: str, head: Mapping[str, Any], resume: bool) -> None:
        self.path = path
        self.rows: dict[int, Outcome] = {}
        self._committed = time.monotonic()
        if not resume:
            for ending in ("", "-wal", "-shm"):
                path.with_name(path.name + ending).unlink(missing_ok=True)
        elif not path.is_file():
            raise InputError(f"{path}: there is no scan to resume; run without --resume")
        try:
            self._connection = sqlite3.connect(path, timeout=0.5)
            self._connection.execute("PRAGMA journal_mode = WAL")
            self._connection.execute("PRAGMA synchronous = NORMAL")
            if resume:
                self._resume(mark)
            else:
                self._connection.executescript(SCHEMA)
                self._connection.execute(f"PRAGMA application_id = {APPLICATION_ID}")
                entries = [("fingerprint", mark), ("head", json.dumps(head))]
                self._connection.executemany("INSERT INTO meta VALUES (?, ?)", entries)
                self._connection.commit()
        except sqlite3.Error as error:
            raise InputError(f"{path}: cannot be used as the store of a scan ({error})") from None

    def _resume(self, mark: str) -> None:
        known = _meta(self._connection, self.path, "fingerprint")
        if known != mark:
            raise InputError(
                f"{self.path}: holds another scan (the model, the scan file or contin changed since); "
                "run without --resume to start anew"
            )
        self.rows = _rows(self._connection)

    def add(self, job: int, outcome: Outcome) -> None:
        """Keep one run; it is on the disk a second later at most, if another one follows."""
        row = (job, outcome.label, outcome.outcome, outcome.time, json.dumps(dict(outcome.statistics)))
        self._connection.execute("INSERT OR REPLACE INTO run VALUES (?, ?, ?, ?, ?)", row)
        if time.monotonic() - self._committed > LATEST:
            self._connection.commit()
            self._committed = time.monotonic()

    def close(self) -> None:
        """Commit, and leave one file."""
        self._connection.commit()
        self._connection.execute("PRAGMA journal_mode = DELETE")
        self._connection.close()


def read_scan(path: Path) -> dict[str, Any]:
    """The document of a scan, finished or not; InputError for any other file."""
    if not path.is_file():
        raise InputError(f"{path}: there is no such file")
    try:
        with closing(sqlite3.connect(f"file:{path}?mode=ro", uri=True, timeout=0.5)) as connection:
            head = json.loads(_meta(connection, path, "head"))
            rows = _rows(connection)
    except (sqlite3.Error, ValueError) as error:
        raise InputError(f"{path}: not the store of a scan ({error})") from None
    return {**head, "columns": table(head["scan"], rows)}


def _meta(connection: sqlite3.Connection, path: Path, key: str) -> str:
    if connection.execute("PRAGMA application_id").fetchone()[0] != APPLICATION_ID:
        raise InputError(f"{path}: not the store of a scan")
    found = connection.execute("SELECT value FROM meta WHERE key = ?", (key,)).fetchone()
    if found is None:
        raise InputError(f"{path}: not the store of a scan (it has no {key})")
    return str(found[0])


def _rows(connection: sqlite3.Connection) -> dict[int, Outcome]:
    return {
        job: Outcome(label, outcome, end, {k: float("nan") if v is None else v for k, v in json.loads(stats).items()})
        for job, label, outcome, end, stats in connection.execute("SELECT * FROM run")
    }
