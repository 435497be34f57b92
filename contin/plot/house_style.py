"""The look of contin's figures, wherever the user has not chosen one: matplotlib's rcParams that differ are kept."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Final

from contin.errors import InputError
from contin.records import Fields

STYLE: Final[Fields] = {
    "font.family": ["sans-serif"],
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


def chosen_size(width: float, height: float) -> tuple[float, float]:
    """Inches of a picture: the user's `figure.figsize` where it was changed."""
    from matplotlib import rcParams, rcParamsDefault

    size = rcParams["figure.figsize"]
    return (width, height) if list(size) == list(rcParamsDefault["figure.figsize"]) else (size[0], size[1])


def chosen_palette(palette: Sequence[str]) -> Sequence[str]:
    """Colours of branches: those of the user's `axes.prop_cycle` where it was changed."""
    from matplotlib import rcParams, rcParamsDefault

    cycle = rcParams["axes.prop_cycle"]
    if cycle == rcParamsDefault["axes.prop_cycle"] or "color" not in cycle.keys:
        return palette
    return list(cycle.by_key()["color"])


def chosen_dpi(dpi: float) -> float:
    """Dots an inch: the user's `figure.dpi` where it was changed."""
    from matplotlib import rcParams, rcParamsDefault

    return dpi if rcParams["figure.dpi"] == rcParamsDefault["figure.dpi"] else float(rcParams["figure.dpi"])


@contextmanager
def style(chosen: Mapping[str, object] | None = None) -> Iterator[None]:
    """Draw with `STYLE`, then what the user changed in `matplotlib.rcParams`, then `chosen` (rcParams by name)."""
    from matplotlib import rc_context, rcParams, rcParamsDefault

    unknown = [name for name in chosen or {} if name not in rcParams]
    if unknown:
        raise InputError(f"style: {unknown[0]!r} is no rcParam of matplotlib; write for example {{'font.size': 12}}")
    free = {name: value for name, value in STYLE.items() if rcParams[name] == rcParamsDefault[name]}
    with rc_context(free):
        try:
            rcParams.update(chosen or {})
        except ValueError as error:
            raise InputError(f"style: {error}") from None
        yield
