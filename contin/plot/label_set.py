"""The labels of marked points, which find their places whenever the figure is drawn.

So a log scale, other limits or another size, set after the figure was made, move them along.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backend_bases import RendererBase
from matplotlib.patheffects import withStroke
from matplotlib.text import Annotation

from contin.abi import Array
from contin.plot.labels import densify, merged, place
from contin.plot.series import Mark, Panel

POINTS: Final = 7.5  # size of the text
FAR: Final = 1.6  # in units of label and text: farther away nobody sees what a label belongs to without a line


class LabelSet(Artist):
    """Drawn before everything else of its axes: it places the annotations of the marks, which draw themselves."""

    def __init__(self, ax: Axes, panel: Panel, marks: Sequence[tuple[float, float, Mark]]) -> None:
        super().__init__()
        self._marks = [(x, y, mark) for x, y, mark in marks if math.isfinite(x + y)]
        self._strands = [np.stack([p.x, p.y], axis=1) for curve in panel.curves for p in curve.portions]
        self._texts = [_annotation(ax, x, y) for x, y, _ in self._marks]
        self.set_zorder(-1.0)
        self.set_in_layout(False)
        ax.add_artist(self)

    def draw(self, renderer: RendererBase) -> None:
        """Give the labels of what the axes show now their places; hide those that find no room."""
        for text in self._texts:
            text.set_visible(False)
        if self._texts and self.get_visible() and isinstance(self.axes, Axes):
            self._place(self.axes, renderer)

    def _place(self, ax: Axes, renderer: RendererBase) -> None:
        frame, size = ax.get_window_extent(renderer), POINTS * float(np.asarray(renderer.points_to_pixels(1.0)))
        points = ax.transData.transform([(x, y) for x, y, _ in self._marks])
        inside = np.isfinite(points).all(axis=1)
        inside &= ((points >= (frame.x0 - 1, frame.y0 - 1)) & (points <= (frame.x1 + 1, frame.y1 + 1))).all(axis=1)
        shown = np.flatnonzero(inside)
        if not len(shown):
            return
        marks = [self._marks[k][2] for k in shown]
        names = [(mark.type, int(mark.label.removeprefix(mark.type) or 0)) for mark in marks]
        labels = merged(names, points[shown], 0.53 * size)
        anchors = points[shown[[first for first, _ in labels]]]
        boxes = np.array([(0.62 * size * len(text), size) for _, text in labels])
        centres = place(anchors, boxes, self._obstacles(ax, size / 3), (frame.x0, frame.y0, frame.x1, frame.y1))
        back = ax.transData.inverted()
        for (first, words), anchor, centre, box in zip(labels, anchors, centres, boxes, strict=True):
            if np.isfinite(centre).all():
                far = bool(np.hypot(*((centre - anchor) / (box / 2 + size))) > FAR)
                _write(self._texts[shown[first]], words, back.transform(centre), far)

    def _obstacles(self, ax: Axes, spacing: float) -> Array:
        """Points along the curves, in pixels."""
        strands = [ax.transData.transform(strand) for strand in self._strands]
        return densify([strand[np.isfinite(strand).all(axis=1)] for strand in strands], spacing)


def _annotation(ax: Axes, x: float, y: float) -> Annotation:
    text = ax.annotate(
        "", (x, y), xytext=(x, y), fontsize=POINTS, ha="center", va="center", zorder=2.6, annotation_clip=False,
        path_effects=[withStroke(linewidth=2.0, foreground="white")],  # its halo must not hide markers
        arrowprops={"arrowstyle": "-", "color": "0.4", "linewidth": 0.5, "shrinkB": 3.0},
    )  # fmt: skip
    text.set_in_layout(False)
    return text


def _write(text: Annotation, words: str, where: Array, far: bool) -> None:
    text.set_text(words)
    text.xyann = (float(where[0]), float(where[1]))
    text.set_visible(True)
    if text.arrow_patch is not None:
        text.arrow_patch.set_visible(far)
