"""What a picture's lines and signs mean: beside the axes, never more than a quarter of the picture."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Final

from contin.plot.look import Look
from contin.plot.series import Panel
from contin.plot.strokes import STABLE, UNSTABLE
from contin.plot.vocabulary import style_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

MOST_NAMES: Final = 8  # with more branches than this the legend names kinds of lines only
QUARTER: Final = 0.25  # of the picture's height
LINE: Final = 0.17  # inches: of an entry


def entries(
    panels: Sequence[Panel], colours: Mapping[str, str], images: Mapping[str, str], named: bool
) -> dict[str, Line2D]:
    """Words and samples: branches (if `named`), stability, types of special points."""
    from matplotlib.lines import Line2D

    curves = [curve for panel in panels for curve in panel.curves]
    found: dict[str, Line2D] = {}
    if named:
        for curve in curves:
            original = images.get(curve.name, curve.name)
            found.setdefault(f"{original} ({curve.words})", Line2D([], [], color=colours[curve.name], linewidth=1.9))
    portions = [portion for curve in curves for portion in curve.portions]
    if any(portion.stable for portion in portions):
        found["stable"] = Line2D([], [], color="0.25", **STABLE)
    if any(portion.stable is False for portion in portions):
        found["unstable"] = Line2D([], [], color="0.25", **UNSTABLE)
    for type_code in dict.fromkeys(mark.type for curve in curves for *_, mark in curve.marks):
        look = style_of(type_code)
        found[f"{type_code}  {look.words}"] = Line2D(
            [], [], linestyle="none", marker=look.marker, color="black", markerfacecolor="white", markersize=5.5
        )
    return found


def add_legend(
    drawing: Figure, panels: Sequence[Panel], colours: Mapping[str, str], images: Mapping[str, str], look: Look
) -> None:
    """Below the axes; the names of branches are left out where they would need more than a quarter of the height."""
    if look.legend == "none":
        return
    width, room = float(drawing.get_figwidth()), QUARTER * float(drawing.get_figheight())
    few = len(set(colours)) <= MOST_NAMES
    shown, columns = entries(panels, colours, images, few), 1
    for named in (few, False):
        shown = entries(panels, colours, images, named)
        columns = _columns([len(text) for text in shown], width, 3 * len(panels))
        if -(-len(shown) // columns) * LINE <= room:
            break
    for count in range(columns if shown else 0, 0, -1):  # letters may be wider than thought
        size = min(1.0, room / max(-(-len(shown) // count) * LINE, 1e-9))
        legend = drawing.legend(
            list(shown.values()), list(shown), loc="outside lower center", ncols=count, frameon=False,
            handlelength=2.6, columnspacing=1.6, fontsize=max(8.0 * size, 4.0) if size < 1.0 else None,
        )  # fmt: skip
        if count == 1 or legend.get_window_extent().width <= drawing.bbox.width:
            break
        legend.remove()


def legend_inside(ax: Axes, panels: Sequence[Panel], colours: Mapping[str, str], images: Mapping[str, str]) -> None:
    """Within the axes, where it hides least."""
    shown = entries(panels, colours, images, len(set(colours)) <= MOST_NAMES)
    if shown:
        ax.legend(list(shown.values()), list(shown), loc="best", framealpha=0.9, fontsize="small")


def _columns(lengths: Sequence[int], width: float, most: int) -> int:
    """Columns of a legend with entries of these lengths (characters), filled one after another, that fit the width."""
    for count in range(min(len(lengths), most), 1, -1):
        rows = -(-len(lengths) // count)
        widest = [max(lengths[k : k + rows]) for k in range(0, len(lengths), rows)]
        if sum(0.062 * n + 0.52 for n in widest) <= width:
            return count
    return 1
