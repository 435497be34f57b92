"""Is a finished result file what was written? Every checksum, the schema, and SQLite's own check of its pages."""

from __future__ import annotations

import sqlite3
import warnings
from contextlib import closing
from pathlib import Path
from typing import Final

from contin.errors import InputError
from contin.store.digest import DamageWarning, mistake
from contin.store.json_format import read_mapping
from contin.store.places import ending_of
from contin.store.results import read_results
from contin.store.run_files import kind_of
from contin.store.scan_store import read_scan

STORES: Final = (".contin", ".scan")


def is_result(path: Path) -> bool:
    """True for a store by its ending, and for JSON results (a model or a run file may be JSON, too)."""
    if ending_of(path) == ".json" and path.is_file():
        try:
            written = read_mapping(path)
            return kind_of(written) is not None or not {"branches", "columns"}.isdisjoint(written)
        except InputError:
            return False
    return ending_of(path) in STORES


def verify(path: Path) -> str:
    """What a result file holds, in words, once every part of it was found as it was written.

    Raises
    ------
    InputError
        It is damaged, not finished, has no checksums, or is no result; the text names every part that fails.
    """
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always", DamageWarning)
        if ending_of(path) == ".json" and "branches" not in (other := read_mapping(path)):
            words = f"results of a {kind_of(other) or 'command'}"
            if (wrong_sum := mistake(other)) is not None:
                warnings.warn(f"{path}: {wrong_sum}", DamageWarning, stacklevel=2)
        elif ending_of(path) == ".scan":
            words = f"a scan, {len(read_scan(path)['columns']['class'])} runs"
        else:
            document = read_results(path)
            rows = sum(len(next(iter(b["columns"].values()), [])) for b in document["branches"])
            words = f"{document['model']['name']}, {len(document['branches'])} branches, {rows} rows"
    wrong = [str(item.message) for item in told if issubclass(item.category, DamageWarning)]
    if ending_of(path) != ".json":
        wrong += _pages(path)
    if wrong:
        raise InputError("\n".join(wrong))
    return words


def _pages(path: Path) -> list[str]:
    """What SQLite finds wrong with the structure of a file, at most ten lines."""
    try:
        with closing(sqlite3.connect(f"{path.resolve().as_uri()}?mode=ro", uri=True)) as connection:
            found = [str(row[0]) for row in connection.execute("PRAGMA integrity_check(10)")]
    except sqlite3.Error as error:
        found = [str(error)]
    return [f"{path}: damaged: {line}" for line in found if line != "ok"]
