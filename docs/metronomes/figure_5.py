"""Figure 5: what the pair settles on near unstable in-phase synchrony."""

import numpy as np
from drawing import BETA, BLUE, MU, RED, panels, table

CASES = (("a", 3, 0.2), ("b", 3, 0.8), ("c", 5, 0.74))
SHOWN = {"a": 30, "b": 1000, "c": 30}  # time drawn


def amplitudes(letter: str) -> dict[str, tuple[float, float]]:
    """Smallest and largest sqrt(x^2 + y^2) of each metronome."""
    columns = table(f"three-states-{letter}.csv")
    sizes = {k: np.hypot(columns[f"x{k}"], columns[f"y{k}"]) for k in (1, 2)}
    return {k: (float(size.min()), float(size.max())) for k, size in sizes.items()}


def draw():
    drawing, axes = panels(1, 3, 10.2, 2.9)
    for ax, (letter, mu, beta) in zip(axes[0], CASES, strict=True):
        columns = table(f"three-states-{letter}.csv")
        rows = columns["t"] < columns["t"][0] + SHOWN[letter]
        t = columns["t"][rows]
        width = 0.35 if letter == "b" else 1.3
        ax.plot(t, columns["x1"][rows], color=BLUE, label="metronome 1", linewidth=width)
        ax.plot(
            t,
            columns["x2"][rows],
            color=RED,
            label="metronome 2",
            linewidth=width,
            linestyle="-" if letter == "b" else "--",
        )
        ax.set(xlabel="time t", ylabel="x", ylim=(-3.2, 3.2))
        ax.set_title(f"{MU} = {mu}, {BETA} = {beta}", fontsize=9)
    handles, names = axes[0, 0].get_legend_handles_labels()
    drawing.legend(handles, names, loc="outside lower center", ncols=2, frameon=False)
    return drawing


def check() -> None:
    """Equal amplitudes; amplitudes that come and go; unequal ones that stay (but for the ripple within a turn)."""
    a, b, c = (amplitudes(letter) for letter in "abc")
    assert abs(a[1][1] - a[2][1]) < 1e-6
    assert max(b[1][0], b[2][0]) < 0.1
    assert min(b[1][1], b[2][1]) > 2.1
    assert c[1][1] - c[2][1] > 0.1
    assert min(c[1][0], c[2][0]) > 1.9
