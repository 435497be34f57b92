"""An interactive diagram in one HTML file: data, style and viewer inside, nothing loaded from anywhere."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.linalg.polygons import deepest
from contin.plot.figure import colour_of_branches, image_names
from contin.plot.phase import NAMED, fill_of
from contin.plot.rows import leading, rows_of, thinned
from contin.plot.series import Source, from_branches, ordinates, panels, segment_stability, wrapped
from contin.plot.vocabulary import KINDS, locus_words, style_of
from contin.records import Fields, Record
from contin.special.table import special_type
from contin.store.atomic import write_text
from contin.store.json_format import model_of

if TYPE_CHECKING:
    from contin.continuation.branch import Branch

DIGITS: Final = 8  # significant digits kept: more than a screen shows, half the file size
MOST_COLUMNS: Final = 40  # of each branch
SCRIPTS: Final = ("viewer.js", "viewer_regions.js", "viewer_detail.js", "viewer_export.js", "viewer_start.js")


def html_page(
    sources: Sequence[Source],
    *,
    title: str,
    x: str | None = None,
    y: str | Sequence[str] | None = None,
    periods: Mapping[str, float] | None = None,
    units: Mapping[str, str] | None = None,
    phase: Record | None = None,
    rows: Mapping[str, Fields] | None = None,
) -> str:
    """A self-contained page: hover for values, choose the axes, hide branches, zoom, click for orbits and spectra.

    phase : the `phase` section of results, whose regions are shaded.  rows : as `contin.plot.rows.rows_of` gives them.

    The page asks for nothing from any network (its content policy forbids it), and names from files are data there,
    never markup.

    Raises
    ------
    InputError
        No branch has the columns `x` and `y`.
    """
    views = panels(sources, x=x, y=y, periods=periods, units=units)
    colours = colour_of_branches(views, image_names(sources))
    wanted = {name for view in views for name in (view.x, view.y)}
    kept = rows or {}
    data: Fields = {
        "title": title,
        "views": [{"x": view.x, "y": view.y} for view in views],
        "units": dict(units or {}),
        "periods": dict(periods or {}),
        "branches": [
            {**_branch(source, colours.get(source.name, "#666666"), wanted, periods or {}),
             **_of_rows(source, kept.get(source.name, {}))}
            for source in sources
        ],
        "phase": None if phase is None else _regions(phase),
    }  # fmt: skip
    if phase is not None:
        data["views"] = [dict(zip("xy", phase["parameters"], strict=True)), *data["views"]]
        data["views"] = [v for k, v in enumerate(data["views"]) if v not in data["views"][:k]]
    # In a script element only "</script" and "<!--" end or change the data, so no "<" is left in it.
    text = json.dumps(data, allow_nan=False, ensure_ascii=True, separators=(",", ":")).replace("<", "\\u003c")
    files = resources.files("contin.plot")
    script = "".join(files.joinpath(name).read_text(encoding="utf-8") for name in SCRIPTS)
    template = files.joinpath("viewer.html").read_text(encoding="utf-8")
    return template.replace("{{SCRIPT}}", script).replace("{{DATA}}", text)


def write_html(
    branches: Iterable[Branch],
    path: str | Path,
    *,
    x: str | None = None,
    y: str | Sequence[str] | None = None,
    title: str | None = None,
    phase: Record | None = None,
) -> None:
    """Write the page of branches in memory; units and periods of angles are those of their model."""
    branches = list(branches)
    model = model_of(branches)
    periods, units = model.get("periods"), model.get("units")
    page = html_page(
        from_branches(branches), title=title or model["name"], x=x, y=y, periods=periods, units=units,
        phase=phase, rows=rows_of(branches),
    )
    write_text(Path(path), page)


def _branch(source: Source, colour: str, wanted: set[str], periods: Mapping[str, float]) -> Fields:
    names = [name for name in ordinates(source) if name not in ("stable", "unstable", "neutral")]
    drawn = (name for name in names[MOST_COLUMNS:] if {name, name.rpartition(".")[0]} & wanted)  # iterates, too
    names = [*names[:MOST_COLUMNS], *drawn]
    columns = [c for name in names for c in (name, f"{name}.max", f"{name}.min") if c in source.columns]
    stable = segment_stability(source)
    return {
        "name": source.name,
        "what": locus_words(source.locus) if source.kind == "locus" else KINDS.get(source.kind, source.kind),
        "colour": colour,
        "columns": {name: _numbers(source, name, periods) for name in columns},
        "stable": None if stable is None else [int(flag) for flag in stable],
        "marks": [
            {"row": mark.index, "label": mark.label, "words": style_of(mark.type).words, "note": mark.note,
             "shape": style_of(mark.type).symbol, "form": _form(mark.normal_form),
             "spectrum": leading(mark.spectrum, source.multipliers),
             "orbit": None if mark.orbit is None else thinned(dict(mark.orbit))}
            for mark in source.marks
        ],
    }  # fmt: skip


def _of_rows(source: Source, kept: Fields) -> Fields:
    """Spectra and orbits; where curves of Hopf points are neutral saddles; dashes and circles by kind."""
    neutral = source.columns.get("neutral")
    dashes = special_type(source.locus or "").dashes if source.kind == "locus" else None
    return {
        "multipliers": source.multipliers,
        "spectrum": kept.get("spectrum") or None,
        "orbits": kept.get("orbits") or [],
        "circles": source.kind == "orbit",
        "neutral": None if neutral is None or not np.any(neutral) else [int(bool(v)) for v in neutral],
        "dashes": " ".join(f"{2.0 * float(v):g}" for v in dashes) if isinstance(dashes, tuple | list) else None,
    }


def _form(normal_form: Record) -> list[list[str]]:
    """Coefficients with their errors, as text."""
    errors = normal_form.get("errors", {})
    known = errors if isinstance(errors, Mapping) else {}
    found = []
    for name, value in normal_form.items():
        if name != "errors" and value is not None:
            error = f" \u00b1 {known[name]:.1g}" if isinstance(known.get(name), float) else ""
            found.append([name, _shown(value) + error])
    return found


def _shown(value: object) -> str:
    if isinstance(value, bool) or not isinstance(value, float | complex):
        if isinstance(value, list | tuple):
            return ", ".join(_shown(v) for v in value)
        return str(value)
    return f"{value:.10g}"


def _regions(phase: Record) -> Fields:
    """Rings of regions with their colours, words, and where their letters stand."""
    names = list(phase["parameters"])
    low = np.array([phase["range"][name][0] for name in names], dtype=float)
    width = np.array([phase["range"][name][1] for name in names], dtype=float) - low
    found = []
    for region in sorted(phase["regions"], key=lambda r: -float(r["area"])):
        rings = [np.asarray(ring, dtype=float) for ring in (region["outline"], *region["holes"])]
        centre = deepest([(ring - low) / width for ring in rings])
        place = None if region["area"] < NAMED or centre is None else (low + centre[0] * width).tolist()
        found.append(
            {"name": region["name"], "words": region["words"], "fill": fill_of(region, phase), "at": place,
             "outline": _ring(rings[0]), "holes": [_ring(ring) for ring in rings[1:]]}
        )  # fmt: skip
    return {"parameters": names, "range": {name: list(phase["range"][name]) for name in names}, "regions": found}


def _ring(points: Array) -> list[list[float]]:
    return [[float(f"{v:.6g}") for v in point] for point in points.tolist()]


def _numbers(source: Source, name: str, periods: Mapping[str, float]) -> list[float | None]:
    values = wrapped(np.asarray(source.columns[name], float), periods.get(name))
    return [float(f"{value:.{DIGITS}g}") if math.isfinite(value) else None for value in values.tolist()]
