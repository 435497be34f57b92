"""Figure 2: shape of the escapements, flow of the amplitude, and bifurcation diagrams with sweeps over them."""

import numpy as np
from claiming import averaged, rates
from drawing import ALPHA, BLACK, BLUE, GREEN, RED, curve, panels, points, results, table
from scipy.optimize import brentq

import contin

MODELS = (  # bundled model, run file, shape of g for y > 0, range of x, two values of alpha, greatest r of the flow
    ("one-constant", "constant", lambda x: ((x > 1) & (x < 1.5)).astype(float), (0, 2.5), (0.1, 0.2), 2.6),
    ("one-rational", "rational", lambda x: x**3 / (1 + x**4), (0, 6), (0.1, 0.2), 3.0),
    ("one", "polynomial", lambda x: 4 * x**3 - x**5, (0, 2.3), (0.7, 1.1), 2.3),
)


def flow(name: str, alpha: float, r: np.ndarray) -> np.ndarray:
    """r' of the averaged equation, in fast time (eps = 0.01)."""
    return 0.01 * np.array([rates(averaged(name), [value], alpha=alpha)[0] for value in r])


def zeros(r: np.ndarray, speed: np.ndarray, name: str, alpha: float) -> list[tuple[float, bool]]:
    """Amplitudes where the flow stands still, and whether it returns there."""
    found = [(0.0, bool(speed[1] < 0))]
    for k in np.flatnonzero(np.diff(np.sign(speed[1:])) != 0) + 1:
        place = brentq(lambda q: rates(averaged(name), [q], alpha=alpha)[0], r[k], r[k + 1])
        found.append((float(place), bool(speed[k] > 0)))
    return found


def draw_flow(ax, name, alphas, largest) -> None:
    r = np.linspace(0, largest, 400)
    for alpha, colour, dashes in zip(alphas, (BLUE, RED), ("-", "-."), strict=False):
        speed = flow(name, alpha, r)
        ax.plot(r, 1e3 * speed, color=colour, linestyle=dashes, linewidth=1.4, label=f"{ALPHA} = {alpha}")
        for place, stable in zeros(r, speed, name, alpha):
            ax.plot(
                [place], [0], "o", color=BLACK if stable else "white", markeredgecolor=BLACK, markersize=5, zorder=3
            )
    ax.axhline(0, color="0.6", linewidth=0.6)
    ax.set(xlabel="amplitude r", ylabel="1000 dr/dt")
    ax.legend(frameon=False)


def draw_diagram(ax, run, down=True) -> None:
    branches, sweep = results(f"escapement-{run}.json"), table(f"escapement-{run}.csv")
    for name, branch in branches.items():
        if not branch["image_of"]:
            curve(ax, branch, "alpha", "r", BLUE if name == "oscillating" else "0.45", zorder=1)
    for direction, marker, colour, face in ((1, "x", GREEN, GREEN), (-1, "o", RED, "none")):
        rows = sweep["direction"] == direction
        words = f"simulated, {ALPHA} {'up' if direction > 0 else 'down'}"
        if rows.any():
            ax.plot(
                sweep["alpha"][rows], sweep["r.mean"][rows], marker, color=colour, markerfacecolor=face, markersize=5,
                linestyle="none", label=words, zorder=3,
            )  # fmt: skip
    ax.set(xlabel=f"damping {ALPHA}", ylabel="amplitude r", ylim=(-0.1, None))
    ax.legend(frameon=False, loc="upper right" if run != "polynomial" else (0.38, 0.2))


def draw():
    drawing, axes = panels(3, 3, 9.6, 8.0)
    for row, (name, run, shape, ends, alphas, largest) in zip(axes, MODELS, strict=True):
        x = np.linspace(*ends, 1000)
        row[0].plot(x, shape(x), color=BLACK, linewidth=1.4)
        row[0].axhline(0, color="0.6", linewidth=0.6)
        row[0].set(xlabel="x (for x' > 0)", ylabel="escapement g")
        if name == "one":
            row[0].set_ylim(-12, 8)
        draw_flow(row[1], name, alphas, largest)
        draw_diagram(row[2], run)
    return drawing


def deviations() -> dict[str, float]:
    """Largest difference between the simulated mean amplitude and the averaged one, by run, away from the jump."""
    worst = {}
    for name, run, *_ in MODELS:
        branch, sweep = results(f"escapement-{run}.json")["oscillating"], table(f"escapement-{run}.csv")
        alpha, r = np.array(branch["columns"]["alpha"]), np.array(branch["columns"]["r"])
        turn = int(np.argmax(alpha))
        upper = slice(0, turn + 1) if r[0] > r[-1] else slice(turn, None)
        order = np.argsort(alpha[upper])
        rows = (sweep["direction"] == 1) & (sweep["r.mean"] > 0.1)
        averages = [
            float(contin.equilibrium(averaged(name), {"r": guess}, {"alpha": value}).u[0])
            for value, guess in zip(
                sweep["alpha"][rows],
                np.interp(sweep["alpha"][rows], alpha[upper][order], r[upper][order]),
                strict=True,
            )
        ]
        worst[run] = float(np.abs(sweep["r.mean"][rows] - averages).max())
    return worst


def check() -> None:
    """Folds in closed form; simulated amplitudes follow the average; the jumps lie beside the folds."""
    folds = {"constant": 1 / (np.pi * 1.5**2), "rational": 0.12807872173209018, "polynomial": 3 / np.pi}
    for run, fold in folds.items():
        found = points(results(f"escapement-{run}.json")["oscillating"], "LP", "alpha")
        assert len(found) == 1
        assert abs(found[0] - fold) < 1e-8
        sweep = table(f"escapement-{run}.csv")
        last = sweep["alpha"][(sweep["direction"] == 1) & (sweep["r.mean"] > 0.1)].max()
        step = sweep["alpha"][1] - sweep["alpha"][0]
        assert last < fold < last + step
        assert sweep["r.mean"][sweep["direction"] == -1].max() < 1e-3  # rest is kept on the way down
    bounds = {"constant": 0.03, "rational": 0.07, "polynomial": 0.01}
    assert all(worst < bounds[run] for run, worst in deviations().items())
