"""What the figures share: style, panel letters, results read back."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np

from contin.plot.house_style import style
from contin.plot.picture import picture
from contin.plot.vocabulary import PALETTE

BLUE, RED, GREEN, PINK, SKY, ORANGE, BLACK = PALETTE
ALPHA, BETA, MU, EPS, PSI, SIGMA = (rf"$\{name}$" for name in ("alpha", "beta", "mu", "varepsilon", "psi", "sigma"))


def table(name: str) -> dict[str, np.ndarray]:
    """Columns of a CSV that `contin run` wrote."""
    with Path(name).open(encoding="utf-8") as stream:
        rows = list(csv.reader(stream))
    columns = zip(*rows[1:], strict=True)
    return {key: _numbers(column) for key, column in zip(rows[0], columns, strict=True)}


def _numbers(column) -> np.ndarray:
    try:
        return np.array(column, dtype=float)
    except ValueError:
        return np.array(column)


def results(name: str | Path) -> dict[str, dict]:
    """Branches of a result document, by name."""
    return {branch["name"]: branch for branch in json.loads(Path(name).read_text(encoding="utf-8"))["branches"]}


def points(branch: dict, type_: str, name: str) -> list[float]:
    """Values of a column at the labelled points of a type."""
    return [point["values"][name] for point in branch["points"] if point["type"] == type_]


def panels(rows: int, columns: int, width: float, height: float, letters: str = "abcdefghij"):
    """A figure and its axes, each with a letter."""
    with style():
        drawing = picture(width, height, dpi=160.0)
        axes = drawing.subplots(rows, columns, squeeze=False)
    for ax, letter in zip(axes.ravel(), letters, strict=False):
        ax.set_title(letter, loc="left", fontweight="bold", fontsize=10)
    return drawing, axes


def curve(ax, branch: dict, x: str, y: str, colour: str, scale: float = 1.0, **style) -> None:
    """A branch: solid where stable, dashed where not."""
    px, py = np.array(branch["columns"][x], dtype=float), scale * np.array(branch["columns"][y], dtype=float)
    stable = np.array(branch["columns"]["stable"], dtype=bool)
    for wanted, dashes, width in ((True, "-", 1.9), (False, (0, (3.2, 1.8)), 1.1)):
        shown = stable == wanted
        shown[1:] |= shown[:-1] & (stable[1:] != wanted)  # pieces meet
        ax.plot(px, np.where(shown, py, np.nan), color=colour, linestyle=dashes, linewidth=width, **style)


class MarkdownTable:
    """A table that a notebook shows as one."""

    def __init__(self, head: str, rows: list[tuple]) -> None:
        self.head, self.rows = head, rows

    def _repr_markdown_(self) -> str:
        columns = self.head.count("|") + 1
        lines = [f"| {self.head} |", "|" + "---|" * columns, *(f"| {' | '.join(map(str, row))} |" for row in self.rows)]
        return "\n".join(lines)
