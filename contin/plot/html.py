"""An interactive diagram in one HTML file: data, style and viewer inside, nothing loaded from anywhere."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.plot.figure import colour_of_branches, image_names
from contin.plot.series import Source, from_branches, ordinates, panels, segment_stability, wrapped
from contin.plot.vocabulary import KINDS, locus_words, style_of
from contin.records import Fields
from contin.store.atomic import write_text
from contin.store.json_format import model_of

if TYPE_CHECKING:
    from contin.continuation.branch import Branch

DIGITS: Final = 8  # significant digits kept: more than a screen shows, half the file size
MOST_COLUMNS: Final = 40  # of each branch


def html_page(
    sources: Sequence[Source],
    *,
    title: str,
    x: str | None = None,
    y: str | Sequence[str] | None = None,
    periods: Mapping[str, float] | None = None,
    units: Mapping[str, str] | None = None,
) -> str:
    """A self-contained page: hover for values, choose the axes, hide branches, zoom.

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
    data = {
        "title": title,
        "views": [{"x": view.x, "y": view.y} for view in views],
        "units": dict(units or {}),
        "periods": dict(periods or {}),
        "branches": [_branch(source, colours.get(source.name, "#666666"), wanted, periods or {}) for source in sources],
    }
    template = resources.files("contin.plot").joinpath("viewer.html").read_text(encoding="utf-8")
    # In a script element only "</script" and "<!--" end or change the data, so no "<" is left in it.
    text = json.dumps(data, allow_nan=False, ensure_ascii=True, separators=(",", ":")).replace("<", "\\u003c")
    return template.replace("{{DATA}}", text)


def write_html(
    branches: Iterable[Branch],
    path: str | Path,
    *,
    x: str | None = None,
    y: str | Sequence[str] | None = None,
    title: str | None = None,
) -> None:
    """Write the page of branches in memory; units and periods of angles are those of their model."""
    branches = list(branches)
    model = model_of(branches)
    periods, units = model.get("periods"), model.get("units")
    page = html_page(from_branches(branches), title=title or model["name"], x=x, y=y, periods=periods, units=units)
    write_text(Path(path), page)


def _branch(source: Source, colour: str, wanted: set[str], periods: Mapping[str, float]) -> Fields:
    names = [name for name in ordinates(source) if name not in ("stable", "unstable")]
    names = [*names[:MOST_COLUMNS], *(name for name in names[MOST_COLUMNS:] if name in wanted)]
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
             "shape": style_of(mark.type).symbol}
            for mark in source.marks
        ],
    }  # fmt: skip


def _numbers(source: Source, name: str, periods: Mapping[str, float]) -> list[float | None]:
    values = wrapped(np.asarray(source.columns[name], float), periods.get(name))
    return [float(f"{value:.{DIGITS}g}") if math.isfinite(value) else None for value in values.tolist()]
