"""The periodic orbit at a labelled point of a result document: time series beside a phase portrait."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from contin.errors import InputError
from contin.plot.look import PLAIN_LOOK, Look
from contin.plot.trajectory import figure
from contin.plot.write import PICTURES
from contin.records import Record
from contin.store.atomic import write_bytes

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def orbit_figure(
    document: Record, point: str, x: str | None = None, y: str | None = None, look: Look = PLAIN_LOOK
) -> Figure:
    """The orbit at `point`, BRANCH.LABEL; y against x (default: the first two states) in the phase portrait.

    Raises InputError where the results have no such point, or hold no orbit there.
    """
    name, _, label = point.rpartition(".")
    branch = next((b for b in document["branches"] if b["name"] == name), None)
    kept = [f"{b['name']}.{p['label']}" for b in document["branches"] for p in b["points"] if "orbit" in p]
    found = next((p for p in branch["points"] if p["label"] == label), None) if branch else None
    if branch is None or found is None or "orbit" not in found:
        advice = f"orbits are kept at {', '.join(kept)}" if kept else "compute with --orbits, or save as .contin"
        raise InputError(f"the results hold no orbit {point!r}: {advice}")
    parameter = branch["parameters"][0]
    where = f"{parameter} = {found['values'][parameter]:.6g}, period {found['values']['period']:.6g}"
    states = [s for s in document["model"]["states"] if s in found["orbit"]]
    look = replace(look, x=x or look.x, y=y or look.y, title=look.title or f"{point}: {where}")
    return figure(found["orbit"], states, look=look, closed=True)


def write_orbit(
    document: Record, point: str, out: Path, x: str | None, y: str | None, look: Look = PLAIN_LOOK
) -> None:
    """Write `orbit_figure` as .png, .pdf or .svg."""
    import io

    if out.suffix not in PICTURES:
        raise InputError(f"pictures of orbits end in {', '.join(PICTURES)}; got {out.suffix!r}")
    stream = io.BytesIO()
    orbit_figure(document, point, x, y, look).savefig(stream, format=out.suffix[1:])
    write_bytes(out, stream.getvalue())
