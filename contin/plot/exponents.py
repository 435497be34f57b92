"""Lyapunov exponents over a parameter, with their errors as bands, and a line at zero."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.errors import InputError
from contin.plot.canvas import canvas, finish, fixed
from contin.plot.dress import dress
from contin.plot.house_style import chosen_palette, style
from contin.plot.look import PLAIN_LOOK, Look
from contin.plot.vocabulary import PALETTE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from contin.exponents.spectrum import LyapunovSpectrum

WORDS: Final = "Lyapunov exponents"


def figure(found: LyapunovSpectrum, *, look: Look = PLAIN_LOOK, ax: Axes | None = None) -> Figure:
    """The exponents of a spectrum along a parameter; gaps where a trajectory ended early."""
    if not found.parameter:
        raise InputError("exponents of one trajectory are numbers; give parameter= and values= to draw them over one")
    fixed(look, WORDS, found.parameter, WORDS)
    look.check_columns([found.parameter, WORDS])
    with style(look.style):
        drawing, axes = canvas(look, ax, [WORDS], (5.4, 3.8))
        colours = chosen_palette(PALETTE)
        order = np.argsort(found.values)
        axes[0].axhline(0.0, color="0.6", linewidth=0.7, zorder=1)
        for k in range(found.rows.shape[1]):
            value, error = found.rows[order, k], found.row_errors[order, k]
            value = np.where(np.isfinite(value), value, np.nan)
            colour = colours[k % len(colours)]
            name = f"$\\lambda_{{{k + 1}}}$"
            axes[0].plot(found.values[order], value, color=colour, linewidth=1.0, label=name, zorder=3)
            low, high = value - error, value + error
            axes[0].fill_between(found.values[order], low, high, color=colour, alpha=0.25, linewidth=0.0, zorder=2)
        dress(axes[0], look, found.parameter, WORDS)
        handles, words = axes[0].get_legend_handles_labels()
        finish(drawing, axes, look, ax, handles, words)
    return drawing


def drawn(found: LyapunovSpectrum, ax: Axes | None, options: Mapping[str, object]) -> Figure:
    """`figure` with the options as a user writes them."""
    return figure(found, look=Look.of(options), ax=ax)
