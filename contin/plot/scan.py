"""Maps of a scan: one panel a start, each point of the grid in the colour of what it settled on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.errors import InputError
from contin.plot.figure import STYLE
from contin.plot.vocabulary import PALETTE

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST_PANELS: Final = 6
NOT_DONE: Final = "white"


def figure(columns: Mapping[str, Any], axes: Sequence[str], *, title: str | None = None) -> Figure:
    """Classes over one or two axes (of more, the first two at the first values of the rest).

    columns : the axes, "start" and "class", a row a run.
    """
    from matplotlib import rc_context
    from matplotlib.colors import ListedColormap
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

    if not columns["class"]:
        raise InputError("there is nothing to draw: the scan has no finished run")
    starts = list(dict.fromkeys(columns["start"]))[:MOST_PANELS]
    labels = list(dict.fromkeys(columns["class"]))
    colours = [PALETTE[k % len(PALETTE)] for k in range(len(labels))]
    across, *rest = axes
    up = rest[0] if rest else None
    with rc_context(STYLE):
        count = len(starts)
        wide = 2 if count == 4 else min(count, 3)
        high = -(-count // wide)
        drawing = Figure(figsize=(1.2 + 3.1 * wide, 1.2 + 2.9 * high), dpi=200, layout="constrained")
        grid = drawing.subplots(high, wide, squeeze=False, sharex=True, sharey=True)
        for k, ax in enumerate(grid.ravel()):
            if k >= count:
                ax.set_visible(False)
                continue
            x, y, codes = _map(columns, axes, starts[k], labels)
            shown = np.ma.masked_less(codes, 0)
            ax.pcolormesh(_edges(x), _edges(y), shown, cmap=ListedColormap(colours), vmin=-0.5, vmax=len(labels) - 0.5)
            if count > 1:
                ax.set_title(starts[k], fontsize=9)
            ax.set_xlabel(across)
            ax.tick_params(labelbottom=True)  # the panel below may be empty
            if up:
                ax.set_ylabel(up)
            else:
                ax.set_yticks([])
        patches = [Patch(facecolor=c, label=label) for c, label in zip(colours, labels, strict=True)]
        drawing.legend(handles=patches, loc="outside lower center", ncols=min(5, len(patches)), frameon=False)
        if title:
            drawing.suptitle(title, fontsize=10)
    return drawing


def _map(
    columns: Mapping[str, Any], axes: Sequence[str], start: str, labels: Sequence[str]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Values on both axes and the class number at each point, -1 where no run is finished."""
    chosen = np.array([s == start for s in columns["start"]])
    for name in axes[2:]:
        column = np.asarray(columns[name])
        chosen &= column == column[0]
    x = np.asarray(columns[axes[0]])[chosen]
    y = np.asarray(columns[axes[1]])[chosen] if len(axes) > 1 else np.zeros(len(x))
    names = [label for label, use in zip(columns["class"], chosen, strict=True) if use]
    xs, ys = np.unique(np.asarray(columns[axes[0]])), np.unique(y)
    codes = np.full((len(ys), len(xs)), -1)
    for a, b, label in zip(x, y, names, strict=True):
        codes[np.searchsorted(ys, b), np.searchsorted(xs, a)] = labels.index(label)
    return xs, ys, codes


def _edges(values: np.ndarray) -> np.ndarray:
    """Borders between neighbouring values."""
    if len(values) == 1:
        return np.array([values[0] - 0.5, values[0] + 0.5])
    middle = 0.5 * (values[1:] + values[:-1])
    return np.concatenate([[2.0 * values[0] - middle[0]], middle, [2.0 * values[-1] - middle[-1]]])
