"""Bifurcation diagrams with matplotlib: figures without pyplot's global state, fit for a paper."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

from contin.continuation.spectra import asked
from contin.errors import InputError
from contin.plot import manifold
from contin.plot.house_style import chosen_palette, chosen_size, style
from contin.plot.legend import add_legend, legend_inside
from contin.plot.look import PLAIN_LOOK, Look
from contin.plot.series import Panel, Source, from_branches, panels
from contin.plot.strokes import angle_ticks, draw_panel
from contin.plot.vocabulary import PALETTE
from contin.store.json_format import model_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from contin.continuation.branch import Branch

def figure(
    panels: Sequence[Panel],
    *,
    look: Look = PLAIN_LOOK,
    images: Mapping[str, str] | None = None,
    periods: Mapping[str, float] | None = None,
    ax: Axes | None = None,
) -> Figure:
    """Draw panels side by side.

    Stable parts are solid, unstable ones dashed; each type of special point has a shape of its own, so nothing is told
    by colour alone. The figure belongs to no window: save it with `savefig`, or show it in a notebook. Labels find
    their places when it is drawn, so limits, scales and sizes may be changed afterwards.

    Parameters
    ----------
    panels : sequence of Panel
        From `contin.plot.series.panels`.
    look : Look, optional
        What the user said of labels, limits, scales, size, legend, title and style.
    images : mapping, optional
        Branches that are mirror images, with the branch they share a colour with.
    periods : mapping, optional
        Periods of angles; those of 2 pi get ticks in multiples of pi.
    ax : matplotlib.axes.Axes, optional
        Draw one panel into these instead; the legend is then inside, and layout and title are the caller's.
    """
    look.check_columns([name for panel in panels for name in (panel.x, panel.y)])
    with style(look.style):
        colours = colour_of_branches(panels, images or {})
        if ax is not None:
            return _into(ax, panels, look, colours, images or {}, periods or {})
        from contin.plot.picture import picture

        width, height = look.size or chosen_size(max(4.8, 4.4 * len(panels)), 4.0)
        drawing = picture(width, height)
        axes = drawing.subplots(1, len(panels), squeeze=False)[0]
        for one, panel in zip(axes, panels, strict=True):
            _draw(one, panel, look, colours, periods or {})
        if look.title:
            drawing.suptitle("\n".join(textwrap.wrap(look.title, 64 * len(panels))), fontsize="large")
        if look.legend == "inside":
            legend_inside(axes[0], panels, colours, images or {})
        else:
            add_legend(drawing, panels, colours, images or {}, look)
    return drawing


def _into(
    ax: Axes, panels: Sequence[Panel], look: Look, colours: Mapping[str, str], images: Mapping[str, str],
    periods: Mapping[str, float],
) -> Figure:  # fmt: skip
    if len(panels) != 1:
        shown = "; ".join(f"y = {panel.y} over x = {panel.x}" for panel in panels)
        raise InputError(f"ax takes one panel, and there are {len(panels)} ({shown}): choose one with x and y")
    _draw(ax, panels[0], look, colours, periods)
    if look.title:
        ax.set_title(look.title)
    if look.legend != "none":
        legend_inside(ax, panels, colours, images)
    drawing = ax.get_figure(root=True)
    assert drawing is not None
    return drawing


def _draw(ax: Axes, panel: Panel, look: Look, colours: Mapping[str, str], periods: Mapping[str, float]) -> None:
    from contin.plot.label_set import LabelSet

    draw_panel(ax, panel, colours, look)
    angle_ticks(ax, panel, periods)
    marks = [mark for curve in panel.curves for mark in curve.marks if look.writes(mark[2].type)]
    LabelSet(ax, panel, marks)


def draw(branches: Iterable[Branch], *, ax: Axes | None = None, look: Look = PLAIN_LOOK) -> Figure:
    """The figure of branches in memory; units and periods of angles are those of their model."""
    branches = list(branches)
    model = model_of(branches)
    shown = [look.x, *([look.y] if isinstance(look.y, str) else look.y or [])]
    sources, periods = from_branches(branches, asked(shown)), model.get("periods", {})
    manifolds = [source for source in sources if source.kind == "manifold"]
    if manifolds and ax is None:
        return manifold.figure(manifolds, title=look.title, axes=[name for name in shown if name])
    grouped = panels(sources, x=look.x, y=look.y, periods=periods, units=model.get("units"))
    return figure(grouped, look=look, images=image_names(sources), periods=periods, ax=ax)


def picture_of(branches: Iterable[Branch], ax: Axes | None, options: Mapping[str, object]) -> Figure:
    """`draw` with the options as a user writes them."""
    return draw(branches, ax=ax, look=Look.of(options))


def image_names(sources: Iterable[Source]) -> dict[str, str]:
    """Each mirror image with the branch it is an image of."""
    return {source.name: source.image_of for source in sources if source.image_of}


def colour_of_branches(panels: Sequence[Panel], images: Mapping[str, str]) -> dict[str, str]:
    """A colour for each branch, images like their originals."""
    colours: dict[str, str] = {}
    palette = chosen_palette(PALETTE)
    for curve in (curve for panel in panels for curve in panel.curves):
        original = images.get(curve.name, curve.name)
        if original not in colours:
            colours[original] = palette[len(colours) % len(palette)]
        colours[curve.name] = colours[original]
    return colours
