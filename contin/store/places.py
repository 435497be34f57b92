"""Where a run writes as it goes: at the place of its result, or beside an earlier result, which stays till the end."""

from __future__ import annotations

import json
import re
import sqlite3
from collections.abc import Collection
from contextlib import closing
from enum import Enum
from pathlib import Path
from typing import Final

from contin.errors import InputError
from contin.store.atomic import is_special
from contin.store.lock import IN_USE

ENDING: Final = ".unfinished"
HEAD: Final = 4096  # bytes that tell a JSON result
LOGS: Final = ("", "-wal", "-shm", "-journal")  # of SQLite, beside a file


def beside(path: Path) -> Path:
    """The file that an unfinished run writes where `path` is taken by a finished result."""
    return path.with_name(path.name + ENDING)


def ending_of(path: Path) -> str:
    """The ending that tells what a file holds: that of its result, where the run that writes it is not finished."""
    return Path(path.stem).suffix if path.suffix == ENDING else path.suffix


class State(Enum):
    """What is found at the path of one of our SQLite files."""

    FREE = "free"  # nothing, or a file without content
    FOREIGN = "foreign"
    DAMAGED = "damaged"  # ours, and cannot be read
    UNFINISHED = "unfinished"
    FINISHED = "finished"


def state_of(path: Path, application: int) -> State:
    """What `path` is, for files with this SQLite application id and a table `meta`.

    Raises InputError where another process writes it, or where it cannot be read.
    """
    try:
        if not path.exists() or path.stat().st_size == 0:
            return State.FREE
        with path.open("rb") as stream:
            header = stream.read(100)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from None
    if not header.startswith(b"SQLite format 3\0"):
        return State.FOREIGN
    ours = int.from_bytes(header[68:72], "big") == application
    try:
        with closing(sqlite3.connect(f"{path.resolve().as_uri()}?mode=rw", uri=True, timeout=0.2)) as connection:
            tables = {name for (name,) in connection.execute("SELECT name FROM sqlite_master")}
            if not tables:  # killed before its first transaction
                return State.FREE
            if connection.execute("PRAGMA application_id").fetchone()[0] != application:
                return State.FOREIGN
            ours = True
            marked = connection.execute("SELECT 1 FROM meta WHERE key = 'unfinished'").fetchone()
    except (sqlite3.Error, UnicodeDecodeError) as error:  # texts that are no UTF-8 any more
        if "locked" in str(error):
            raise InputError(f"{path}: {IN_USE}") from None
        return State.DAMAGED if ours else State.FOREIGN
    return State.UNFINISHED if marked or "chunk" in tables else State.FINISHED


def states_of(path: Path, application: int) -> dict[Path, State]:
    """What stands at `path`, where results go, and beside it, where those of an unfinished run may be (that first).

    InputError where `path` is a file that contin did not write.
    """
    states = {place: state_of(place, application) for place in (beside(path), path)}
    if states[path] is State.FOREIGN:
        raise foreign(path)
    return states


def cleared(path: Path, state: State) -> Path:
    """Where a new run writes: `path`, or where a finished result has that, beside it. Unfinished ones are removed."""
    discard(beside(path))
    if state in (State.FREE, State.UNFINISHED):
        discard(path)
    return beside(path) if path.exists() else path


def refuse_foreign(path: Path) -> None:
    """InputError where `path` is a file that is no JSON result of contin: it is never overwritten.

    Empty files are free, and what is no file (a pipe, a device) is written to.
    """
    if not path.exists() or is_special(path):
        return
    try:
        if path.is_dir() or (path.stat().st_size and not _is_our_json(path)):
            raise foreign(path)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from None


def foreign(path: Path) -> InputError:
    """The refusal to overwrite a file that contin did not write."""
    return InputError(f"{path}: is no result of contin, and is not overwritten; move it, or choose another name")


def _is_our_json(path: Path) -> bool:
    with path.open("rb") as stream:
        head = stream.read(HEAD)
        if re.match(rb'\s*\{\s*"contin"\s*:', head):
            return True
        try:
            document = json.loads(head + stream.read())
        except (ValueError, RecursionError):
            return False
    return isinstance(document, dict) and "contin" in document


def discard(path: Path) -> None:
    """Remove an SQLite file and its logs."""
    try:
        for suffix in LOGS:
            Path(f"{path}{suffix}").unlink(missing_ok=True)
    except OSError as error:
        raise InputError(f"{path}: cannot be replaced ({error.strerror})") from None


def same_file(path: Path, others: Collection[Path]) -> Path | None:
    """The one of `others` that is the same file, also through links; None where there is none."""
    for other in others:
        try:
            if path.resolve() == other.resolve() or (path.exists() and other.exists() and path.samefile(other)):
                return other
        except (OSError, RuntimeError):
            continue
    return None
