"""Suppression: closed forms for metronomes that swing while others rest, and figures from results of the run files."""

import numpy as np
from claiming import A, B, r_star
from drawing import BETA, BLACK, BLUE, GREEN, MU, ORANGE, PINK, RED, SKY, MarkdownTable, curve, panels, points, results

FOLD = 3 * A**2 / (16 * np.pi * B)
COLOURS = {2: BLACK, 3: BLUE, 4: RED, 5: GREEN, 6: PINK, 7: SKY, 8: ORANGE}


def endless_border(count):
    """The damping below which one of `count` metronomes swings for every mu (the limit of the fold as mu grows).

    The platform's motion vanishes in the limit, so that w = -z/(N - 1); the real parts of z F(|z|^2) = w F(|w|^2) are a
    quadratic equation in |z|^2, whose discriminant vanishes here.
    """
    ratio = 1.0 / (count - 1)
    return FOLD * (1 + ratio**3) ** 2 / ((1 + ratio) * (1 + ratio**5))


def pair_and_rest(beta, mu, rest):
    """Coefficients of the characteristic polynomial of (r*, -r*, 0, .., 0), `rest` metronomes at rest, highest first.

    The other eigenvalues are -beta/2 +- i Omega, `rest` - 1 times.
    """
    big = r_star(beta) ** 2
    c, d = (4 * B * big - 3 * A) * big / (6 * np.pi), big * (5 * B * big / 8 - 3 * A / 8)
    turn, m = big * (5 * B * big / 32 - 3 * A / 16), mu / 2
    e = beta**2 / 4 + turn**2
    return [
        1.0,
        c + beta,
        e + c * beta + 2 * m * (d - rest * turn) + m**2 * (2 + rest) ** 2,
        c * e + 2 * m * (d * beta - rest * turn * c) + m**2 * (4 * beta + rest**2 * c + 2 * rest * (c + beta)),
        2 * m * d * e + m**2 * (4 * e + rest * beta * c - 2 * d * rest * turn),
    ]


def growth(beta, mu, rest):
    """The largest real part of the eigenvalues of (r*, -r*, 0, .., 0)."""
    return float(max(np.roots(pair_and_rest(beta, mu, rest)).real))


def steady_border(beta, rest):
    """The mu above which a real eigenvalue is positive: where the last coefficient vanishes, or infinite."""
    one, two = pair_and_rest(beta, 2.0, rest)[-1], pair_and_rest(beta, 4.0, rest)[-1]
    linear, square = (4 * one - two) / 2, (two - 2 * one) / 2  # of m = mu/2
    return np.inf if square >= 0 else -2 * linear / square


def draw_sizes():
    """Amplitudes of the lone metronome and of the others."""
    found = results("lone-sizes.json")
    drawing, axes = panels(1, 2, 9.6, 3.7)
    for count, colour in COLOURS.items():
        for ax, column in zip(axes[0], ("r1", "r2"), strict=True):
            branch = found[f"N = {count}"]
            last = leaving(branch)
            branch = branch | {"columns": {k: v[:last] for k, v in branch["columns"].items()}}
            curve(ax, branch, "mu", column, colour)
        axes[0, 0].plot([], [], color=colour, label=f"N = {count}")
    axes[0, 0].set(xlabel=MU, ylabel="amplitude of the one that swings", xlim=(0, 8), ylim=(1.5, 2.15))
    axes[0, 1].set(xlabel=MU, ylabel="amplitude of the others", xlim=(0, 8), ylim=(0, 0.75))
    drawing.legend(loc="outside lower center", ncols=7, frameon=False, fontsize=8)
    return drawing


def leaving(branch):
    """Rows of a branch up to where the state, past its first fold, is not this one any more (half way back)."""
    mu = np.array(branch["columns"]["mu"])
    top = int(np.argmax(mu[:100]))
    back = np.flatnonzero(mu[top:] < 0.6 * mu[top])
    return len(mu) if len(back) == 0 or mu[top] > 14 else top + int(back[0])


def draw_borders():
    """Borders of the lone metronome's stability in the plane, and of the resting ones beside an anti-phase pair."""
    found = results("lone-borders.json")
    drawing, axes = panels(1, 2, 9.6, 4.2)
    left, right = axes[0]
    for count in (3, 4, 5, 6, 8):
        kinds = (
            (f"fold of {count}", "-"),
            (f"Hopf of {count}", "--"),
            (f"lower Hopf of {count}", "--"),
            (f"others of {count} part", "-."),
        )
        for name, dashes in kinds:
            if name in found:
                columns = found[name]["columns"]
                alone = np.array(columns["stable"], dtype=bool)  # no further eigenvalue
                border = np.where(alone, columns["beta"], np.nan)
                left.plot(columns["mu"], border, color=COLOURS[count], linestyle=dashes, linewidth=1.7)
        left.plot([], [], color=COLOURS[count], label=f"N = {count}")
        if count > 3:
            left.axhline(endless_border(count), color=COLOURS[count], linewidth=0.6, alpha=0.6, xmin=0.72)
    left.set(xlabel=MU, ylabel=BETA, xscale="log", xlim=(0.01, 15), ylim=(0.02, 1.0))
    damping, ratios = np.linspace(0.003, 0.62, 110), np.geomspace(0.01, 100, 110)
    for rest, colour in ((1, BLUE), (2, RED), (4, PINK), (6, ORANGE)):
        rates = [[growth(b, mu, rest) for mu in ratios] for b in damping]
        right.contour(ratios, damping, rates, [1e-9], colors=[colour], linewidths=1.5)
        right.plot([], [], color=colour, label=f"{rest} at rest")
    right.set(xlabel=MU, xscale="log", xlim=(0.01, 100), ylim=(0.02, 1.0))
    right.axhline(FOLD, color=BLACK, linewidth=1.0)
    drawing.legend(loc="outside lower center", ncols=9, frameon=False, fontsize=7, columnspacing=1.2, handlelength=1.4)
    return drawing


def ends_table():
    """Where one metronome ceases to swing alone: averaged, and in the equations of motion."""
    averaged, motion = results("lone-sizes.json"), results("lone-motion.json")
    rows = []
    for count in (2, 3, 4, 5, 6, 8):
        end = last_stable(averaged[f"N = {count}"], "BP" if count == 3 else "LP")
        full = "not run" if count > 5 else last_stable(motion[f"N = {count}"], "BPC" if count == 3 else "LPC")
        rows.append((count, end, full, f"{endless_border(count):.6f}" if count > 2 else ""))
    return MarkdownTable(
        "N | averaged: stable up to mu = | equations of motion, eps = 0.01 | for every mu where beta <", rows
    )


def last_stable(branch, type_):
    """The first of the points at which the state ends, or the end of the run."""
    found = points(branch, type_, "mu")
    return f"{found[0]:.7g}" if found else f"beyond {max(branch['columns']['mu']):.3g}"


def shares_stable():
    """Rows of all families of k > 1 that swing as one which are stable, other than in-phase synchrony; and all rows."""
    stable = rows = 0
    for name, branch in results("some-shares.json").items():
        columns = branch["columns"]
        if name != "shares":
            apart = np.abs(np.array(columns["u1"]) - np.array(columns["u2"])) > 1e-6
            stable += int(np.sum(np.array(columns["stable"], dtype=bool) & apart))
            rows += int(np.sum(apart))
    return stable, rows


def check():
    """What the page says in words."""
    averaged, motion = results("lone-sizes.json"), results("lone-motion.json")
    for name, type_, value in (("N = 2", "LP", 0.24877396), ("N = 3", "BP", 0.52444459), ("N = 4", "LP", 1.9096757)):
        assert abs(points(averaged[name], type_, "mu")[0] - value) < 1e-7
    assert not points(averaged["N = 6"], "LP", "mu")
    assert abs(points(motion["N = 4"], "LPC", "mu")[0] - 2.55058) < 1e-4
    assert shares_stable()[0] == 0
