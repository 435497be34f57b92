"""`contin export`: saved results in another format."""

from __future__ import annotations

from pathlib import Path

from contin.cli.scan import export_scan
from contin.store.places import ending_of
from contin.store.results import export_results, read_results


def export_file(file: Path, out: Path) -> int:
    """Convert the results in `file` to the format that the ending of `out` names."""
    if ending_of(file) == ".scan":
        return export_scan(file, out)
    export_results(read_results(file), out)
    print(out)
    return 0
