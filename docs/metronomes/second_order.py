"""Averaging to first and second order beside the equations of motion: figure 5c, the plane, the error of each curve."""

import numpy as np
from drawing import BETA, BLACK, BLUE, EPS, GREEN, MU, RED, MarkdownTable, panels, points, results, table

SIZES = (0.0025, 0.005, 0.01, 0.02)
CURVES = (  # words, branch of the motion, its label, column, branch of the average and its label, branch in eps
    ("pitchfork of in-phase synchrony, beta = 0.74", "in-phase", "BPC", "mu", "in-phase", "BP", "mu_c in eps"),
    ("small beats are born, beta = 0.74", "unequal", "NS", "mu", "unequal", "HB", "hopf in eps"),
    ("fold of in-phase synchrony, mu = 8", "fold", "LPC", "beta", None, "LP", "fold in eps"),
    ("fold of anti-phase synchrony, mu = 8", "anti-phase fold", "LPC", "beta", None, "LP", "anti-phase fold in eps"),
)
FOLD = 3 * 4.0**2 / (16 * np.pi)


def draw_5c():
    """Amplitudes against slow time at mu = 5, beta = 0.74."""
    averaged, motion = table("first-order.csv"), table("first-order-motion.csv")
    drawing, axes = panels(1, 2, 9.6, 3.1)
    for ax, columns, slow in ((axes[0, 0], averaged, 1.0), (axes[0, 1], motion, 0.01)):
        t = slow * (columns["t"] - columns["t"][0])
        for k, colour in ((1, BLUE), (2, RED)):
            sizes = columns[f"r{k}"] if slow == 1.0 else np.hypot(columns[f"x{k}"], columns[f"y{k}"])
            ax.plot(t, sizes, color=colour, linewidth=1.2 if slow == 1.0 else 0.2, label=f"metronome {k}")
        ax.set(xlabel=rf"{EPS} t", ylabel="amplitude", ylim=(1.65, 2.35), xlim=(0, 40))
    axes[0, 0].set_title("averaged to first order", fontsize=9)
    axes[0, 1].set_title(f"equations of motion, {EPS} = 0.01", fontsize=9)
    axes[0, 0].legend(frameon=False, fontsize=8, loc="lower center", ncols=2)
    return drawing


def draw_plane():
    """Loci to first and second order at eps = 0.01, and points of the equations of motion."""
    first, second, motion = results("pair-loci.json"), results("pair-second-order.json"), results("pair-orbits.json")
    drawing, axes = panels(1, 1, 7.0, 4.6, " ")
    ax = axes[0, 0]
    pairs = (("mu_c", "mu_c", BLACK), ("hopf", "hopf", RED), ("beta_SN", "in-phase fold", BLUE))
    for one, two, colour in (*pairs, ("beta_SN", "anti-phase fold", GREEN)):
        ax.plot(first[one]["columns"]["mu"], first[one]["columns"]["beta"], ":", color=colour, linewidth=1.3)
        ax.plot(second[two]["columns"]["mu"], second[two]["columns"]["beta"], color=colour, linewidth=1.5)
    for branch in motion.values():
        for type_, colour in (("BPC", BLACK), ("LPC", GREEN if branch["name"] == "anti-phase" else BLUE)):
            for point in branch["points"]:
                if point["type"] == type_:
                    mu, beta = point["values"].get("mu"), point["values"].get("beta")
                    mu = float(branch["name"].split()[-1]) if mu is None and "mu" in branch["name"] else mu
                    beta = float(branch["name"].split()[-1].replace("_", ".")) if beta is None else beta
                    ax.plot([8.0 if mu is None else mu], [beta], "o", color=colour, markersize=4)
    ax.plot([], [], ":", color="0.3", label="first order")
    ax.plot([], [], "-", color="0.3", label="second order")
    ax.plot([], [], "o", color="0.3", markersize=4, label="equations of motion")
    ax.plot([5], [0.74], "*", color=RED, markersize=11, label="figure 5c")
    ax.set(xlabel=MU, ylabel=BETA, xlim=(0, 15), ylim=(0, 1.05))
    ax.legend(frameon=False, fontsize=8, loc="center right")
    return drawing


def errors():
    """Of each curve: the value at eps = 0, differences of the first order, and of the second, from the exact ones."""
    first, second, motion = (
        results("pair-first-order.json"),
        results("pair-second-order.json"),
        results("pair-motion-eps.json"),
    )
    found = {}
    for words, orbit, label, column, state, type_, in_eps in CURVES:
        zero = FOLD if state is None else points(first[state], type_, "mu")[0]
        by_eps = {
            round(p["values"]["eps"], 6): p["values"][column] for p in second[in_eps]["points"] if p["type"] == "UZ"
        }
        names = [f"{orbit} {str(eps).replace('.', '_')}" for eps in SIZES]
        exact = np.array([points(motion[name], label, column)[0] for name in names])
        found[words] = zero, exact - zero, exact - np.array([by_eps[eps] for eps in SIZES])
    return found


def constants(words):
    """C of the first order's error C eps, and D of the second order's D eps^2, both extrapolated to eps = 0."""
    _, one, two = errors()[words]
    eps = np.array(SIZES)
    slopes, curvatures = one / eps, two / eps**2
    return 2 * slopes[0] - slopes[1], 2 * curvatures[0] - curvatures[1]


def errors_table():
    """The curves, their values at eps = 0, and the errors."""
    rows = []
    for words, (zero, one, two) in errors().items():
        c, d = constants(words)
        rows.append((words, f"{zero:.7f}", f"{c:+.4g} eps", f"{d:+.4g} eps^2", f"{one[2]:+.4f}", f"{two[2]:+.5f}"))
    return MarkdownTable("curve | average | first order lacks | second order lacks | first, eps = 0.01 | second", rows)


def check():
    """Figure 5c lies where the orders differ in kind; the second order's errors fall as eps^2."""
    averaged = table("first-order.csv")
    assert abs(averaged["r1"].min() - 1.8446) < 1e-3
    assert abs(averaged["r1"].max() - 2.2369) < 1e-3
    first, second, motion = (
        results("pair-first-order.json"),
        results("pair-second-order.json"),
        results("pair-motion-eps.json"),
    )
    assert points(first["beats"], "HOM", "mu")[0] > 5
    assert points(second["unequal"], "HB", "mu")[0] < 5 < points(second["in-phase"], "BP", "mu")[0]
    assert points(motion["unequal 0_01"], "NS", "mu")[0] < 5 < points(motion["in-phase 0_01"], "BPC", "mu")[0]
    for _, one, two in errors().values():
        assert 1.6 < one[2] / one[1] < 2.4
        assert 3.0 < two[2] / two[1] < 5.0
