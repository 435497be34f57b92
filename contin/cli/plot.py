"""`contin plot`: a picture or an interactive page of whatever contin wrote."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from contin import lazy
from contin.cli.look_options import as_look, written_look
from contin.cli.scan import plot_scan
from contin.cli.simulate import write_figure
from contin.errors import InputError
from contin.plot.orbit import write_orbit
from contin.plot.sweep import figure as sweep_figure
from contin.plot.write import PICTURES, write_picture
from contin.records import Record
from contin.store.json_format import read_mapping
from contin.store.places import ending_of
from contin.store.results import read_results
from contin.store.run_files import kind_of


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
    said = look or {}
    kind = "scan" if ending_of(file) == ".scan" else None
    if ending_of(file) == ".json":
        kind = kind_of(read_mapping(file))
    if kind == "scan":
        return plot_scan(file, out, as_look(said, x, y), over)
    if over is not None:
        raise InputError("--over is for a scan: contin plot FILE.scan --over RESULTS")
    if kind is None:
        document = read_results(file)
        if orbit is not None:
            write_orbit(document, orbit, out, x, y[0] if y else None, as_look(said, x, y))
            print(out)
            return 0
        if document["branches"] and not ("sweep" in document and out.suffix in PICTURES):
            write_picture(document, out, as_look(said, x, y))
            print(out)
            return 0
        if document["branches"]:
            return _sweep_over(document, out, said, x, y)
    return _alone(file, out, written_look(said, x, y))


def _sweep_over(
    document: Record, out: Path, said: Mapping[str, object], x: str | None, y: Sequence[str] | None
) -> int:
    """A sweep over the branches of its run, as the run draws it."""
    swept, look = document["sweep"], as_look(said, x, y)
    named = replace(look, title=look.title or document["model"].get("title") or document["model"]["name"])
    drawing = sweep_figure(swept["columns"], swept["parameter"], swept["quantities"], look=named, over=document)
    write_figure(drawing, out)
    print(out)
    return 0


def _alone(file: Path, out: Path, options: Mapping[str, object]) -> int:
    """What has no branches: a trajectory, a sweep, a survey."""
    if out.suffix not in PICTURES:
        raise InputError(f"{out}: pictures end in {', '.join(PICTURES)}; an interactive page shows branches")
    found = lazy.module("reading").read(file)
    if isinstance(found, list):
        raise InputError(f"{file} holds {len(found)} phase planes; draw one of them: contin.read(file)[0].plot()")
    write_figure(found.plot(**options), out)
    print(out)
    return 0
