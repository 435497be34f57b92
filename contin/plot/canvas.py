"""The figure that a picture is drawn on: one of our own, or the user's axes; its title and its legend."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from contin.errors import InputError
from contin.plot.house_style import chosen_size
from contin.plot.look import Look

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def canvas(
    look: Look, ax: Axes | None, panels: Sequence[str], size: tuple[float, float], rows: int = 1, shared: bool = False
) -> tuple[Figure, list[Axes]]:  # fmt: skip
    """Axes for panels of these names, side by side in `rows`; `ax` itself, where there is one panel.

    size : inches where neither the user nor rcParams say any.  shared : all panels have the same axes.
    """
    if ax is not None:
        if len(panels) != 1:
            raise InputError(f"ax takes one panel, and there are {len(panels)} ({', '.join(panels)}): choose one")
        drawing = ax.get_figure(root=True)
        assert drawing is not None
        return drawing, [ax]
    from contin.plot.picture import picture

    made: Figure = picture(*(look.size or chosen_size(*size)))
    wide = -(-len(panels) // rows)
    axes: list[Axes] = list(made.subplots(rows, wide, squeeze=False, sharex=shared, sharey=shared).ravel())
    for empty in axes[len(panels) :]:
        empty.set_visible(False)
    return made, axes[: len(panels)]


def finish(
    drawing: Figure, axes: Sequence[Axes], look: Look, ax: Axes | None, handles: Sequence[Any], words: Sequence[str],
    title: str | None = None, columns: int = 4,
) -> None:  # fmt: skip
    """The title (`title` where the user gives none) and what the signs mean, where the look wants it."""
    title = title if look.title is None else look.title
    if ax is not None:
        if look.title:
            ax.set_title(look.title)
    elif title:
        wide = max(20, int(12.0 * drawing.get_figwidth()))
        drawing.suptitle("\n".join(textwrap.wrap(title, wide)), fontsize="large")
    if not handles or look.legend == "none":
        return
    if ax is not None or look.legend == "inside":
        axes[0].legend(handles, words, loc="best", framealpha=0.9, fontsize="small")
    else:
        drawing.legend(
            handles, words, loc="outside lower center", ncols=max(1, min(columns, len(handles))), frameon=False
        )


def fixed(look: Look, what: str, x: str, y: str | None = None) -> None:
    """InputError where the look asks for other axes than those that a picture of this kind has."""
    if look.x not in (None, x):
        raise InputError(f"x: {what} is drawn over {x}; got {look.x!r}")
    if y is not None and look.y not in (None, y, [y], (y,)):
        raise InputError(f"y: {what} is drawn over {x} with {y} upwards; got {look.y!r}")


def several(y: str | Sequence[str] | None) -> list[str]:
    """The columns upwards, as a list."""
    return [y] if isinstance(y, str) else list(y or ())
