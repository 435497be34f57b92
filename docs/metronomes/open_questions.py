"""Figures and numbers of the open questions, from the results of the run files."""

import json
from pathlib import Path

import numpy as np
from claiming import mu_c, r_star
from drawing import (
    BETA,
    BLACK,
    BLUE,
    GREEN,
    MU,
    ORANGE,
    PINK,
    RED,
    SIGMA,
    SKY,
    MarkdownTable,
    curve,
    panels,
    points,
    results,
    table,
)
from figure_4 import FOLD, brute_force

import contin


def draw_diagram():
    """Every family at beta = 0.8: amplitude of metronome 1, and periods of the beats."""
    found = results("pair-diagram.json")
    drawing, axes = panels(1, 2, 9.6, 3.9)
    left, right = axes[0]
    colours = {
        "in-phase": BLACK, "anti-phase": "0.55", "unequal": GREEN, "unequal~exchange": GREEN, "small beats": RED,
        "large beats": BLUE, "turning beats": PINK,
    }  # fmt: skip
    for name, colour in colours.items():
        branch = found[name]
        for column in ("r1",) if branch["kind"] == "equilibrium" else ("r1.max", "r1.min"):
            curve(left, branch, "mu", column, colour)
        left.plot([], [], color=colour, linewidth=1.9, label=None if "~" in name else name)
        if branch["kind"] == "orbit":
            curve(right, branch, "mu", "period", colour)
    for name, type_, marker in (
        ("in-phase", "BP", "D"), ("unequal", "HB", "o"), ("unequal~exchange", "HB", "o"), ("unequal", "LP", "s"),
        ("unequal~exchange", "LP", "s"),
    ):  # fmt: skip
        branch = found[name]
        left.plot(
            points(branch, type_, "mu"), points(branch, type_, "r1"), marker, color="white", markeredgecolor=BLACK,
            markersize=5, linestyle="none", zorder=3,
        )  # fmt: skip
    right.axvline(points(found["large beats"], "HOM", "mu")[0], color="0.4", linestyle=":", linewidth=1.0)
    right.annotate("gluing", (4.47, 27), xytext=(5, 0), textcoords="offset points", fontsize=8)
    left.set(xlabel=MU, ylabel=r"$r_1$ (beats: largest and smallest)", ylim=(0, 2.45))
    right.set(xlabel=MU, ylabel=r"period of the beats, in 1/$\varepsilon$", ylim=(0, 30), xlim=(0.5, 8))
    drawing.legend(loc="outside lower center", ncols=6, frameon=False, fontsize=8)
    return drawing


def draw_plane():
    """What the near in-phase start settles on at eps = 0.01, and the curves of the averaged equations over it."""
    found, loci, beats = brute_force(), results("pair-loci.json"), results("pair-beats.json")
    drawing, axes = panels(1, 1, 7.4, 5.2, " ")
    ax = axes[0, 0]
    letters, mu, beta = found["letters"]["near in-phase"], found["mu"], found["beta"]
    for letter, words, colour, marker in (
        ("A", "anti-phase", SKY, "_"), ("B", "beating", ORANGE, "s"), ("U", "unequal amplitudes", GREEN, "^"),
        ("I", "in-phase", "0.6", "."),
    ):  # fmt: skip
        rows = letters == letter
        ax.plot(
            mu[rows], beta[rows], marker, color=colour, markersize=3.2, linestyle="none", label=f"simulated: {words}"
        )
    for branch, colour, dashes, words in (
        (loci["mu_c"], BLACK, "--", "pitchfork of in-phase synchrony"),
        (loci["hopf"], RED, "-", "Hopf points: small beats are born"),
        (beats["folds of large beats"], BLUE, "-.", "folds of large beats"),
        (beats["folds of turning beats"], PINK, "-", "folds of turning beats, lower"),
        (beats["upper folds"], PINK, (0, (5, 1.5)), "folds of turning beats, upper"),
    ):
        columns = branch["columns"]
        ax.plot(columns["mu"], columns["beta"], color=colour, linestyle=dashes, linewidth=1.8, label=words, zorder=3)
    ax.axhline(FOLD, color=BLACK, linestyle=":", linewidth=1.2, label=r"$\beta_\mathrm{SN}$")
    ax.set(xlabel=MU, ylabel=BETA, xlim=(0, 15), ylim=(0, 1.1))
    drawing.legend(loc="outside lower center", ncols=2, frameon=False, fontsize=8)
    return drawing


def borders(row_beta: float) -> dict[str, tuple[float, float]]:
    """At one beta: mu where simulation (eps = 0.01) and average begin to beat, end to beat, and become synchronous."""
    found, loci, beats = brute_force(), results("pair-loci.json"), results("pair-beats.json")
    row = int(np.argmin(np.abs(found["beta"][:, 0] - row_beta)))
    letters, mus = found["letters"]["near in-phase"][row], found["mu"][0]
    first = {letter: mus[letters == letter].min() - 0.125 for letter in "BUI" if np.any(letters == letter)}
    averaged = {
        "B": ("fold of beats", min(_across(beats[f"folds of {k} beats"], row_beta) for k in ("large", "turning"))),
        "U": ("Hopf point", _across(loci["hopf"], row_beta)),
        "I": ("pitchfork", mu_c(row_beta)),
    }
    return {
        words: (float(first[letter]), float(value)) for letter, (words, value) in averaged.items() if letter in first
    }


def _across(branch: dict, beta: float) -> float:
    """Largest mu at which a locus crosses this beta; inf where it does not."""
    mus, betas = (np.array(branch["columns"][name], dtype=float) for name in ("mu", "beta"))
    places = np.flatnonzero((betas[:-1] - beta) * (betas[1:] - beta) <= 0)
    if not len(places):
        return float("inf")
    part = (beta - betas[places]) / (betas[places + 1] - betas[places])
    return float((mus[places] + part * (mus[places + 1] - mus[places])).max())


def draw_pendulum():
    """Loci in mu and sigma at beta = 0.8."""
    found = results("pair-pendulum.json")
    drawing, axes = panels(1, 1, 5.2, 3.6, " ")
    ax = axes[0, 0]
    for name, colour, dashes, words in (
        ("mu_c", BLACK, "--", "pitchfork of in-phase synchrony"), ("hopf", RED, "-", "Hopf points"),
        ("folds", BLUE, "-.", "folds of unequal states"),
    ):  # fmt: skip
        columns = found[name]["columns"]
        ax.plot(columns["mu"], columns["sigma"], color=colour, linestyle=dashes, linewidth=1.7, label=words)
    ax.axhline(0, color="0.6", linewidth=0.6)
    ax.set(xlabel=MU, ylabel=f"pendulum term {SIGMA}", xlim=(0, 12), ylim=(-2, 2))
    ax.legend(frameon=False)
    return drawing


def draw_unlike():
    """Unfolding by unequal springs (a: branches, b: loci) and by unequal dampings (c)."""
    springs, damping = results("pair-unlike-springs.json"), results("pair-unlike-damping.json")
    drawing, axes = panels(1, 3, 10.2, 3.5)
    first, second, third = axes[0]
    for name, colour in (("connected", BLUE), ("cut off", RED)):
        curve(first, springs[name], "mu", "S1", colour)
        first.plot([], [], color=colour, label=name)
    first.set(
        xlabel=MU, ylabel=r"$S_1 = r_1^2 - r_2^2$", xlim=(3.8, 5.6), ylim=(-1.5, 1.5), title="springs: delta = 0.005"
    )
    first.legend(frameon=False)
    for name, colour, dashes in (("folds", BLUE, "-."), ("hopf", RED, "-")):
        columns = springs[name]["columns"]
        second.plot(columns["mu"], columns["delta"], color=colour, linestyle=dashes, linewidth=1.7, label=name)
    for type_, marker in (("CP", "v"), ("BT", "h")):
        second.plot(
            points(springs["folds"], type_, "mu"), points(springs["folds"], type_, "delta"), marker, color="white",
            markeredgecolor=BLACK, markersize=6, linestyle="none", label=type_, zorder=3,
        )  # fmt: skip
    second.set(
        xlabel=MU, ylabel="difference of the springs, delta", xlim=(3.8, 5.0), ylim=(-0.06, 0.06), title="springs"
    )
    second.legend(frameon=False)
    for name, colour in (("near in-phase", BLACK), ("unequal", GREEN)):
        curve(third, damping[name], "mu", "S1", colour)
        third.plot([], [], color=colour, label=name)
    third.set(
        xlabel=MU, ylabel=r"$S_1 = r_1^2 - r_2^2$", xlim=(3.8, 5.6), ylim=(-1.5, 1.5), title="dampings: skew = 0.1"
    )
    third.legend(frameon=False)
    for ax in axes[0]:
        ax.title.set_fontsize(9)
    return drawing


def draw_three():
    """Three metronomes: amplitudes of all states, where they are born in the plane, and what simulations settle on."""
    found, scan = results("three-states.json"), table("three-scan.csv")
    drawing, axes = panels(1, 3, 11.4, 3.7)
    left, middle, right = axes[0]
    for name, columns, colour, words in (
        ("in-phase", ("r1",), BLACK, "in phase"),
        ("in-phase/BP1", ("r1", "r2"), BLUE, "two and one"),
        ("in-phase/BP1/BP1", ("r1", "r2", "r3"), ORANGE, "all unequal"),
        ("beats", ("r1.max", "r1.min"), RED, "beats born at a Hopf point"),
        ("beats near in-phase", ("r1.max", "r1.min"), PINK, "beats found by simulation"),
    ):
        branch = found[name]
        if len(columns) == 3:  # its arms are mirror images: one is drawn, or the dashes of one fill the other's gaps
            branch = branch | {"columns": {k: v[: len(v) // 2] for k, v in branch["columns"].items()}}
        for column in columns:
            curve(left, branch, "mu", column, colour)
        left.plot([], [], color=colour, label=words)
    left.set(xlabel=MU, ylabel="amplitudes", xlim=(0, 5), ylim=(0, 2.9))
    left.legend(frameon=False, fontsize=8, ncols=2, loc="upper center")
    column = np.linspace(0.05, FOLD, 200)
    middle.plot([2 / 3 * mu_c(b) for b in column], column, color=BLACK, linestyle="--", label=r"formula: $2\mu_c/3$")
    for name, colour, words in (
        ("fold", GREEN, "fold beside it"),
        ("hopf", RED, "Hopf points"),
        ("end of two against one", BLUE, "two against one ends"),
    ):
        columns = found[name]["columns"]
        middle.plot(columns["mu"], columns["beta"], color=colour, label=words)
    middle.set(xlabel=MU, ylabel=BETA, xlim=(0, 8), ylim=(0, 1))
    middle.legend(frameon=False, fontsize=8)
    starts = {"start1": "near in-phase", "start2": "two against one", "start3": "splay"}
    looks = zip(dict.fromkeys(scan["class"]), "osD^vP*", (BLUE, GREEN, RED, ORANGE, PINK, BLACK, SKY), strict=False)
    for label, marker, colour in looks:
        rows = scan["class"] == label
        heights = [list(starts).index(start) for start in scan["start"][rows]]
        right.plot(scan["mu"][rows], heights, marker, color=colour, linestyle="none", label=label)
    right.set_yticks(range(3), [f"from {words}" for words in starts.values()])
    right.set(xlabel=MU, ylim=(-0.5, 4.4))
    right.legend(frameon=False, ncols=2, loc="upper right", fontsize=8)
    return drawing


CHAOS = ("beats", "torus", "chaos", "motion")  # simulations of `three-chaos`


def simulated(name: str) -> dict:
    """A simulation of `three-chaos`."""
    document = json.loads(Path("three-chaos.json").read_text(encoding="utf-8"))
    return next(one for one in document["simulations"] if one["name"] == name)


def draw_chaos():
    """Amplitudes of metronomes 2 and 3 against each other: a cycle, a torus, chaos, and chaos before averaging."""
    drawing, axes = panels(1, 4, 11.4, 3.2)
    for ax, name in zip(axes[0], CHAOS, strict=True):
        found = simulated(name)
        columns = {key: np.array(values) for key, values in found["columns"].items()}
        x, y = ("x", "y") if name == "motion" else ("u", "v")
        r2, r3 = (np.hypot(columns[f"{x}{i}"], columns[f"{y}{i}"]) for i in (2, 3))
        ax.plot(r2, r3, ",", color=BLUE)
        ax.set(xlabel="$r_2$", ylabel="$r_3$", title=f"{name}, mu = {found['parameters']['mu']:g}")
        ax.title.set_fontsize(9)
    return drawing


def chaos_table() -> MarkdownTable:
    """Lyapunov exponents a unit of slow time."""
    rows = []
    for name in CHAOS:
        found, unit = simulated(name), 0.01 if name == "motion" else 1.0
        pairs = zip(found["lyapunov"]["exponents"], found["lyapunov"]["errors"], strict=True)
        words = ", ".join(f"{value / unit:.4f} +- {error / unit:.4f}" for value, error in list(pairs)[:3])
        rows.append((name, f"{found['parameters']['mu']:g}", words))
    return MarkdownTable("simulation | mu | three largest Lyapunov exponents", rows)


def check_chaos() -> None:
    """The rotation and the flow give two exponents 0; a torus a third; chaos a positive one instead."""
    for name, signs in (("beats", "00--"), ("torus", "000-"), ("chaos", "+00-"), ("motion", "+00")):
        found = simulated(name)["lyapunov"]
        pairs = zip(found["exponents"], found["errors"], strict=True)
        assert "".join("+" if x > e else "-" if x < -e else "0" for x, e in pairs) == signs, (name, found)


def family(name: str) -> str:
    """Which metronomes move alike on a branch of four metronomes, as "3 + 1"."""
    columns = results("four-states.json")[name]["columns"]
    row = len(columns["mu"]) // 3
    states = np.round([(columns[f"u{i}"][row], columns[f"v{i}"][row]) for i in range(1, 5)], 6)
    counts = np.unique(states, axis=0, return_counts=True)[1]
    return " + ".join(str(c) for c in sorted(counts, reverse=True))


def four_states() -> dict[str, dict]:
    """Branches of four metronomes that are not images of another."""
    found = results("four-states.json").items()
    return {name: branch for name, branch in found if not branch["image_of"] and branch["kind"] != "locus"}


def ever_stable(branch: dict, branches: dict[str, dict]) -> bool:
    """Is any row stable, apart from special points and its birth, where critical eigenvalues do not count?"""
    stable = np.array(branch["columns"]["stable"])
    stable[[point["index"] for point in branch["points"]]] = False
    if branch["parent"]:
        parent = branches[branch["parent"]["branch"]]
        born = next(p for p in parent["points"] if p["label"] == branch["parent"]["label"])["values"]["mu"]
        stable &= np.abs(np.array(branch["columns"]["mu"]) - born) > 1e-9
    return bool(stable.any())


def four_table() -> MarkdownTable:
    """The families of four metronomes: how many move alike, where they exist, stability."""
    rows, seen = [], set()
    for name, branch in four_states().items():
        mu = np.array(branch["columns"]["mu"])
        row = family(name), f"{mu.min():.4f} to {mu.max():.4f}"
        if name != "in-phase" and (row[0], row[1][-6:]) not in seen:
            born = branch["parent"]
            where = points(results("four-states.json")[born["branch"]], "BP", "mu")
            at = where[int(born["label"].removeprefix("BP")) - 1]
            rows.append(
                (*row, f"{at:.6f}", "somewhere" if ever_stable(branch, results("four-states.json")) else "nowhere")
            )
            seen.add((row[0], row[1][-6:]))
    return MarkdownTable("alike | mu | born at mu | stable", rows)


def draw_four():
    """Where the clusters of four metronomes are born, fold and begin to beat."""
    found = results("four-states.json")
    drawing, axes = panels(1, 1, 5.0, 3.6, " ")
    ax, column = axes[0, 0], np.linspace(0.05, FOLD, 200)
    ax.plot([mu_c(b) / 2 for b in column], column, color=BLACK, linestyle="--", label=r"formula: $\mu_c/2$")
    for name, colour, words in (
        ("fold", GREEN, "fold of three and one"),
        ("hopf of three and one", RED, "Hopf points of three and one"),
        ("hopf of pairs", BLUE, "Hopf points of two and two"),
    ):
        ax.plot(found[name]["columns"]["mu"], found[name]["columns"]["beta"], color=colour, label=words)
    ax.set(xlabel=MU, ylabel=BETA, xlim=(0, 8), ylim=(0, 1))
    ax.legend(frameon=False, fontsize=8)
    return drawing


def pairs_at_an_angle(eps: float = 0.05, angle: float = 1.0) -> tuple[float, float]:
    """Two anti-phase pairs, disturbed: largest |x1 + x3| or |x2 + x4| that is left, largest distance of the pairs."""
    r = r_star(0.8)
    start = {}
    for i, phase in enumerate((0.0, angle, np.pi + 0.05, np.pi + angle - 0.08), 1):
        start |= {f"x{i}": r * np.cos(phase), f"y{i}": -r * np.sin(phase)}
    run = contin.simulate(
        contin.load("metronomes/four"), start, {"beta": 0.8, "mu": 2, "eps": eps}, time=600 / eps, samples=50
    )
    x = [run.columns[f"x{i}"][25:] for i in range(1, 5)]
    apart = max(np.abs(x[0] + x[2]).max(), np.abs(x[1] + x[3]).max())
    return float(apart), float(np.abs(x[0] - x[1]).max())


def survivors() -> dict[str, tuple[float, float, float]]:
    """At beta = 0.8: mu in the average, mu in the equations of motion (eps = 0.01), relative difference."""
    averaged, full = results("pair-diagram.json"), results("pair-unequal-orbits.json")
    places = {
        "in-phase loses its stability": ("in-phase", "BP", "BPC"),
        "small beats are born": ("unequal", "HB", "NS"),
    }
    pairs = {
        words: (points(averaged[name], first, "mu")[0], points(full[name], second, "mu")[0])
        for words, (name, first, second) in places.items()
    }
    return {name: (a, b, (b - a) / a) for name, (a, b) in pairs.items()}


def borders_table() -> MarkdownTable:
    rows = [
        (beta, words, f"{full:.3f}", f"{mean:.3f}")
        for beta in (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8)
        for words, (full, mean) in borders(beta).items()
    ]
    return MarkdownTable("beta | border | simulated mu (+- 0.125) | averaged mu", rows)


def survivors_table() -> MarkdownTable:
    rows = [(words, f"{a:.8f}", f"{b:.8f}", f"{100 * d:.2f} %") for words, (a, b, d) in survivors().items()]
    return MarkdownTable("beta = 0.8 | averaged mu | mu in the equations of motion | difference", rows)


def draw_regions():
    """The picture that the run of `pair-regions` made."""
    from contin.plot.phase import draw

    document = json.loads(Path("pair-regions.json").read_text(encoding="utf-8"))
    return draw(document["phase"], document["branches"])


def beats_in(region: dict) -> str:
    """The stable beats of a region: turning ones nearly stop one metronome, small ones come in mirror pairs."""
    found = []
    for state in region["states"]:
        if state["kind"] == "orbit" and state["stable"]:
            lowest = state["values"]["r1.min"]
            found.append("turning" if lowest < 0.5 else "small" if state["copies"] == 2 else "large")
    return ", ".join(sorted(found)) or "none"


def regions_table() -> MarkdownTable:
    """Stable states of every region at its point; rest and anti-phase synchrony are stable in all of them."""
    rows = []
    for region in json.loads(Path("pair-regions.json").read_text(encoding="utf-8"))["phase"]["regions"]:
        at = region["point"]
        where = f"{at['mu']:.2f}, {at['beta']:.3f}"
        rows.append((region["name"], where, region["stable"], beats_in(region), f"{100 * region['area']:.1f} %"))
    return MarkdownTable("region | mu, beta | stable equilibria | stable beats | part of the box", rows)


def crossing(locus: dict, beta: float) -> float:
    """mu of a curve at this beta, by a polynomial through its five nearest rows."""
    mu, betas = (np.array(locus["columns"][name]) for name in ("mu", "beta"))
    near = np.argsort(np.abs(betas - beta))[:5]
    return float(np.polynomial.Polynomial.fit(betas[near] - beta, mu[near], 4)(0.0))


def check_regions(diagram: dict) -> None:
    """Curves through what the families at beta = 0.8 end in; and which beats live beside them."""
    loci = results("pair-regions.json").values()
    glued, pitchforks = (next(b for b in loci if b["locus"] == kind) for kind in ("HOM", "BP"))
    assert abs(crossing(glued, 0.8) - points(diagram["large beats"], "HOM", "mu")[0]) < 2e-5
    assert abs(crossing(pitchforks, 0.8) - mu_c(0.8)) < 1e-6
    folds = [crossing(b, 0.8) for b in loci if b["locus"] == "LPC" and max(b["columns"]["beta"]) > 0.8]
    assert min(abs(mu - points(diagram["large beats"], "LPC", "mu")[0]) for mu in folds) < 2e-5
    regions_ = json.loads(Path("pair-regions.json").read_text(encoding="utf-8"))["phase"]["regions"]
    assert {beats_in(r) for r in regions_} == {"none", "turning", "large, turning", "small, turning"}


def check() -> None:
    """Closed forms, and the same number by two ways."""
    diagram = results("pair-diagram.json")
    assert abs(points(diagram["in-phase"], "BP", "mu")[0] - mu_c(0.8)) < 1e-9
    small, large = (points(diagram[f"{k} beats"], "HOM", "mu")[0] for k in ("small", "large"))
    assert abs(small - large) < 1e-5  # both families end in one homoclinic butterfly
    check_regions(diagram)
    check_chaos()
    pendulum = results("pair-pendulum.json")["mu_c"]["columns"]
    expected = mu_c(0.8) - 0.75 * np.array(pendulum["sigma"]) * r_star(0.8) ** 2
    np.testing.assert_allclose(pendulum["mu"], expected, atol=1e-6)
    damping = results("pair-unlike-damping.json")["transcritical"]["columns"]
    np.testing.assert_allclose(damping["mu"], np.hypot(mu_c(0.8), 0.8 * np.array(damping["skew"])), rtol=1e-7)
    springs = results("pair-unlike-springs.json")["folds"]
    assert abs(points(springs, "CP", "mu")[0] - mu_c(0.8)) < 1e-6
    three = results("three-clusters.json")
    assert abs(points(three["anti-phase"], "BP", "mu")[0] - 2 / 3 * mu_c(0.8)) < 1e-8
    states = results("three-states.json")
    assert abs(points(states["splay in beta"], "LP", "beta")[0] - FOLD) < 1e-8
    assert all(states["splay"]["columns"]["stable"])
    assert abs(points(states["in-phase"], "BP", "mu")[0] - 2 / 3 * mu_c(0.8)) < 1e-8
    # the same fold twice: by switching at the multiple branch point, and in the subspace of clusters, from the pair
    fold = points(three["anti-phase"], "LP", "mu")[0]
    assert min(abs(mu - fold) for mu in points(states["in-phase/BP1"], "LP", "mu")) < 1e-8
    # beats near in-phase: as relative orbits of three, and in the invariants of two clusters, where no frame is needed
    simulated = states["beats near in-phase"], results("three-beats.json")["beats"]
    for label, value in (("LPC", 2.9571103), ("HOM", 3.30225)):
        assert all(min(abs(mu - value) for mu in points(branch, label, "mu")) < 1e-4 for branch in simulated)
    folds = [points(branch, "LPC", "mu")[0] for branch in simulated]
    assert abs(folds[0] - folds[1]) < 1e-7
    stable = np.array(simulated[0]["columns"]["stable"])
    assert stable.any()
    assert not stable.all()
    four = four_states()
    assert abs(points(four["in-phase"], "BP", "mu")[0] - 2 / 4 * mu_c(0.8)) < 1e-8
    assert {family(name) for name in four} == {"4", "3 + 1", "2 + 2", "2 + 1 + 1", "1 + 1 + 1 + 1"}
    for branches in (states, results("four-states.json")):  # nothing that branches from in-phase synchrony is stable
        born = [b for b in branches.values() if b["parent"] and b["kind"] != "locus"]
        assert born
        assert not any(ever_stable(branch, branches) for branch in born)
    apart, distance = pairs_at_an_angle()
    assert apart < 1e-6 < 0.5 < distance
    assert all(-0.09 < relative < -0.06 for *_, relative in survivors().values())
