"""Every stable state of the averaged pair over the plane: from curves that continuation found, and by brute force.

`python docs/metronomes/all_states.py FILE` simulates again what pair-points.json holds.
"""

import json
import sys
from pathlib import Path

import numpy as np
from claiming import A, B, mu_c
from drawing import BETA, BLACK, BLUE, GREEN, MU, ORANGE, PINK, RED, SKY, panels, results

FOLD = 3 * A**2 / (16 * np.pi * B)
HERE = Path(__file__).resolve().parent
STATES = ("rest", "anti-phase", "in-phase", "unequal", "small beats", "large beats", "turning beats", "one alone")
CUSP = 0.4251  # of the upper folds of turning beats: below this mu their upper border was not found
ZERO_HOPF, BAUTIN, LOWEST = 0.84882, 0.85486, 0.7113  # beta where the border of "one alone" goes from curve to curve


class Curves:
    """The borders, from the results of `contin run metronomes/pair-states`."""

    def __init__(self):
        self.found = results("pair-states.json")

    def mu_at(self, name, beta, first=True):
        """mu of a curve at a beta, where no further eigenvalue is positive; the smallest, or nan."""
        mu, at = self.rows(name)
        crossed = np.flatnonzero((at[:-1] - beta) * (at[1:] - beta) <= 0)
        crossed = crossed[at[crossed] != at[crossed + 1]]
        values = mu[crossed] + (beta - at[crossed]) / (at[crossed + 1] - at[crossed]) * (mu[crossed + 1] - mu[crossed])
        return (min if first else max)(values) if len(values) else np.nan

    def beta_at(self, name, mu):
        """beta of a curve that is a graph over mu."""
        at, beta = self.rows(name)
        order = np.argsort(at)
        return float(np.interp(mu, at[order], beta[order], left=np.nan, right=np.nan))

    def rows(self, name):
        """mu and beta of the rows that are borders of stability (all rows of homoclinic orbits)."""
        columns = self.found[name]["columns"]
        kept = np.array(columns["stable"], dtype=bool) | (name == "gluing")
        return np.array(columns["mu"])[kept], np.array(columns["beta"])[kept]

    def alone_up_to(self, beta):
        """The largest mu at which one metronome swings alone."""
        if beta < LOWEST:
            return self.mu_at("Hopf alone", beta)
        if beta < ZERO_HOPF:
            return self.mu_at("fold alone", beta, first=False)
        return self.mu_at("Hopf alone" if beta < BAUTIN else "upper fold alone", beta)

    def stable(self, mu, beta):
        """Names of the states that are stable at a point."""
        if beta >= FOLD:
            return {"rest"}
        near = [self.mu_at(name, beta) for name in ("folds of large beats", "gluing", "hopf")] + [mu_c(beta)]
        names = {"rest", "anti-phase"} | ({"one alone"} if mu < self.alone_up_to(beta) else set())
        for k, name in enumerate(("large beats", "small beats", "unequal")):
            if near[k] < mu < near[k + 1]:
                names.add(name)
        if mu > near[3]:
            names.add("in-phase")
        lower, upper = (self.beta_at(name, mu) for name in ("folds of turning beats", "upper folds of turning beats"))
        return names | ({"turning beats"} if mu > CUSP and lower < beta < upper else set())


def rates(z, mu, beta):
    """The averaged equations, in complex amplitudes (2, ...)."""
    size = np.abs(z) ** 2
    own = -beta / 2 + size * (3 * A - 2 * B * size) / (12 * np.pi) - 1j * size * (3 * A / 16 - 5 * B * size / 32)
    return z * own + 0.5j * mu * z.sum(axis=0)


def simulated(points=200, seed=5, step=0.02, settle=400.0, watch=80.0):
    """Names of the states on which 15 starts settle, at random points (a third: mu at random in its logarithm)."""
    random = np.random.default_rng(seed)
    mu, beta = random.uniform(0.05, 15, points), random.uniform(0.02, 1.2, points)
    mu[: points // 3] = np.exp(random.uniform(np.log(0.05), np.log(15), points // 3))
    starts = [
        (2.1, 2.0, 0.05), (2.1, 2.1, 3.0), (2.1, 0.02, 0.5), (2.2, 0.6, 1.0), (2.1, 1.5, 0.3), (2.1, 2.0, 1.5),
        (2.3, 2.0, -0.2), (1.8, 1.0, 2.0), (2.3, 0.1, 2.0), (2.2, 2.15, 0.02), (2.4, 1.2, -1.0), (2.0, 0.8, -2.5),
        (2.4, 2.2, 0.1), (0.02, 0.01, 1.0), (2.45, 0.25, 2.8),
    ]  # fmt: skip
    z = np.array([[r1, r2 * np.exp(1j * psi)] for r1, r2, psi in starts]).T[:, None, :] * np.ones((1, points, 1))
    m, b = mu[:, None], beta[:, None]

    def advanced(z):
        one = rates(z, m, b)
        two = rates(z + step / 2 * one, m, b)
        three = rates(z + step / 2 * two, m, b)
        return z + step / 6 * (one + 2 * two + 2 * three + rates(z + step * three, m, b))

    for _ in range(round(settle / step)):
        z = advanced(z)
    low, high = np.abs(z), np.abs(z)
    for _ in range(round(watch / step)):
        z = advanced(z)
        low, high = np.minimum(low, np.abs(z)), np.maximum(high, np.abs(z))
    names = named(low, high, np.abs(np.angle(z[1] * np.conj(z[0]))))
    return [{"mu": float(mu[k]), "beta": float(beta[k]), "states": sorted(set(names[k]))} for k in range(points)]


def named(low, high, psi):
    """The name of each trajectory from its smallest and largest amplitudes and its last phase difference."""
    steady = np.all(high - low < 2e-3, axis=0)
    equal = np.abs(high[0] - high[1]) < 2e-3
    alike = equal & (np.abs(low[0] - low[1]) < 0.02) | (np.abs(high[0] - high[1]) < 0.02)
    names = np.where(low.min(axis=0) < 1.0, "turning beats", np.where(alike, "large beats", "small beats"))
    names = np.where(steady & ~equal, np.where(low.min(axis=0) < 0.6 * high.max(axis=0), "one alone", "unequal"), names)
    names = np.where(steady & equal, np.where(psi < 1.5, "in-phase", "anti-phase"), names)
    return np.where(high.max(axis=0) < 0.05, "rest", names)


def stored():
    """What `simulated` gave."""
    return json.loads((HERE / "pair-points.json").read_text(encoding="utf-8"))


def compared():
    """Points where a start settles on a state that the curves do not have; and where none finds one that they have."""
    curves = Curves()
    wrong, missed = [], []
    for point in stored():
        expected, found = curves.stable(point["mu"], point["beta"]), set(point["states"])
        wrong += [(point["mu"], point["beta"], name) for name in sorted(found - expected)]
        missed += [(point["mu"], point["beta"], name) for name in sorted(expected - found)]
    return wrong, missed


def draw():
    """Regions of the states, and the points of the brute force."""
    curves = Curves()
    drawing, axes = panels(1, 2, 9.6, 4.6)
    curves_drawn = {
        "mu_c": BLACK, "hopf": GREEN, "gluing": RED, "folds of large beats": BLUE, "folds of turning beats": PINK,
        "upper folds of turning beats": PINK, "fold alone": ORANGE, "upper fold alone": ORANGE, "Hopf alone": ORANGE,
    }  # fmt: skip
    marks = (
        ("unequal", GREEN, "*"), ("small beats", RED, "^"), ("large beats", BLUE, "s"), ("turning beats", PINK, "o"),
        ("one alone", ORANGE, "x"), ("in-phase", BLACK, "."),
    )  # fmt: skip
    hollow = {"linestyle": "none", "markerfacecolor": "none"}
    for ax in axes[0]:
        for name, colour in curves_drawn.items():
            mu, beta = curves.rows(name)
            ax.plot(mu, beta, "--" if name == "Hopf alone" else "-", color=colour, linewidth=1.3)
        ax.axhline(FOLD, color="0.5", linewidth=1.0)
        for name, colour, mark in marks:
            at = [(p["mu"], p["beta"]) for p in stored() if name in p["states"]]
            if at:
                ax.plot(*zip(*at, strict=True), mark, color=colour, markersize=4, **hollow)
        rest = [(p["mu"], p["beta"]) for p in stored() if p["states"] == ["rest"]]
        ax.plot(*zip(*rest, strict=True), "_", color=SKY, markersize=3, linestyle="none")
        ax.set(xlabel=MU, ylim=(0, 1.2))
    axes[0, 0].set(ylabel=BETA, xscale="log", xlim=(0.05, 15))
    axes[0, 1].set(xlim=(0, 15))
    for name, colour, mark in (*marks, ("rest alone", SKY, "_")):
        axes[0, 0].plot([], [], mark, color=colour, label=name, **hollow)
    drawing.legend(loc="outside lower center", ncols=7, frameon=False, fontsize=8)
    return drawing


if __name__ == "__main__":
    text = ",\n".join(json.dumps(point) for point in simulated())
    Path(sys.argv[1]).write_text(f"[\n{text}\n]\n", encoding="utf-8")
