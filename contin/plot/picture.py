"""A matplotlib figure that notebooks show by itself: it belongs to no window and needs no `%matplotlib inline`."""

from __future__ import annotations

import base64
import io
from typing import Final

from matplotlib.figure import Figure

from contin.plot.house_style import chosen_dpi

NOTEBOOK_DPI: Final = 110.0


class Picture(Figure):
    """A `matplotlib.figure.Figure` with the representation that notebooks ask for."""

    def png(self, dpi: float = NOTEBOOK_DPI) -> bytes:
        """The picture as a PNG file."""
        stream = io.BytesIO()
        self.savefig(stream, format="png", dpi=dpi)
        return stream.getvalue()

    def _repr_png_(self) -> bytes:
        return self.png()


def picture(width: float, height: float, *, dpi: float = 200.0) -> Picture:
    """An empty picture of this size in inches, with a layout that makes room for labels and legends beside the axes."""
    return Picture(figsize=(width, height), dpi=chosen_dpi(dpi), layout="constrained")


def image_tag(figure: Figure, words: str) -> str:
    """HTML of the figure as an image inside the page; `words` (escaped by the caller) where it cannot be seen."""
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=NOTEBOOK_DPI)
    data = base64.b64encode(stream.getvalue()).decode()
    return f'<img alt="{words}" style="max-width:100%" src="data:image/png;base64,{data}">'
