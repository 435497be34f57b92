"""Maps of a scan: one panel a start, each point of the grid in the colour of what it settled on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.abi import Array
from contin.errors import InputError
from contin.plot.canvas import canvas, finish, several
from contin.plot.dress import dress
from contin.plot.house_style import style
from contin.plot.look import PLAIN_LOOK, Look
from contin.plot.vocabulary import PALETTE, locus_words
from contin.records import Record

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST_PANELS: Final = 6
LINES: Final = ("-", "--", "-.", ":")
GREYS: Final = ("0.65", "0.4", "0.85", "0.2")  # of what is no class: escaped, other, ..


def figure(
    document: Record, *, look: Look = PLAIN_LOOK, ax: Axes | None = None, over: Record | None = None,
    start: str | None = None,
) -> Figure:  # fmt: skip
    """Classes over one or two axes (default: the first two; of more axes, at the first values of the rest).

    document : as `Scan.document` or `contin.store.scan_store.read_scan` give it.  start : draw this one alone.
    over : results of continuation whose curves in the two parameters are drawn on top.
    ax : draw one start into these axes instead.
    """
    columns, scan = document["columns"], document["scan"]
    if not columns["class"]:
        raise InputError("there is nothing to draw: the scan has no finished run")
    ups = several(look.y)
    if len(ups) > 1:
        raise InputError(f"y: a scan is drawn over one or two of its axes; got {', '.join(ups)}")
    across, up = _axes(list(scan["axes"]), look.x, ups[0] if ups else None)
    look.check_columns([across, *([up] if up else [])])
    starts = _starts(list(scan["starts"]), start)
    colours = _colours(scan["classes"], columns["class"])
    curves = _curves(over, across, up) if over is not None and up is not None else []
    with style(look.style):
        wide = 2 if len(starts) == 4 else min(len(starts), 3)
        high = -(-len(starts) // wide)
        size = (1.2 + 3.1 * wide, 1.2 + 2.9 * high)
        drawing, axes = canvas(look, ax, starts, size, rows=high, shared=True)
        for one, name in zip(axes, starts, strict=True):
            _panel(one, _map(document, across, up, name, list(colours)), list(colours.values()), look, (across, up))
            for number, (_, px, py) in enumerate(curves):
                one.plot(px, py, LINES[number % len(LINES)], color="black", linewidth=1.2)
            if len(starts) > 1:
                one.set_title(name, fontsize=9)
        handles, words = _meaning(colours, [words for words, _, _ in curves])
        finish(drawing, axes, look, ax, handles, words, document["model"].get("title"), 2 * wide + 1)
    return drawing


def drawn(document: Record, ax: Axes | None, options: Mapping[str, object]) -> Figure:
    """`figure` with the options as a user writes them, `start` among them."""
    start = options.get("start")
    if not isinstance(start, str | None):
        raise InputError(f"start: expected the name of a start of the scan; got {start!r}")
    look = Look.of({key: value for key, value in options.items() if key != "start"})
    return figure(document, look=look, ax=ax, start=start)


def _panel(
    ax: Axes, grid: tuple[Array, Array, Array], colours: Sequence[str], look: Look, names: tuple[str, str | None]
) -> None:
    """The map of one start, each point of the grid in its colour."""
    from matplotlib.colors import ListedColormap

    xs, ys, codes = grid
    across, up = names
    wide, high = _edges(xs, across, look), _edges(ys, up or "", look)
    ax.pcolormesh(
        wide, high, np.ma.masked_less(codes, 0), cmap=ListedColormap(list(colours)), vmin=-0.5, vmax=len(colours) - 0.5
    )
    ax.set_xlim(*wide[[0, -1]])
    ax.set_ylim(*high[[0, -1]])
    dress(ax, look, across, up or "")
    ax.tick_params(labelbottom=True)  # the panel below may be empty
    if up is None:
        ax.set_yticks([])


def _meaning(colours: Mapping[str, str], curves: Sequence[str]) -> tuple[list[Any], list[str]]:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = [Patch(facecolor=colour) for colour in colours.values()]
    handles += [Line2D([], [], color="black", linestyle=LINES[k % len(LINES)]) for k in range(len(curves))]
    return handles, [*colours, *curves]


def _starts(known: Sequence[str], chosen: str | None) -> list[str]:
    if chosen is None:
        return list(known[:MOST_PANELS])
    if chosen not in known:
        raise InputError(f"start: the scan has no start {chosen!r}; it has {', '.join(known)}")
    return [chosen]


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


def _edges(values: Array, name: str, look: Look) -> Array:
    """Borders between neighbouring values; between their logarithms on a logarithmic axis."""
    if name in look.log:
        if values.min() <= 0.0:
            raise InputError(f"log: the axis {name!r} begins at {values.min():g}; logarithms need values above 0")
        inner = _between(np.log(values))
        return np.exp(inner)
    return _between(values)


def _between(values: Array) -> Array:
    if len(values) == 1:
        return np.array([values[0] - 0.5, values[0] + 0.5])
    middle = 0.5 * (values[1:] + values[:-1])
    return np.concatenate([[2.0 * values[0] - middle[0]], middle, [2.0 * values[-1] - middle[-1]]])
