"""Results in one SQLite file (`.contin`): every branch a row, every column its bytes, readable with any SQLite tool.

meta     key, value                      JSON: contin (format version), model, built, notes, timing
branch   position, name, header          JSON of the branch without its columns
series   branch, position, name, kind, data      little-endian float64 ('f'), int64 ('i') or bytes 0/1 ('b')
equations, solution                      what runs start from (`contin.store.solution_tables`); may be absent
checksum part, sha256                    of the rows 'meta/KEY', 'branch/POSITION', 'series/POSITION/NAME'

A part whose checksum fails is never used: `load` leaves out the branch it belongs to, with a note and a warning.
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterable, Mapping
from contextlib import closing
from pathlib import Path
from typing import Final

import numpy as np

from contin.errors import FormatVersionError, InputError
from contin.records import Fields, Record
from contin.store.atomic import replacing
from contin.store.digest import NO_CHECKSUMS, parts_digest, warn_of
from contin.store.json_format import FORMAT_VERSION, plain
from contin.store.solution_tables import damaged, insert_solutions
from contin.store.solutions import Solutions
from contin.store.validate import validate

APPLICATION_ID: Final = 0x636F6E74  # "cont", so that `file` and other tools can tell these files apart
SCHEMA: Final = """
CREATE TABLE meta (key TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE branch (position INTEGER PRIMARY KEY, name TEXT NOT NULL, header TEXT NOT NULL);
CREATE TABLE series (branch INTEGER NOT NULL REFERENCES branch(position), position INTEGER NOT NULL,
                     name TEXT NOT NULL, kind TEXT NOT NULL CHECK (kind IN ('f', 'i', 'b')), data BLOB NOT NULL,
                     PRIMARY KEY (branch, name));
CREATE TABLE checksum (part TEXT PRIMARY KEY, sha256 TEXT NOT NULL);
"""
_TYPES: Final = {"f": "<f8", "i": "<i8", "b": "?"}
NEEDED: Final = ("contin", "model")  # without these a file tells nothing
DESCRIBING: Final = ("notes", "timing")
PROVENANCE: Final = ("model_text", "run", "versions")
UNFINISHED: Final = ("unfinished", "fingerprint")


def save(
    document: Record, path: Path, provenance: Mapping[str, str] | None = None, solutions: Solutions | None = None
) -> None:
    """Write a result document; an existing file is replaced whole, or not at all.

    `provenance` (of the names in `PROVENANCE`: the model's text, the run, versions) goes to the table `meta` too, for
    whoever opens the file later. `solutions` at the labelled points let later runs start from them.
    """
    with replacing(path) as temporary:
        try:
            with closing(sqlite3.connect(temporary)) as connection:
                connection.execute("PRAGMA journal_mode = OFF")  # a file that nobody sees until it is whole
                connection.execute("PRAGMA synchronous = OFF")
                with connection:
                    connection.execute("BEGIN")
                    begin(connection)
                    for key, value in document.items():
                        if key != "branches":
                            insert_meta(connection, key, value)
                    for key, text in (provenance or {}).items():
                        insert_meta(connection, key, text)
                    for position, branch in enumerate(document["branches"]):
                        insert_branch(connection, position, branch)
                    if solutions is not None:
                        insert_solutions(connection, solutions, [branch["name"] for branch in document["branches"]])
        except sqlite3.Error as error:
            raise InputError(in_words(path, error)) from None


def begin(connection: sqlite3.Connection) -> None:
    """The empty tables of a result file, within the transaction that is open."""
    for statement in SCHEMA.strip().split(";")[:-1]:
        connection.execute(statement)
    connection.execute(f"PRAGMA application_id = {APPLICATION_ID}")
    connection.execute(f"PRAGMA user_version = {FORMAT_VERSION}")


def insert_meta(connection: sqlite3.Connection, key: str, value: object) -> None:
    """One entry of the document that is not its branches, or of the provenance."""
    text = json.dumps(value)
    connection.execute("INSERT OR REPLACE INTO meta VALUES (?, ?)", (key, text))
    _sign(connection, f"meta/{key}", key, text)


def insert_branch(connection: sqlite3.Connection, position: int, branch: Record) -> None:
    """One branch and its columns, in place of what stood at this position."""
    connection.execute("DELETE FROM series WHERE branch = ?", (position,))
    connection.execute("DELETE FROM checksum WHERE part LIKE ?", (f"series/{position}/%",))
    header = json.dumps({key: value for key, value in branch.items() if key != "columns"})
    connection.execute("INSERT OR REPLACE INTO branch VALUES (?, ?, ?)", (position, branch["name"], header))
    _sign(connection, f"branch/{position}", branch["name"], header)
    for order, (name, column) in enumerate(branch["columns"].items()):
        kind, data = _packed(column)
        connection.execute("INSERT INTO series VALUES (?, ?, ?, ?, ?)", (position, order, name, kind, data))
        _sign(connection, f"series/{position}/{name}", order, kind, data)


def _sign(connection: sqlite3.Connection, part: str, *content: str | bytes | int) -> None:
    connection.execute("INSERT OR REPLACE INTO checksum VALUES (?, ?)", (part, parts_digest(part, *content)))


def _packed(column: list[object]) -> tuple[str, bytes]:
    if column and all(isinstance(value, bool) for value in column):
        kind = "b"
    elif column and all(isinstance(value, int) and not isinstance(value, bool) for value in column):
        kind = "i"
    else:
        kind = "f"  # None becomes NaN, and NaN is written as null again
    return kind, np.array(column, dtype=float if kind == "f" else None).astype(_TYPES[kind]).tobytes()


def load(path: Path) -> Fields:
    """Read a result document that `save` wrote.

    Branches of which a part fails its checksum are left out; a note of the document and a warning name them. Of a run
    that was not finished the branches that are; a note says so.

    Raises
    ------
    InputError
        The file cannot be read, is not a contin result, or is damaged where that concerns everything.
    FormatVersionError
        It was written in a newer format.
    """
    if not path.is_file():
        raise InputError(f"{path}: there is no such file")
    try:
        with closing(sqlite3.connect(f"{path.resolve().as_uri()}?mode=ro", uri=True, timeout=0.5)) as connection:
            if connection.execute("PRAGMA application_id").fetchone()[0] != APPLICATION_ID:
                raise InputError(f"{path}: not a contin result file")
            version = connection.execute("PRAGMA user_version").fetchone()[0]
            if version > FORMAT_VERSION:
                raise FormatVersionError(
                    f"{path}: written in format {version}; this contin reads up to {FORMAT_VERSION}"
                )
            document, notes = _document(connection, path)
    except InputError:
        raise
    except sqlite3.OperationalError as error:
        if "locked" in str(error):
            raise InputError(in_words(path, error)) from None
        raise InputError(f"{path}: not a contin result file, or damaged ({error})") from None
    except (sqlite3.Error, KeyError, ValueError, TypeError, AttributeError, RecursionError, OverflowError) as error:
        raise InputError(f"{path}: not a contin result file, or damaged ({error})") from None
    validate(document, path)
    warn_of(path, notes)
    document["notes"] = [*document["notes"], *(f"{path.name}: {note}" for note in notes)]
    return document


def _document(connection: sqlite3.Connection, path: Path) -> tuple[Fields, list[str]]:
    """The document of the branches that are whole, and a note on those that are not."""
    stored = _stored(connection)
    left = set(stored or ())
    notes = [] if stored is not None else [NO_CHECKSUMS]

    def good(part: str, *content: str | bytes | int) -> bool:
        left.discard(part)
        return stored is None or stored.get(part) == parts_digest(part, *content)

    meta: Fields = {}
    for key, text in connection.execute("SELECT key, value FROM meta ORDER BY rowid"):
        if good(f"meta/{key}", key, text):
            meta[key] = json.loads(text)
        else:
            notes.append(f"damaged: {key!r} fails its checksum and is left out")
    missing = [key for key in NEEDED if key not in meta]
    if missing and "unfinished" not in meta:
        raise InputError(f"{path}: damaged: {missing[0]!r} is missing or fails its checksum")
    branches = []
    for position, name, header in connection.execute("SELECT position, name, header FROM branch ORDER BY position"):
        bad = [] if good(f"branch/{position}", name, header) else ["its header"]
        columns = {}
        rows = connection.execute(
            "SELECT name, position, kind, data FROM series WHERE branch = ? ORDER BY position", (position,)
        )
        for column, order, kind, data in rows.fetchall():
            if good(f"series/{position}/{column}", order, kind, data):
                columns[column] = plain(np.frombuffer(data, _TYPES[kind]))
            else:
                bad.append(f"the column {column!r}")
        lost = sorted(part for part in left if part.startswith(f"series/{position}/"))
        left.difference_update(lost)
        bad += [f"the column {part.split('/', 2)[2]!r}" for part in lost if part not in bad]
        if bad:
            notes.append(f"damaged: {', '.join(bad)} of branch {name!r} fails its checksum; the branch is left out")
        else:
            branches.append(_with_columns(json.loads(header), columns))
    bad_solutions = damaged(connection, good)
    notes += [f"damaged: {part!r} is missing" for part in sorted(left)]
    if "phase" in meta and len(notes) > (stored is None):  # it names its curves
        del meta["phase"]
        notes.append("damaged: the regions of the phase diagram are left out with what they refer to")
    notes += [f"damaged: {what} fails its checksum and is left out" for what in bad_solutions]
    if "unfinished" in meta:
        if not branches or missing:
            raise InputError(f"{path}: the run was not finished; finish it with `contin run FILE --resume`")
        count = len(branches)
        notes.append(f"the run was not finished; {count} of its branches are whole: `contin run FILE --resume`")
    outside = {*NEEDED, *DESCRIBING, *PROVENANCE, *UNFINISHED}
    return {
        **{key: meta[key] for key in NEEDED},
        "branches": branches,
        **{key: value for key, value in meta.items() if key not in outside},
        "notes": meta.get("notes", []),
        "timing": meta.get("timing", {"total": 0.0}),
    }, notes


def _stored(connection: sqlite3.Connection) -> dict[str, str] | None:
    """The checksums by part; None in a file that has none."""
    if not connection.execute("SELECT 1 FROM sqlite_master WHERE name = 'checksum'").fetchone():
        return None
    found: Iterable[tuple[str, str]] = connection.execute("SELECT part, sha256 FROM checksum").fetchall()
    return {part: digest for part, digest in found if isinstance(part, str)}  # what is damaged fits to nothing


def _with_columns(header: Fields, columns: Fields) -> Fields:
    """The branch with its columns where they stand in the format: before the points."""
    branch: Fields = {}
    for key, value in header.items():
        if key == "points":
            branch["columns"] = columns
        branch[key] = value
    return branch


def in_words(path: Path, error: Exception) -> str:
    """What went wrong with a file, and what to do."""
    text = str(error)
    if "locked" in text:
        return f"{path}: in use by another process; wait for it, or save under another name"
    if "full" in text or "disk I/O" in text:
        return f"{path}: the disk is full, or cannot be written ({text})"
    if "unable to open" in text or "readonly" in text:
        return f"{path}: cannot be written; the folder must exist and be writable"
    return f"{path}: {text}"
