"""Figure 4: the phase diagram of two metronomes, by brute force, by continuation, and by the paper's formulas."""

import json
from pathlib import Path

import numpy as np
from claiming import EPS, A, B, mu_c
from drawing import BETA, BLACK, BLUE, GREEN, MU, ORANGE, PINK, RED, panels, points, results

FOLD = 3 * A**2 / (16 * np.pi * B)
TRIPLE_ZERO = 9 * A**2 / (128 * B)  # mu at which the pitchfork of in-phase synchrony reaches its fold
HERE = Path(__file__).resolve().parent


def brute_force() -> dict:
    """The stored scan: 60 x 60 points, four starts, one letter a run; `contin run metronomes/pair-scan` repeats it."""
    found = json.loads((HERE / "pair-scan.json").read_text(encoding="utf-8"))
    letters = {name: np.array([list(line) for line in lines]) for name, lines in found["starts"].items()}
    mu, beta = np.meshgrid(found["mu"], found["beta"])
    anti = (letters["near anti-phase"] == "A") & (letters["anti-phase"] == "A")
    inside = letters["in-phase"] == "I"
    return {
        "mu": mu,
        "beta": beta,
        "letters": letters,
        "anti-phase": anti,
        "in-phase": inside,
        "in-phase stable": inside & (letters["near in-phase"] == "I"),
    }


def predicted(mu, beta) -> dict:
    """The same three sets from the paper's formulas."""
    with np.errstate(invalid="ignore"):
        critical = np.where(beta < FOLD, [[mu_c(b) if b < FOLD else np.inf for b in row] for row in beta], np.inf)
    inside = beta < FOLD / np.sqrt(1 + 2 * EPS * mu)
    return {"anti-phase": beta < FOLD, "in-phase": inside, "in-phase stable": inside & (mu > critical)}


def disagreements() -> dict[str, int]:
    """Points of the grid where brute force and formula differ, of 3600."""
    found = brute_force()
    formula = predicted(found["mu"], found["beta"])
    return {name: int(np.sum(found[name] != formula[name])) for name in formula}


def coarse_agrees(columns) -> float:
    """Share of the runs of a coarse scan (its CSV) whose class is that of the nearest point of the stored one."""
    stored = brute_force()
    starts = list(stored["letters"])
    names = {"quenched": ".", "in-phase": "I", "anti-phase": "A", "unequal": "U", "beating": "B"}
    same = []
    for mu, beta, start, label in zip(*(columns[k] for k in ("mu", "beta", "start", "class")), strict=True):
        row = int(np.argmin(np.abs(stored["beta"][:, 0] - beta)))
        column = int(np.argmin(np.abs(stored["mu"][0] - mu)))
        same.append(stored["letters"][starts[int(start.removeprefix("start")) - 1]][row, column] == names.get(label))
    return float(np.mean(same))


def orbit_points() -> dict[str, np.ndarray]:
    """(mu, beta) of folds and branch points of the synchronous orbits at eps = 0.01, from pair-orbits.json."""
    found: dict[str, list] = {"in-phase fold": [], "in-phase branch point": [], "anti-phase fold": []}
    for name, branch in results("pair-orbits.json").items():
        which = "anti-phase" if name.startswith("anti") else "in-phase"
        for type_, words in (("LPC", "fold"), ("BPC", "branch point")):
            for mu, beta in zip(points(branch, type_, "mu"), points(branch, type_, "beta"), strict=True):
                if f"{which} {words}" in found:
                    found[f"{which} {words}"].append((mu, beta))
    return {name: np.array(pairs) for name, pairs in found.items()}


def draw():
    found, loci = brute_force(), results("pair-loci.json")
    drawing, axes = panels(1, 1, 7.2, 5.6, " ")
    ax = axes[0, 0]
    mu, beta = found["mu"], found["beta"]
    ax.pcolormesh(mu, beta, np.where(found["anti-phase"], 1.0, np.nan), cmap="Blues", vmin=0, vmax=4.5, rasterized=True)
    unstable = found["in-phase"] & ~found["in-phase stable"]
    ax.plot(mu[unstable], beta[unstable], "^", color=GREEN, markersize=2.6, linestyle="none")
    stable = found["in-phase stable"]
    ax.plot(mu[stable], beta[stable], "x", color=RED, markersize=2.6, markeredgewidth=0.7, linestyle="none")
    low, high = float(mu.min()), float(mu.max())
    line, column = np.linspace(0, high, 200), np.linspace(0.01, FOLD, 200)
    ax.axhline(FOLD, color=BLACK, linestyle="-.", linewidth=1.6, label=r"formula: $\beta_\mathrm{SN}$")
    ax.plot(
        line, FOLD / np.sqrt(1 + 2 * EPS * line), color=BLACK, linewidth=1.6, label=r"formula: $\beta_\mathrm{SN\_in}$"
    )
    ax.plot(
        [mu_c(b) for b in column],
        column,
        color=BLACK,
        linestyle="--",
        linewidth=1.6,
        label=r"formula: $\mu_\mathrm{c}$",
    )
    for name, colour, dashes, words in (
        ("mu_c", PINK, (0, (1, 1.4)), "average, continued: pitchfork"),
        ("beta_SN", BLUE, (0, (1, 1.4)), "average, continued: fold"),
        ("hopf", ORANGE, "-", "average, continued: Hopf points of the unequal states"),
    ):
        columns = loci[name]["columns"]
        ax.plot(
            columns["mu"],
            columns["beta"],
            color=colour,
            linestyle=dashes,
            linewidth=1.3 if name == "hopf" else 2.6,
            label=words,
            zorder=3,
        )
    orbit = orbit_points()
    for name, marker, face in (
        ("in-phase fold", "s", "white"), ("in-phase branch point", "D", "white"), ("anti-phase fold", "o", "white"),
    ):  # fmt: skip
        pairs = orbit[name]
        ax.plot(
            pairs[:, 0], pairs[:, 1], marker, color=BLACK, markerfacecolor=face, markersize=6, markeredgewidth=1.3,
            linestyle="none", label=f"orbit, {EPS_WORDS}: {name}", zorder=4,
        )  # fmt: skip
    ax.plot([], [], "s", color="#b9d6ea", markersize=8, linestyle="none", label="simulated: anti-phase stable")
    ax.plot([], [], "^", color=GREEN, markersize=5, linestyle="none", label="simulated: in-phase, unstable")
    ax.plot([], [], "x", color=RED, markersize=5, linestyle="none", label="simulated: in-phase, stable")
    ax.set(xlabel=f"{MU} (mass ratio over $\\varepsilon$)", ylabel=f"{BETA} (damping over $\\varepsilon$)")
    ax.set(xlim=(0, high + 0.5 * low), ylim=(0, 1.2))
    drawing.legend(loc="outside lower center", ncols=2, frameon=False, fontsize=8)
    return drawing


EPS_WORDS = r"$\varepsilon$ = 0.01"


def check() -> None:
    """Loci are the closed forms; the points of the orbits lie on the borders that simulation found."""
    loci = {name: branch["columns"] for name, branch in results("pair-loci.json").items()}
    formula = [mu_c(beta) for beta in loci["mu_c"]["beta"] if beta < FOLD - 1e-9]
    np.testing.assert_allclose(loci["mu_c"]["mu"][-len(formula) :], formula, rtol=1e-6)
    np.testing.assert_allclose(loci["beta_SN"]["beta"], FOLD, rtol=1e-8)
    found, orbit = brute_force(), orbit_points()
    mus, betas = found["mu"][0], found["beta"][:, 0]
    for mu, beta in orbit["in-phase branch point"]:
        if mu < TRIPLE_ZERO:  # beyond the fold, on the small orbits, which are unstable anyway
            continue
        row = found["in-phase stable"][int(np.argmin(np.abs(betas - beta)))]
        assert row[np.searchsorted(mus, mu + 0.3)]
        assert not row[np.searchsorted(mus, mu - 0.6)]
    for mu, beta in orbit["in-phase fold"]:
        column = found["in-phase"][:, int(np.argmin(np.abs(mus - mu)))]
        assert abs(betas[column].max() - beta) < 0.025
        scaled = beta * np.sqrt(1 + 2 * EPS * mu)  # in-phase motion is that of one metronome, scaled
        assert abs(scaled / orbit["anti-phase fold"][0, 1] - 1) < 1e-7
    assert len(orbit["anti-phase fold"]) == 1
    assert betas[found["anti-phase"].any(axis=1)].max() < orbit["anti-phase fold"][0, 1] < 0.98
    assert disagreements() == {"anti-phase": 60, "in-phase": 25, "in-phase stable": 120}
