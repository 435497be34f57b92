"""`contin plot`: a picture or an interactive page of saved results."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from contin.cli.look_options import as_look
from contin.cli.scan import plot_scan
from contin.errors import InputError
from contin.plot.orbit import write_orbit
from contin.plot.write import write_picture
from contin.store.places import ending_of
from contin.store.results import read_results


def plot_file(
    file: Path,
    out: Path | None,
    x: str | None,
    y: list[str] | None,
    over: Path | None = None,
    orbit: str | None = None,
    look: Mapping[str, object] | None = None,
) -> int:
    """Draw the results in `file`; the ending of `out` chooses the kind of picture."""
    out = out or file.with_suffix(".png")
    if ending_of(file) == ".scan":
        return plot_scan(file, out, as_look(look or {}, x, y), over)
    if over is not None:
        raise InputError("--over is for a scan: contin plot FILE.scan --over RESULTS")
    if orbit is not None:
        write_orbit(read_results(file), orbit, out, x, y[0] if y else None, as_look(look or {}, x, y))
        print(out)
        return 0
    write_picture(read_results(file), out, as_look(look or {}, x, y))
    print(out)
    return 0
