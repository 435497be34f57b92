"""Bifurcation diagrams with matplotlib: figures without pyplot's global state, fit for a paper."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.plot.labels import densify, merged, place
from contin.plot.series import Panel, Source, is_constant
from contin.plot.smooth import smooth
from contin.plot.vocabulary import KINDS, PALETTE, locus_words, style_of
from contin.records import Fields
from contin.store.json_format import model_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from contin.continuation.branch import Branch

STYLE: Final[Fields] = {
    "font.family": "sans-serif",
    "font.size": 9.0,
    "axes.labelsize": 10.0,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "xtick.direction": "out",
    "ytick.direction": "out",
    "legend.fontsize": 8.0,
    "svg.fonttype": "none",  # text stays text
    "pdf.fonttype": 42,
    "figure.autolayout": False,
    "figure.constrained_layout.use": False,
}
STABLE: Final[Fields] = {"linestyle": "-", "linewidth": 1.9}
UNSTABLE: Final[Fields] = {"linestyle": (0, (3.2, 1.8)), "linewidth": 1.1}
CIRCLES: Final[Fields] = {  # on orbits: filled where stable, open where unstable
    "linestyle": "none", "marker": "o", "markersize": 3.4, "markeredgewidth": 0.8, "markevery": (0.02, 0.05),
}  # fmt: skip
PLAIN: Final[Fields] = {"linestyle": "-", "linewidth": 1.5}  # loci
MOST_NAMES: Final = 8  # with more branches than this the legend names kinds of branches instead


def figure(
    panels: Sequence[Panel],
    *,
    title: str | None = None,
    images: Mapping[str, str] | None = None,
    periods: Mapping[str, float] | None = None,
) -> Figure:
    """Draw panels side by side.

    Stable parts are solid, unstable ones dashed; each type of special point has a shape of its own, so nothing is told
    by colour alone. The figure belongs to no window: save it with `savefig`, or show it in a notebook.

    Parameters
    ----------
    panels : sequence of Panel
        From `contin.plot.series.panels`.
    title : str, optional
    images : mapping, optional
        Branches that are mirror images, with the branch they share a colour with.
    periods : mapping, optional
        Periods of angles; those of 2 pi get ticks in multiples of pi.
    """
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    with rc_context(STYLE):
        drawing = Figure(figsize=(max(4.8, 4.4 * len(panels)), 4.0), dpi=200, layout="constrained")
        axes = drawing.subplots(1, len(panels), squeeze=False)[0]
        colours = colour_of_branches(panels, images or {})
        for ax, panel in zip(axes, panels, strict=True):
            _draw_curves(ax, panel, colours)
            _angle_ticks(ax, panel, periods or {})
        if title:
            drawing.suptitle("\n".join(textwrap.wrap(title, 64 * len(panels))), fontsize=10)
        _legend(drawing, panels, colours, images or {})
        lay_out(drawing)  # which decides where the axes are; only then can labels be placed
        for ax, panel in zip(axes, panels, strict=True):
            _draw_labels(ax, panel)
        drawing.set_layout_engine(None)  # all have their places; with "none" saving would draw twice
    return drawing


def lay_out(drawing: Figure) -> None:
    """Give axes and legends their places, without drawing anything."""
    engine = drawing.get_layout_engine()
    if engine is not None:
        engine.execute(drawing)


def draw(
    branches: Iterable[Branch], *, x: str | None = None, y: str | Sequence[str] | None = None, title: str | None = None
) -> Figure:
    """The figure of branches in memory; units and periods of angles are those of their model."""
    from contin.plot.series import from_branches, panels

    branches = list(branches)
    model = model_of(branches)
    sources, periods = from_branches(branches), model.get("periods", {})
    grouped = panels(sources, x=x, y=y, periods=periods, units=model.get("units"))
    return figure(grouped, title=title, images=image_names(sources), periods=periods)


def image_names(sources: Iterable[Source]) -> dict[str, str]:
    """Each mirror image with the branch it is an image of."""
    return {source.name: source.image_of for source in sources if source.image_of}


def colour_of_branches(panels: Sequence[Panel], images: Mapping[str, str]) -> dict[str, str]:
    """A colour for each branch, images like their originals."""
    colours: dict[str, str] = {}
    for curve in (curve for panel in panels for curve in panel.curves):
        original = images.get(curve.name, curve.name)
        if original not in colours:
            colours[original] = PALETTE[len(colours) % len(PALETTE)]
        colours[curve.name] = colours[original]
    return colours


def _draw_curves(ax: Axes, panel: Panel, colours: Mapping[str, str]) -> None:
    frame = _extent(panel)
    for curve in panel.curves:
        for piece in curve.pieces:
            style = PLAIN if piece.stable is None else STABLE if piece.stable else UNSTABLE
            drawn = smooth(piece.x, piece.y, frame)
            ax.plot(*drawn, color=colours[curve.name], solid_capstyle="round", zorder=2.0, **style)
            if curve.kind == "orbit":
                face = colours[curve.name] if piece.stable else "white"
                ax.plot(*drawn, color=colours[curve.name], markerfacecolor=face, zorder=2.1, **CIRCLES)
        for x, y, mark in curve.marks:
            look = style_of(mark.type)
            stroke = look.marker in "x12"  # shapes without a face
            ax.plot(
                [x],
                [y],
                look.marker,
                markersize=5.5 if look.marker != "*" else 8.0,
                markerfacecolor=colours[curve.name] if stroke else "white",
                markeredgecolor="black",
                markeredgewidth=1.3 if stroke else 0.9,
                zorder=3.0,
            )
    ax.set_xlabel(panel.x_label)
    ax.set_ylabel(panel.y_label)
    ax.margins(0.04, 0.08)
    low, high = ax.get_ylim()
    if is_constant(np.array([low, high])):
        centre = (low + high) / 2
        ax.set_ylim(centre - 0.5 * (abs(centre) or 1.0), centre + 0.5 * (abs(centre) or 1.0))
    ax.grid(True, color="0.92", linewidth=0.6, zorder=0)
    ax.set_axisbelow(True)


def _extent(panel: Panel) -> tuple[float, float]:
    """Width and height of all that a panel shows."""
    pieces = [piece for curve in panel.curves for piece in curve.pieces]
    xs, ys = np.concatenate([piece.x for piece in pieces]), np.concatenate([piece.y for piece in pieces])
    return float(np.nanmax(xs) - np.nanmin(xs)) or 1.0, float(np.nanmax(ys) - np.nanmin(ys)) or 1.0


def _angle_ticks(ax: Axes, panel: Panel, periods: Mapping[str, float]) -> None:
    names = ["\u2212\u03c0", "\u2212\u03c0/2", "0", "\u03c0/2", "\u03c0"]  # letters: formulas take long to set
    for name, axis, limits in ((panel.x, ax.xaxis, ax.get_xlim()), (panel.y, ax.yaxis, ax.get_ylim())):
        period = periods.get(name)
        if (
            period is not None
            and math.isclose(period, 2 * math.pi, rel_tol=1e-9)
            and limits[1] - limits[0] > math.pi / 2
        ):
            axis.set_ticks(list(np.linspace(-math.pi, math.pi, 5)), names)


def _draw_labels(ax: Axes, panel: Panel) -> None:
    from matplotlib.patheffects import withStroke

    marks = [(x, y, mark) for curve in panel.curves for x, y, mark in curve.marks if math.isfinite(x + y)]
    if not marks:
        return
    pixels = ax.figure.dpi / 72.0
    size = 7.5 * pixels
    points = ax.transData.transform([(x, y) for x, y, _ in marks])
    names = [(mark.type, int(mark.label.removeprefix(mark.type) or 0)) for *_, mark in marks]
    labels = merged(names, points, 4.0 * pixels)
    anchors = points[[first for first, _ in labels]]
    sizes = np.array([(0.62 * size * len(text), size) for _, text in labels])
    strands = [ax.transData.transform(np.stack([p.x, p.y], axis=1)) for curve in panel.curves for p in curve.pieces]
    frame = ax.get_window_extent()
    centres = place(anchors, sizes, densify(strands, 2.5 * pixels), (frame.x0, frame.y0, frame.x1, frame.y1))
    back = ax.transData.inverted()
    for (first, text), anchor, centre, box in zip(labels, anchors, centres, sizes, strict=True):
        if not np.isfinite(centre).all():
            continue
        far = np.hypot(*((centre - anchor) / (box / 2 + size))) > 1.6  # too far to see what it belongs to
        ax.annotate(
            text,
            marks[first][:2],
            xytext=tuple(back.transform(centre)),
            fontsize=7.5,
            ha="center",
            va="center",
            zorder=2.6,  # its halo must not hide markers
            annotation_clip=False,
            path_effects=[withStroke(linewidth=2.0, foreground="white")],
            arrowprops={"arrowstyle": "-", "color": "0.4", "linewidth": 0.5, "shrinkB": 3.0} if far else None,
        )


def _legend(drawing: Figure, panels: Sequence[Panel], colours: Mapping[str, str], images: Mapping[str, str]) -> None:
    from matplotlib.lines import Line2D

    curves = [curve for panel in panels for curve in panel.curves]
    entries: dict[str, Line2D] = {}
    if len(set(colours)) <= MOST_NAMES:
        for curve in curves:
            original = images.get(curve.name, curve.name)
            what = locus_words(curve.locus) if curve.kind == "locus" else KINDS.get(curve.kind, curve.kind)
            entries.setdefault(f"{original} ({what})", Line2D([], [], color=colours[curve.name], linewidth=1.9))
    pieces = [piece for curve in curves for piece in curve.pieces]
    if any(piece.stable for piece in pieces):
        entries["stable"] = Line2D([], [], color="0.25", **STABLE)
    if any(piece.stable is False for piece in pieces):
        entries["unstable"] = Line2D([], [], color="0.25", **UNSTABLE)
    for curve in curves:
        for _, _, mark in curve.marks:
            look = style_of(mark.type)
            entries.setdefault(
                f"{mark.type}  {look.words}",
                Line2D(
                    [], [], linestyle="none", marker=look.marker, color="black", markerfacecolor="white", markersize=5.5
                ),
            )
    if entries:
        drawing.legend(
            list(entries.values()),
            list(entries),
            loc="outside lower center",
            ncols=_columns([len(text) for text in entries], float(drawing.get_figwidth()), 3 * len(panels)),
            frameon=False,
            handlelength=2.6,
            columnspacing=1.6,
        )


def _columns(lengths: Sequence[int], width: float, most: int) -> int:
    """Columns of a legend with entries of these lengths (characters), filled one after another, that fit the width."""
    for count in range(min(len(lengths), most), 1, -1):
        rows = -(-len(lengths) // count)
        widest = [max(lengths[k : k + rows]) for k in range(0, len(lengths), rows)]
        if sum(0.062 * n + 0.52 for n in widest) <= width:
            return count
    return 1
