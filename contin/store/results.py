"""Result files of any kind by their ending: `.contin` (SQLite) and `.json`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from contin.continuation.defects import noted
from contin.continuation.kept_rows import kept_rows
from contin.errors import InputError
from contin.records import Fields, Record
from contin.store import json_format, sqlite
from contin.store.places import ending_of
from contin.store.solutions import Solutions, solutions_of
from contin.store.tables import write_csv, write_netcdf

if TYPE_CHECKING:
    from contin.continuation.branch import Branch, SpecialPoint


def read_results(path: Path) -> Fields:
    """The result document in a file.

    Raises
    ------
    InputError
        The ending is neither `.contin` nor `.json`, or the file is not a contin result.
    """
    ending = ending_of(path)
    if ending == ".contin":
        return sqlite.load(path)
    if ending == ".json":
        return json_format.read(path)
    expected = "expected a result file that ends in .contin or .json (of a scan: .scan)"
    if ending in (".csv", ".nc"):
        raise InputError(f"{path}: a table for other programs (pandas.read_csv, xarray.open_datatree); {expected}")
    raise InputError(f"{path}: {expected}")


def save_branches(
    branches: Iterable[Branch], path: str | Path, notes: Sequence[str] = (), **parts: Record
) -> None:
    """Write branches in memory to a `.contin` (or `.json`) file, with orbits at labelled points and some rows.

    parts : `diagram` and `phase`, as `result_document` takes them.
    """
    branches = list(branches)
    total = sum(branch.seconds for branch in branches)
    told = [*notes]  # and orbits that cannot be sampled

    def orbit(branch: Branch, point: SpecialPoint) -> Record | None:
        found: list[Record | None] = [None]
        with noted(lambda text: told.append(f"{branch.name}.{point.label}: its orbit is not written: {text}")):
            found = [_orbit(branch, point)]
        return found[0]

    document = json_format.result_document(
        json_format.model_of(branches), branches, timing={"total": total}, notes=told, orbit=orbit,
        rows=kept_rows, **parts,
    )  # fmt: skip
    export_results(document, Path(path), solutions_of(branches))


def _orbit(branch: Branch, point: SpecialPoint) -> Record | None:
    """The orbit at a labelled point of a family, or of a curve of orbits."""
    if branch.kind not in ("orbit", "locus") or not callable(getattr(point.problem, "profile", None)):
        return None
    return {"orbit": dict(point.orbit.columns)}


def export_results(document: Record, path: Path, solutions: Solutions | None = None) -> None:
    """Write a result document in the format that the file's ending names: `.json`, `.contin`, `.csv` or `.nc`.

    solutions : at its labelled points, for a `.contin` file.
    """
    save = partial(sqlite.save, solutions=solutions)
    writers: dict[str, Callable[[Record, Path], None]] = {
        ".json": json_format.write, ".contin": save, ".csv": write_csv, ".nc": write_netcdf
    }  # fmt: skip
    writer = writers.get(path.suffix)
    if writer is None:
        raise InputError(f"{path}: expected an ending of {', '.join(writers)}")
    writer(document, path)
