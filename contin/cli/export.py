"""`contin export`: saved results in another format."""

from __future__ import annotations

import sys
from pathlib import Path

from contin.cli.printable import printable
from contin.cli.scan import export_scan
from contin.cli.simulate import write_table
from contin.errors import InputError
from contin.exchange import registry
from contin.model.registry import find
from contin.records import Fields
from contin.store.atomic import write_text
from contin.store.json_format import read_mapping
from contin.store.places import ending_of
from contin.store.results import export_results, read_results
from contin.store.run_files import checked, kind_of
from contin.store.solution_tables import load_solutions


def export_file(file: Path, out: Path) -> int:
    """Convert the results in `file` to the format that the ending of `out` names."""
    if registry.is_written(out):
        return export_model(file, out)
    if ending_of(file) == ".scan":
        return export_scan(file, out)
    if ending_of(file) == ".json" and (kind := kind_of(written := read_mapping(file))) is not None:
        return export_scan(file, out) if kind == "scan" else export_table(written, kind, file, out)
    document = read_results(file)
    names = {branch["name"] for branch in document["branches"]}
    both = ending_of(file) == ending_of(out) == ".contin"
    export_results(document, out, load_solutions(file).of(names) if both else None)
    print(out)
    return 0


def export_table(written: Fields, kind: str, file: Path, out: Path) -> int:
    """What `contin simulate`, `sweep` or `survey` wrote as JSON, as a table (.csv)."""
    if kind in ("plane", "planes"):
        raise InputError(f"{out}: a phase plane is no table; draw it with contin plot, or read it with contin.read")
    if out.suffix != ".csv":
        raise InputError(f"{out}: the results of a {kind} are exported as .csv")
    document = checked(written, kind, file)
    columns = document["survey"] if kind == "survey" else document["columns"]
    if "section" in document:
        columns = document["section"]
    write_table({name: ["nan" if v is None else v for v in column] for name, column in columns.items()}, out)
    print(out)
    return 0


def export_model(file: Path, out: Path) -> int:
    """Write a model in the format that the ending of `out` names; what that cannot hold is said on standard error."""
    found = registry.write(find(str(file)), out)
    for note in found.notes:
        sys.stderr.write(printable(f"note: {note}") + "\n")
    texts = {out: found.text, **{out.with_name(k.format(stem=out.stem)): text for k, text in found.beside.items()}}
    for place, text in texts.items():
        write_text(place, text)
        print(place)
    return 0
