"""The supplement's figures: S1 to S3 on x/(1 + x^2) and x^3/(1 + x^4), S4 on mu_c against eps."""

import figure_2
import numpy as np
from claiming import mu_c
from drawing import ALPHA, BLACK, BLUE, EPS, RED, panels, results
from scipy.optimize import brentq

SOLVED = {  # figure: right-hand side, factor of alpha, values of alpha, largest R
    "S1": (lambda q: np.log1p(q), 1, (0.7, 0.15), 12.0),
    "S3": (lambda q: np.log1p(q * q), 2, (0.5, 0.11), 6.0),
}


def solutions(which: str, alpha: float) -> list[float]:
    """R >= 0 with factor pi alpha R = log(..)."""
    right, factor, _, largest = SOLVED[which]
    q = np.linspace(1e-4, 4 * largest, 20_000)
    values = factor * np.pi * alpha * q - right(q)
    places = np.flatnonzero(np.diff(np.sign(values)) != 0)
    return [0.0, *(brentq(lambda z: factor * np.pi * alpha * z - right(z), q[k], q[k + 1]) for k in places)]


def draw_solutions(which: str):
    right, factor, alphas, largest = SOLVED[which]
    drawing, axes = panels(1, 2, 6.6, 2.8)
    for ax, alpha in zip(axes[0], alphas, strict=True):
        q = np.linspace(0, largest, 400)
        ax.plot(
            q,
            factor * np.pi * alpha * q,
            color=BLACK,
            linestyle="--",
            label=rf"{factor if factor > 1 else ''}$\pi$ {ALPHA} R",
        )
        ax.plot(q, right(q), color=BLUE, label=f"log(1 + R{'²' if which == 'S3' else ''})")
        found = solutions(which, alpha)
        for k, place in enumerate(found):  # below the lowest solution R = 0 is stable iff its slope says so
            stable = factor * np.pi * alpha > 1 if which == "S1" and k == 0 else k % 2 == (1 if which == "S1" else 0)
            ax.plot([place], [right(place)], "o", color=BLACK if stable else "white", markeredgecolor=BLACK, zorder=3)
        ax.set(xlabel="R = r²", ylim=(-0.2, 1.35 * right(largest)))
        ax.set_title(f"{ALPHA} = {alpha}", fontsize=9)
        ax.legend(frameon=False, loc="lower right")
    return drawing


def draw_s2():
    drawing, axes = panels(1, 3, 9.6, 2.9)
    for ax, alpha in zip(axes[0], (0.7, 0.15), strict=False):
        figure_2.draw_flow(ax, "one-linear-rational", (alpha,), 2.5)
        ax.get_legend().remove()
        ax.set_title(f"{ALPHA} = {alpha}", fontsize=9)
    figure_2.draw_diagram(axes[0, 2], "linear-rational")
    return drawing


def mu_c_of_eps() -> tuple[np.ndarray, np.ndarray]:
    """eps and mu_c from the run pair-mu-c."""
    found = results("pair-mu-c.json")
    pairs = []
    for name, branch in found.items():
        values = [p["values"]["mu"] for p in branch["points"] if p["type"] == "BPC"]
        pairs += [(float(name.removeprefix("eps ").replace("_", ".")), value) for value in values[:1]]
    return tuple(np.array(column) for column in zip(*sorted(pairs), strict=True))


def draw_s4():
    eps, values = mu_c_of_eps()
    drawing, axes = panels(1, 1, 4.6, 3.2, " ")
    ax = axes[0, 0]
    ax.axhline(mu_c(0.3), color=BLACK, linewidth=1.4, label="first-order average")
    line = np.array([0, 0.052])
    ax.plot(line, mu_c(0.3) - 71.16 * line, color=BLUE, linestyle="--", linewidth=1.2, label="second-order average")
    ax.plot(eps, values, "x", color=RED, markersize=7, markeredgewidth=1.6, label="orbit, by continuation")
    ax.set(xlabel=EPS, ylabel=r"$\mu_\mathrm{c}$", xlim=(0, 0.052))
    ax.legend(frameon=False)
    return drawing


def check() -> None:
    """Numbers of solutions; the pitchfork of S2; mu_c at first and second order of averaging."""
    assert [len(solutions("S1", a)) for a in (0.7, 0.15)] == [1, 2]
    assert [len(solutions("S3", a)) for a in (0.5, 0.11)] == [1, 3]
    assert abs(results("escapement-linear-rational.json")["rest"]["points"][0]["values"]["alpha"] - 1 / np.pi) < 1e-9
    eps, values = mu_c_of_eps()
    assert len(eps) == 8
    slope = (values - mu_c(0.3)) / eps
    assert abs(2 * slope[0] - slope[1] + 71.16) < 0.3  # extrapolated to eps = 0 from 0.001 and 0.002
    assert np.all(np.diff(values) < 0)
