"""Results in one SQLite file (`.contin`): every branch a row, every column its bytes, readable with any SQLite tool.

meta     key, value                      JSON: contin (format version), model, built, notes, timing
branch   position, name, header          JSON of the branch without its columns
series   branch, position, name, kind, data      little-endian float64 ('f'), int64 ('i') or bytes 0/1 ('b')
"""

from __future__ import annotations

import json
import sqlite3
import tempfile
from collections.abc import Mapping
from contextlib import closing
from pathlib import Path
from typing import Any, Final

import numpy as np

from contin.errors import FormatVersionError, InputError
from contin.store.atomic import replace_file
from contin.store.json_format import FORMAT_VERSION, plain

APPLICATION_ID: Final = 0x636F6E74  # "cont", so that `file` and other tools can tell these files apart
SCHEMA: Final = """
CREATE TABLE meta (key TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE branch (position INTEGER PRIMARY KEY, name TEXT NOT NULL, header TEXT NOT NULL);
CREATE TABLE series (branch INTEGER NOT NULL REFERENCES branch(position), position INTEGER NOT NULL,
                     name TEXT NOT NULL, kind TEXT NOT NULL CHECK (kind IN ('f', 'i', 'b')), data BLOB NOT NULL,
                     PRIMARY KEY (branch, name));
"""
_TYPES: Final = {"f": "<f8", "i": "<i8", "b": "?"}


def save(document: Mapping[str, Any], path: Path, provenance: Mapping[str, str] | None = None) -> None:
    """Write a result document; an existing file is replaced whole, or not at all.

    `provenance` (the model's text, the run, versions) goes to the table `meta` too, for whoever opens the file later.
    """
    with tempfile.TemporaryDirectory() as folder:
        temporary = Path(folder) / "results"
        with closing(sqlite3.connect(temporary)) as connection, connection:
            connection.executescript(SCHEMA)
            connection.execute(f"PRAGMA application_id = {APPLICATION_ID}")
            connection.execute(f"PRAGMA user_version = {FORMAT_VERSION}")
            _insert(connection, document)
            for key, value in (provenance or {}).items():
                connection.execute("INSERT INTO meta VALUES (?, ?)", (key, json.dumps(value)))
        replace_file(path, temporary)


def _insert(connection: sqlite3.Connection, document: Mapping[str, Any]) -> None:
    for key, value in document.items():
        if key != "branches":
            connection.execute("INSERT INTO meta VALUES (?, ?)", (key, json.dumps(value)))
    for position, branch in enumerate(document["branches"]):
        header = {key: value for key, value in branch.items() if key != "columns"}
        connection.execute("INSERT INTO branch VALUES (?, ?, ?)", (position, branch["name"], json.dumps(header)))
        for order, (name, column) in enumerate(branch["columns"].items()):
            kind, data = _packed(column)
            connection.execute("INSERT INTO series VALUES (?, ?, ?, ?, ?)", (position, order, name, kind, data))


def _packed(column: list[Any]) -> tuple[str, bytes]:
    if column and all(isinstance(value, bool) for value in column):
        kind = "b"
    elif column and all(isinstance(value, int) and not isinstance(value, bool) for value in column):
        kind = "i"
    else:
        kind = "f"  # None becomes NaN, and NaN is written as null again
    return kind, np.array(column, dtype=float if kind == "f" else None).astype(_TYPES[kind]).tobytes()


def load(path: Path) -> dict[str, Any]:
    """Read a result document that `save` wrote.

    Raises
    ------
    InputError
        The file cannot be read or is not a contin result.
    FormatVersionError
        It was written in a newer format.
    """
    if not path.is_file():
        raise InputError(f"{path}: there is no such file")
    try:
        with closing(sqlite3.connect(f"{path.resolve().as_uri()}?mode=ro", uri=True)) as connection:
            if connection.execute("PRAGMA application_id").fetchone()[0] != APPLICATION_ID:
                raise InputError(f"{path}: not a contin result file")
            version = connection.execute("PRAGMA user_version").fetchone()[0]
            if version > FORMAT_VERSION:
                raise FormatVersionError(
                    f"{path}: written in format {version}; this contin reads up to {FORMAT_VERSION}"
                )
            if connection.execute("SELECT 1 FROM meta WHERE key = 'unfinished'").fetchone():
                raise InputError(f"{path}: the run was not finished; finish it with `contin run FILE --resume`")
            return _document(connection)
    except (sqlite3.Error, json.JSONDecodeError, KeyError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{path}: not a contin result file, or damaged ({error})") from None


def _document(connection: sqlite3.Connection) -> dict[str, Any]:
    meta = {key: json.loads(value) for key, value in connection.execute("SELECT key, value FROM meta")}
    branches = []
    for position, header in connection.execute("SELECT position, header FROM branch ORDER BY position").fetchall():
        rows = connection.execute("SELECT name, kind, data FROM series WHERE branch = ? ORDER BY position", (position,))
        columns = {name: plain(np.frombuffer(data, _TYPES[kind])) for name, kind, data in rows}
        branches.append(_with_columns(json.loads(header), columns))
    return {
        "contin": meta["contin"],
        "model": meta["model"],
        "branches": branches,
        **{key: meta[key] for key in ("phase", "simulations", "sweep", "built") if key in meta},
        "notes": meta["notes"],
        "timing": meta["timing"],
    }


def _with_columns(header: dict[str, Any], columns: dict[str, Any]) -> dict[str, Any]:
    """The branch with its columns where they stand in the format: before the points."""
    branch: dict[str, Any] = {}
    for key, value in header.items():
        if key == "points":
            branch["columns"] = columns
        branch[key] = value
    return branch
