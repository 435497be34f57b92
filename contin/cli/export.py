"""`contin export`: saved results in another format."""

from __future__ import annotations

import sys
from pathlib import Path

from contin.cli.printable import printable
from contin.cli.scan import export_scan
from contin.exchange import registry
from contin.model.registry import find
from contin.store.atomic import write_text
from contin.store.places import ending_of
from contin.store.results import export_results, read_results
from contin.store.solution_tables import load_solutions


def export_file(file: Path, out: Path) -> int:
    """Convert the results in `file` to the format that the ending of `out` names."""
    if registry.is_written(out):
        return export_model(file, out)
    if ending_of(file) == ".scan":
        return export_scan(file, out)
    document = read_results(file)
    names = {branch["name"] for branch in document["branches"]}
    both = ending_of(file) == ending_of(out) == ".contin"
    export_results(document, out, load_solutions(file).of(names) if both else None)
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
