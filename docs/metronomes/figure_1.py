"""Figure 1b: one metronome from x(0) = 3."""

from claiming import r_star
from drawing import BLUE, panels, table


def compute():
    """Time and displacement that `contin run metronomes/one-time-series` wrote."""
    columns = table("one-time-series.csv")
    return columns["t"], columns["x"]


def draw():
    t, x = compute()
    drawing, axes = panels(1, 1, 6.4, 2.4, "b")
    ax = axes[0, 0]
    ax.plot(t, x, color=BLUE, linewidth=0.6)
    for sign in (1, -1):
        ax.axhline(sign * r_star(0.5), color="0.25", linestyle="--", linewidth=0.9)
    ax.annotate(
        "averaged amplitude", (t[-1], r_star(0.5)), xytext=(0, 4), textcoords="offset points", ha="right", fontsize=8
    )
    ax.set(xlabel="time t (1/frequency of the spring)", ylabel="displacement x", xlim=(t[0], t[-1]), ylim=(-3.6, 3.6))
    return drawing


def check() -> None:
    """The last oscillations have the averaged amplitude, up to O(eps)."""
    t, x = compute()
    assert abs(abs(x[t > 500]).max() - r_star(0.5)) < 0.01
