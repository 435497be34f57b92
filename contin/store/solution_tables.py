"""The solutions at labelled points in a `.contin` file, beside its numbers.

equations  content                          JSON: the models that solutions refer to (`contin.store.encoded`)
solution   branch, label, content, why      JSON of the point; or, where it cannot be kept, why not

They have checksums as all parts have: 'equations', 'solution/POSITION/LABEL'.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Callable, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any, Final

from contin.errors import InputError
from contin.store.digest import parts_digest
from contin.store.solutions import Solutions

SCHEMA: Final = (
    "CREATE TABLE equations (content TEXT NOT NULL)",
    "CREATE TABLE solution (branch INTEGER NOT NULL REFERENCES branch(position), label TEXT NOT NULL, "
    "content TEXT NOT NULL, why TEXT NOT NULL, PRIMARY KEY (branch, label))",
)


def insert_solutions(connection: sqlite3.Connection, solutions: Solutions, names: Sequence[str]) -> None:
    """The solutions of branches with these names, in their order."""
    for statement in SCHEMA:
        connection.execute(statement)
    connection.execute("INSERT INTO equations VALUES (?)", (solutions.equations,))
    _sign(connection, "equations", solutions.equations)
    positions = {name: position for position, name in enumerate(names)}
    for (name, label), content in solutions.points.items():
        _insert(connection, positions[name], label, content, "")
    for (name, label), why in solutions.missing.items():
        _insert(connection, positions[name], label, "", why)


def _insert(connection: sqlite3.Connection, position: int, label: str, content: str, why: str) -> None:
    connection.execute("INSERT INTO solution VALUES (?, ?, ?, ?)", (position, label, content, why))
    _sign(connection, f"solution/{position}/{label}", content, why)


def _sign(connection: sqlite3.Connection, part: str, *content: str) -> None:
    connection.execute("INSERT OR REPLACE INTO checksum VALUES (?, ?)", (part, parts_digest(part, *content)))


def damaged(connection: sqlite3.Connection, good: Callable[..., bool]) -> list[str]:
    """The parts that `good(part, *content)` does not find as they were written."""
    if not _there(connection):
        return []
    texts = _rows(connection, "content FROM equations")
    found = [] if all(good("equations", text) for (text,) in texts) else ["the equations"]
    for position, label, content, why in _rows(connection, "branch, label, content, why FROM solution"):
        if not good(f"solution/{position}/{label}", content, why):
            found.append(f"the solution at {label} of branch number {position}")
    return found


def load_solutions(path: Path) -> Solutions:
    """The solutions that a file holds; none of those that fail their checksums.

    InputError where the file cannot be read.
    """
    try:
        with closing(sqlite3.connect(f"{path.resolve().as_uri()}?mode=ro", uri=True, timeout=0.5)) as connection:
            return _loaded(connection)
    except (sqlite3.Error, ValueError, TypeError) as error:
        raise InputError(f"{path}: not a contin result file, or damaged ({error})") from None


def _loaded(connection: sqlite3.Connection) -> Solutions:
    if not _there(connection):
        return Solutions({}, "", {})
    sums = dict(connection.execute("SELECT part, sha256 FROM checksum").fetchall())
    (equations,) = connection.execute("SELECT content FROM equations").fetchone()
    whole = sums.get("equations") == parts_digest("equations", equations)
    names = dict(connection.execute("SELECT position, name FROM branch").fetchall())
    points: dict[tuple[str, str], str] = {}
    missing: dict[tuple[str, str], str] = {}
    for position, label, content, why in _rows(connection, "branch, label, content, why FROM solution"):
        key, part = (names[position], label), f"solution/{position}/{label}"
        if not whole or sums.get(part) != parts_digest(part, content, why):
            missing[key] = "its solution is damaged in the file: it fails its checksum"
        elif why:
            missing[key] = why
        else:
            points[key] = content
    return Solutions(points, equations, missing)


def _rows(connection: sqlite3.Connection, what: str) -> list[tuple[Any, ...]]:
    rows: list[tuple[Any, ...]] = connection.execute(f"SELECT {what} ORDER BY rowid").fetchall()
    return rows


def _there(connection: sqlite3.Connection) -> bool:
    return connection.execute("SELECT 1 FROM sqlite_master WHERE name = 'solution'").fetchone() is not None
