"""Figures 3b and 3c: two metronomes settle on anti-phase or in-phase synchrony."""

import numpy as np
from drawing import BLUE, RED, panels, table

NAMES = {"anti-phase": "pair-anti-phase.csv", "in-phase": "pair-in-phase.csv"}


def compute() -> dict[str, dict[str, np.ndarray]]:
    return {name: table(file) for name, file in NAMES.items()}


def apart(columns, sign: int) -> float:
    """Largest distance in the last tenth from x1 = sign x2."""
    rows = slice(-len(columns["t"]) // 10, None)
    return float(np.hypot(*(columns[f"{q}1"][rows] - sign * columns[f"{q}2"][rows] for q in "xy")).max())


def draw():
    drawing, axes = panels(2, 2, 8.4, 4.2, "bxcx")
    for row, (name, columns) in zip(axes, compute().items(), strict=True):
        t = columns["t"]
        for ax, rows in ((row[0], t < 60), (row[1], t > t[-1] - 30)):
            ax.plot(t[rows], columns["x1"][rows], color=BLUE, label="metronome 1", linewidth=1.3)
            ax.plot(t[rows], columns["x2"][rows], color=RED, label="metronome 2", linewidth=1.3, linestyle="--")
            ax.set(xlabel="time t", ylabel="x", ylim=(-3.2, 3.2))
        row[1].set_title("")
        row[1].set_title(f"{name}, later", loc="left", fontsize=9)
    drawing.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=2, frameon=False)
    return drawing


def check() -> None:
    """Each start settles on its own synchronous state."""
    found = compute()
    assert apart(found["in-phase"], 1) < 1e-2
    assert apart(found["anti-phase"], -1) < 1e-4
