"""Eigenvalues or multipliers of a solution in the complex plane, with the line or circle that separates stable ones."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from contin.plot.picture import Picture, picture

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def spectrum(values: Sequence[complex], multipliers: bool) -> Picture:
    """Crosses at the values; the unit circle for multipliers, the imaginary axis for eigenvalues."""
    values = [value for value in values if np.isfinite(value)]
    drawing = picture(3.4, 3.0)
    axes = drawing.subplots()
    if multipliers:
        _circle(axes)
    else:
        axes.axvline(0.0, color="0.6", linewidth=1.0)
        reach = 1.15 * max((abs(value) for value in values), default=0.0) or 1.0  # one scale: rounding is not seen
        axes.set(xlim=(-reach, reach), ylim=(-reach, reach))
    axes.axhline(0.0, color="0.85", linewidth=0.8, zorder=0)
    here = np.asarray(values, dtype=complex)
    axes.plot(here.real, here.imag, "x", color="black", markersize=6)
    axes.set(xlabel="real part", ylabel="imaginary part", title="multipliers" if multipliers else "eigenvalues")
    return drawing


def _circle(axes: Axes) -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    axes.plot(np.cos(angle), np.sin(angle), color="0.6", linewidth=1.0)
    axes.set_aspect("equal", adjustable="datalim")
