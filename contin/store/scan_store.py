"""The `.scan` file of a scan: every finished run a row, so that a killed scan resumes where it was.

    meta     key, value        'fingerprint': whether the same scan is resumed; 'head': JSON, what was asked for;
                               'sha256': of these two; 'unfinished' until the scan has ended
    run      job, label, outcome, time, statistics (JSON), checksum (the first 8 bytes of the row's SHA-256)

SQLite in write-ahead mode: a process that is killed leaves all that was committed, at most a second before. The file is
locked while a scan writes it. It stands at the place of the result, or beside an earlier result (NAME.scan.unfinished),
which stays until the scan has ended. Rows that fail their checksum count as not computed.
"""

from __future__ import annotations

import json
import os
import sqlite3
import time
from contextlib import closing
from pathlib import Path
from typing import Final

from contin.errors import InputError
from contin.records import Fields, Record
from contin.simulate.scan.grid import Outcome, table
from contin.store.atomic import flush_folder
from contin.store.digest import NO_CHECKSUMS, parts_digest, warn_of
from contin.store.lock import Lock, opening
from contin.store.places import State, cleared, discard, states_of
from contin.store.sqlite import in_words

APPLICATION_ID: Final = 0x636F6E73  # "cons"
SCHEMA: Final = (
    "CREATE TABLE meta (key TEXT PRIMARY KEY, value TEXT NOT NULL)",
    """CREATE TABLE run (job INTEGER PRIMARY KEY, label TEXT NOT NULL, outcome TEXT NOT NULL, time REAL NOT NULL,
                  statistics TEXT NOT NULL, checksum INTEGER NOT NULL)""",
    f"PRAGMA application_id = {APPLICATION_ID}",
)
LATEST: Final = 1.0  # seconds after which finished runs are committed


class ScanStore:
    """Rows of finished runs; `rows` are those of the earlier scan that is resumed.

    `trouble` says why it stopped keeping, if it did; `notes` what of the earlier scan was damaged.
    """

    def __init__(self, path: Path, mark: str, head: Record, resume: bool) -> None:
        self.path, self.trouble = path, ""
        self.notes: list[str] = []
        self.rows: dict[int, Outcome] = {}
        self._committed = time.monotonic()
        self._lock = Lock(path)
        with opening(self._lock, path):
            self._open(mark, json.dumps(head), resume)

    def _open(self, mark: str, head: str, resume: bool) -> None:
        states = states_of(self.path, APPLICATION_ID)
        earlier = next((p for p, state in states.items() if state in (State.UNFINISHED, State.FINISHED)), None)
        damaged = [place.name for place, state in states.items() if state is State.DAMAGED]
        if resume and earlier is None and not damaged:
            raise InputError(f"{self.path}: there is no scan to resume; run without --resume")
        if resume and earlier is not None:
            self.place = earlier
            self._connection = _connected(earlier)
            self._go_on(mark, head)
            return
        if resume:
            self.notes.append(f"{', '.join(damaged)}: damaged, cannot be read: computed anew")
        self.place = cleared(self.path, states[self.path])
        self._begin(mark, head)

    def _begin(self, mark: str, head: str) -> None:
        self._connection = _connected(self.place)
        self._connection.execute("BEGIN IMMEDIATE")
        for statement in SCHEMA:
            self._connection.execute(statement)
        entries = {"fingerprint": mark, "head": head, "sha256": parts_digest(mark, head), "unfinished": "true"}
        self._connection.executemany("INSERT INTO meta VALUES (?, ?)", entries.items())
        self._connection.execute("COMMIT")
        self._connection.execute("BEGIN")

    def _go_on(self, mark: str, head: str) -> None:
        """Take over what is whole; where anything is not, it goes into a new file."""
        damage = ""
        try:
            meta = dict(self._connection.execute("SELECT key, value FROM meta").fetchall())
            if meta.get("fingerprint") != mark:
                raise InputError(
                    f"{self.path}: holds another scan (the model, the scan file or contin changed since), or is "
                    "damaged; run without --resume to start anew"
                )
            self.rows, bad = _rows(self._connection)
            damage = f"{bad} of {bad + len(self.rows)} stored runs" if bad else ""
            if meta.get("sha256") != parts_digest(mark, meta.get("head", "")):
                damage = damage or "what was asked for, as stored,"
        except (sqlite3.Error, UnicodeDecodeError) as error:
            damage = f"a stored part ({error})"
        if not damage:
            self._connection.execute("BEGIN")
            return
        self.notes.append(f"{self.path.name}: {damage} failed the check: computed anew")
        self._connection.close()
        discard(self.place)
        self._begin(mark, head)
        rows = [_row(job, outcome) for job, outcome in self.rows.items()]
        self._connection.executemany("INSERT INTO run VALUES (?, ?, ?, ?, ?, ?)", rows)
        self._commit()

    def add(self, job: int, outcome: Outcome) -> None:
        """Keep one run; it is on the disk a second later at most, if another one follows."""
        if self.trouble:
            return
        try:
            self._connection.execute("INSERT OR REPLACE INTO run VALUES (?, ?, ?, ?, ?, ?)", _row(job, outcome))
            if time.monotonic() - self._committed > LATEST:
                self._commit()
        except sqlite3.Error as error:
            self.trouble = f"{in_words(self.path, error)}; the scan went on without it"

    def _commit(self) -> None:
        self._connection.execute("COMMIT")
        self._connection.execute("BEGIN")
        self._committed = time.monotonic()

    def close(self, complete: bool = False) -> None:
        """Commit, and leave one file; if the scan is `complete`, at the place of the result."""
        try:
            if not self.trouble:
                if complete:
                    self._connection.execute("DELETE FROM meta WHERE key = 'unfinished'")
                self._connection.execute("COMMIT")
                self._connection.execute("PRAGMA journal_mode = DELETE")
            self._connection.close()
            if complete and not self.trouble and self.place != self.path:
                os.replace(self.place, self.path)
                flush_folder(self.path.parent)
        except (sqlite3.Error, OSError) as error:
            self.trouble = in_words(self.path, error) if isinstance(error, sqlite3.Error) else f"{self.path}: {error}"
        finally:
            self._connection.close()
            self._lock.release()


def read_scan(path: Path) -> Fields:
    """The document of a scan, finished or not; InputError for any other file.

    Runs that fail their checksum are left out, with a note (`notes`) and a warning.
    """
    if not path.is_file():
        raise InputError(f"{path}: there is no such file")
    try:
        with closing(sqlite3.connect(f"{path.resolve().as_uri()}?mode=ro", uri=True, timeout=0.5)) as connection:
            if connection.execute("PRAGMA application_id").fetchone()[0] != APPLICATION_ID:
                raise InputError(f"{path}: not the store of a scan")
            meta = dict(connection.execute("SELECT key, value FROM meta").fetchall())
            if "sha256" in meta and meta["sha256"] != parts_digest(meta.get("fingerprint", ""), meta.get("head", "")):
                raise InputError(f"{path}: damaged: what was asked for fails its checksum")
            head = json.loads(meta["head"])
            rows, bad = _rows(connection)
        columns = table(head["scan"], rows)
    except InputError:
        raise
    except (sqlite3.Error, ValueError, KeyError, TypeError, IndexError, RecursionError, AttributeError) as error:
        raise InputError(f"{path}: not the store of a scan, or damaged ({error})") from None
    notes = [] if "sha256" in meta else [NO_CHECKSUMS]
    notes += [f"damaged: {bad} runs fail their checksum and are left out"] if bad else []
    warn_of(path, notes)
    return {**head, "columns": columns, **({"notes": notes} if notes else {})}


def _connected(place: Path) -> sqlite3.Connection:
    connection = sqlite3.connect(place, isolation_level=None, timeout=0.5)
    connection.execute("PRAGMA journal_mode = WAL")
    connection.execute("PRAGMA synchronous = NORMAL")
    return connection


def _row(job: int, outcome: Outcome) -> tuple[int, str, str, float, str, int]:
    statistics = json.dumps(dict(outcome.statistics))
    content = (job, outcome.label, outcome.outcome, float(outcome.time), statistics)
    return (*content, _checksum(*content))


def _checksum(job: int, label: str, outcome: str, end: float, statistics: str) -> int:
    digest = parts_digest(job, label, outcome, repr(float(end)), statistics)
    return int.from_bytes(bytes.fromhex(digest[:16]), "big", signed=True)


def _rows(connection: sqlite3.Connection) -> tuple[dict[int, Outcome], int]:
    """The runs that are whole, and how many are not."""
    columns = [row[1] for row in connection.execute("PRAGMA table_info(run)")]
    rows: dict[int, Outcome] = {}
    bad = 0
    for job, label, outcome, end, stats, *checksum in connection.execute("SELECT * FROM run"):
        sound = isinstance(end, float) and checksum == [_checksum(job, label, outcome, end, stats)]
        if len(columns) > 5 and not sound:
            bad += 1
            continue
        values = {k: float("nan") if v is None else v for k, v in json.loads(stats).items()}
        rows[job] = Outcome(label, outcome, end, values)
    return rows, bad
