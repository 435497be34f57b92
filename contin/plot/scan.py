"""Maps of a scan: one panel a start, each point of the grid in the colour of what it settled on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.abi import Array
from contin.errors import InputError
from contin.plot.house_style import style
from contin.plot.vocabulary import PALETTE, locus_words
from contin.records import Record

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST_PANELS: Final = 6
LINES: Final = ("-", "--", "-.", ":")
GREYS: Final = ("0.65", "0.4", "0.85", "0.2")  # of what is no class: escaped, other, ..


def figure(
    document: Record, *, x: str | None = None, y: str | None = None, over: Record | None = None
) -> Figure:
    """Classes over one or two axes (default: the first two; of more axes, at the first values of the rest).

    document : as `Scan.document` or `contin.store.scan_store.read_scan` give it.
    over : results of continuation whose curves in the two parameters are drawn on top.
    """
    from matplotlib.colors import ListedColormap
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    from contin.plot.picture import picture

    columns, scan = document["columns"], document["scan"]
    if not columns["class"]:
        raise InputError("there is nothing to draw: the scan has no finished run")
    across, up = _axes(list(scan["axes"]), x, y)
    starts = list(scan["starts"])[:MOST_PANELS]
    colours = _colours(scan["classes"], columns["class"])
    curves = _curves(over, across, up) if over is not None and up is not None else []
    with style():
        count = len(starts)
        wide = 2 if count == 4 else min(count, 3)
        high = -(-count // wide)
        drawing = picture(1.2 + 3.1 * wide, 1.2 + 2.9 * high)
        grid = drawing.subplots(high, wide, squeeze=False, sharex=True, sharey=True)
        for k, ax in enumerate(grid.ravel()):
            if k >= count:
                ax.set_visible(False)
                continue
            xs, ys, codes = _map(document, across, up, starts[k], list(colours))
            ax.pcolormesh(
                _edges(xs), _edges(ys), np.ma.masked_less(codes, 0), cmap=ListedColormap(list(colours.values())),
                vmin=-0.5, vmax=len(colours) - 0.5,
            )  # fmt: skip
            ax.set_xlim(*_edges(xs)[[0, -1]])
            ax.set_ylim(*_edges(ys)[[0, -1]])
            for number, (_, px, py) in enumerate(curves):
                ax.plot(px, py, LINES[number % len(LINES)], color="black", linewidth=1.2)
            if count > 1:
                ax.set_title(starts[k], fontsize=9)
            ax.set_xlabel(across)
            ax.tick_params(labelbottom=True)  # the panel below may be empty
            if up is not None:
                ax.set_ylabel(up)
            else:
                ax.set_yticks([])
        handles: list[Any] = [Patch(facecolor=c, label=label) for label, c in colours.items()]
        handles += [
            Line2D([], [], color="black", linestyle=LINES[k % len(LINES)], label=words)
            for k, (words, _, _) in enumerate(curves)
        ]
        drawing.legend(
            handles=handles, loc="outside lower center", ncols=min(2 * wide + 1, len(handles)), frameon=False
        )
        if document["model"].get("title"):
            drawing.suptitle(document["model"]["title"], fontsize=10)
    return drawing


def _axes(names: Sequence[str], x: str | None, y: str | None) -> tuple[str, str | None]:
    for name in (x, y):
        if name is not None and name not in names:
            raise InputError(f"the scan has no axis {name!r}; it has {', '.join(names)}")
    across = x or next(name for name in names if name != y)
    return across, y or next((name for name in names if name != across), None)


def _colours(classes: Mapping[str, str], found: Sequence[str]) -> dict[str, str]:
    """Of every class that was found, in the order of the scan file; greys for what is no class."""
    present = set(found)
    colours = {name: PALETTE[k % len(PALETTE)] for k, name in enumerate(classes) if name in present}
    rest = sorted(present - set(classes))
    return colours | {name: GREYS[k % len(GREYS)] for k, name in enumerate(rest)}


def _curves(over: Record, across: str, up: str) -> list[tuple[str, Any, Any]]:
    """(words, x, y) of the loci in these two parameters; those of one kind under one name, broken where they end."""
    found: dict[str, tuple[list[float], list[float]]] = {}
    for branch in over["branches"]:
        if branch["kind"] == "locus" and set(branch["parameters"]) == {across, up}:
            words = locus_words(branch["locus"]) if branch.get("locus") else branch["name"]
            px, py = found.setdefault(words, ([], []))
            px += [np.nan, *branch["columns"][across]]
            py += [np.nan, *branch["columns"][up]]
    if not found:
        raise InputError(f"the results to draw over hold no curve in {across} and {up}")
    return [(words, px, py) for words, (px, py) in found.items()]


def _map(
    document: Record, across: str, up: str | None, start: str, labels: Sequence[str]
) -> tuple[Array, Array, Array]:
    """Values on both axes and the class number at each point, -1 where no run is finished."""
    columns, axes = document["columns"], document["scan"]["axes"]
    chosen = np.array([s == start for s in columns["start"]])
    for name, values in axes.items():
        if name not in (across, up):
            chosen &= np.asarray(columns[name]) == values[0]
    xs = np.unique(axes[across])
    ys = np.unique(axes[up]) if up is not None else np.zeros(1)
    codes = np.full((len(ys), len(xs)), -1.0)
    a = np.searchsorted(xs, np.asarray(columns[across])[chosen])
    b = np.searchsorted(ys, np.asarray(columns[up])[chosen]) if up is not None else np.zeros(len(a), dtype=int)
    codes[b, a] = [labels.index(label) for label, use in zip(columns["class"], chosen, strict=True) if use]
    return xs, ys, codes


def _edges(values: Array) -> Array:
    """Borders between neighbouring values."""
    if len(values) == 1:
        return np.array([values[0] - 0.5, values[0] + 0.5])
    middle = 0.5 * (values[1:] + values[:-1])
    return np.concatenate([[2.0 * values[0] - middle[0]], middle, [2.0 * values[-1] - middle[-1]]])
