"""The `.scan` file of a scan: every finished run a row, so that a killed scan resumes where it was.

    meta     key, value                     'fingerprint' tells whether the same scan is resumed
    run      job, label, outcome, time, statistics      statistics: JSON
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from contin.errors import InputError

APPLICATION_ID: Final = 0x636F6E73  # "cons"
SCHEMA: Final = """
CREATE TABLE meta (key TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE run (job INTEGER PRIMARY KEY, label TEXT NOT NULL, outcome TEXT NOT NULL, time REAL NOT NULL,
                  statistics TEXT NOT NULL);
"""
TOGETHER: Final = 50  # runs a transaction


class ScanStore:
    """Rows of finished runs; `rows` are those of the earlier scan that is resumed."""

    def __init__(self, path: Path, mark: str, resume: bool) -> None:
        self.path = path
        self.rows: dict[int, tuple[str, str, float, Mapping[str, Any]]] = {}
        self._pending = 0
        if resume and not path.is_file():
            raise InputError(f"{path}: there is no scan to resume; run without --resume")
        if not resume:
            path.unlink(missing_ok=True)
        try:
            self._connection = sqlite3.connect(path, timeout=0.5)
            self._connection.execute("PRAGMA journal_mode = WAL")
            if resume:
                self._read(mark)
            else:
                self._connection.executescript(SCHEMA)
                self._connection.execute(f"PRAGMA application_id = {APPLICATION_ID}")
                self._connection.execute("INSERT INTO meta VALUES ('fingerprint', ?)", (mark,))
                self._connection.commit()
        except sqlite3.Error as error:
            raise InputError(f"{path}: cannot be used as the store of a scan ({error})") from None

    def _read(self, mark: str) -> None:
        if self._connection.execute("PRAGMA application_id").fetchone()[0] != APPLICATION_ID:
            raise InputError(f"{self.path}: not the store of a scan")
        known = self._connection.execute("SELECT value FROM meta WHERE key = 'fingerprint'").fetchone()
        if known is None or known[0] != mark:
            raise InputError(
                f"{self.path}: holds another scan (the model, the scan file or contin changed since); "
                "run without --resume to start anew"
            )
        for job, label, outcome, time, statistics in self._connection.execute("SELECT * FROM run"):
            self.rows[job] = label, outcome, time, json.loads(statistics)

    def add(self, job: int, label: str, outcome: str, time: float, statistics: Mapping[str, float]) -> None:
        """Keep one run; it is on the disk after at most `TOGETHER` of them."""
        row = (job, label, outcome, time, json.dumps(dict(statistics)))
        self._connection.execute("INSERT OR REPLACE INTO run VALUES (?, ?, ?, ?, ?)", row)
        self._pending += 1
        if self._pending >= TOGETHER:
            self._connection.commit()
            self._pending = 0

    def close(self) -> None:
        self._connection.commit()
        self._connection.close()
