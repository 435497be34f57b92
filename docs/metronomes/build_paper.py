"""Builds paper.pdf: carries out the run files, fills their numbers into paper.md, draws the figures, and typesets.

python docs/metronomes/build_paper.py FOLDER    (needs the extra `paper`: pandoc and typst)
"""

import os
import re
import subprocess
import sys
from pathlib import Path

import ledger
import numpy as np
import open_questions
import second_order
import suppression
from claiming import r_star
from drawing import points, results, table

HERE = Path(__file__).resolve().parent
RUNS = (
    "pair-diagram", "pair-beats", "pair-loci", "pair-orbits", "pair-first-order", "pair-second-order",
    "pair-motion-eps", "pair-experiment", "lone-sizes", "lone-motion", "lone-borders", "some-shares",
)  # fmt: skip
DAMPING = 0.8  # beta
WIDTH = 7.0  # inches: two columns of a journal
MASS, PERIOD, RADIUS, EPS = 25.0, 0.6, 8.0, 0.01  # g, s, cm: a small metronome


def at(found: dict, branch: str, label: str, digits: int = 6) -> str:
    """mu at the first point of a type on a branch."""
    return f"{points(found[branch], label, 'mu')[0]:.{digits}g}"


def grams(mu: float | str, digits: int = 3) -> str:
    """The platform's mass at a mu."""
    return f"{float(f'{MASS / (EPS * float(mu)):.{digits}g}'):,.0f}".replace(",", " ")


def numbers() -> dict[str, str]:
    """Every number of the paper, from the results of the run files in this folder."""
    verdicts = ledger.counts()
    found = {
        "statements": str(sum(verdicts.values())),
        "confirmed": str(verdicts["confirmed"]),
        "differs": str(verdicts["differs"]),
        "slips": str(verdicts["slip"]),
        "beta_SN": f"{suppression.FOLD:.5f}",
        "error_rows": "\n".join(error_rows()),
    }
    found |= {f"beta_{count}": f"{suppression.endless_border(count):.5f}" for count in (4, 5, 6, 8)}
    return found | of_the_pair() | of_many() | predictions()


def error_rows() -> list[str]:
    """Table 1."""
    rows = []
    for words, (zero, _, _) in second_order.errors().items():
        one, two = second_order.constants(words)
        rows.append(f"| {words} | {zero:.6f} | ${one:+.3g}\\,\\varepsilon$ | ${two:+.3g}\\,\\varepsilon^2$ |")
    return rows


def of_the_pair() -> dict[str, str]:
    """States of the pair, averaged and in the equations of motion."""
    diagram, experiment = results("pair-diagram.json"), results("pair-experiment.json")
    first, whole = results("pair-first-order.json"), results("pair-motion-eps.json")
    loci, second = results("pair-loci.json")["mu_c"], results("pair-second-order.json")["mu_c"]
    averaged = table("first-order.csv")
    return {
        "mu_c": at(diagram, "in-phase", "BP", 7),
        "hopf": at(diagram, "unequal", "HB"),
        "gluing": at(diagram, "large beats", "HOM"),
        "large_fold": at(diagram, "large beats", "LPC"),
        "turning_fold": at(diagram, "turning beats", "LPC"),
        "bpc_full": at(experiment, "in-phase", "BPC"),
        "ns_full": at(experiment, "unequal", "NS"),
        "low": f"{averaged['r1'].min():.3f}",
        "high": f"{averaged['r1'].max():.3f}",
        "ns_74": at(whole, "unequal 0_01", "NS"),
        "hopf_74": at(first, "unequal", "HB"),
        "exact_05": at(results("pair-orbits.json"), "in-phase beta 0_05", "BPC", 4),
        "first_05": f"{along(loci, 0.05):.4g}",
        "second_05": f"{along(second, 0.05):.4g}",
    }


def of_many() -> dict[str, str]:
    """Where one of N ceases to swing alone."""
    lone, motion = results("lone-sizes.json"), results("lone-motion.json")
    ends = {f"end_{n}": at(lone, f"N = {n}", "BP" if n == 3 else "LP", 5) for n in (2, 3, 4, 5)}
    full = {f"full_{n}": at(motion, f"N = {n}", "BPC" if n == 3 else "LPC", 5) for n in (2, 3, 4)}
    return ends | full | {"shares": f"{suppression.shares_stable()[1]}"}


def predictions() -> dict[str, str]:
    """Table 2: masses of the platform in grams, lengths in centimetres, times in seconds."""
    diagram, experiment = results("pair-diagram.json"), results("pair-experiment.json")
    root = np.sqrt(1 - DAMPING / suppression.FOLD)
    found = {
        "mass": f"{MASS:g}",
        "period": f"{PERIOD:g}",
        "radius": f"{RADIUS:g}",
        "quality": f"{1 / (EPS * DAMPING):.0f}",
        "push": f"{np.sqrt((1 - root) / (1 + root)):.2f}",
        "m_bpc": grams(at(experiment, "in-phase", "BPC")),
        "m_ns": grams(at(experiment, "unequal", "NS")),
        "m_turning": grams(at(diagram, "turning beats", "LPC"), 2),
        "m_alone": grams(at(experiment, "alone", "LPC")),
        "m_quench": grams(at(experiment, "lighter platforms", "LPC")),
        "m_two": grams(2.0),
        "beat": f"{beat(2.0) / EPS * PERIOD / (2 * np.pi):.0f}",
        "always": f"{np.degrees(np.sqrt(8 * EPS * points(diagram['in-phase'], 'BP', 'mu')[0])):.0f}",
    }
    for sigma, degrees in ((0.12, 10), (0.48, 20)):
        angle = np.sqrt(6 * EPS * sigma) * r_star(DAMPING)
        if round(float(np.degrees(angle))) != degrees:
            raise ValueError(f"sigma = {sigma} is not {degrees} degrees")
        found[f"cm_{degrees}"] = f"{RADIUS * np.radians(degrees):.1f}"
        found[f"m_bpc_{degrees}"] = grams(at(experiment, f"in-phase {degrees}", "BPC"))
        found[f"m_ns_{degrees}"] = grams(at(experiment, f"unequal {degrees}", "NS"))
    return found


def beat(mu: float) -> float:
    """The period of the stable turning beats, in slow time."""
    columns = results("pair-beats.json")["turning beats"]["columns"]
    stable = np.array(columns["stable"], dtype=bool)
    at_mu, periods = np.array(columns["mu"])[stable], np.array(columns["period"])[stable]
    order = np.argsort(at_mu)
    return float(np.interp(mu, at_mu[order], periods[order]))


def along(branch: dict, beta: float) -> float:
    """mu of a curve in the plane at a beta, between its rows."""
    order = np.argsort(branch["columns"]["beta"])
    return float(np.interp(beta, np.array(branch["columns"]["beta"])[order], np.array(branch["columns"]["mu"])[order]))


def figures() -> None:
    """The pages' figures at a journal's width."""
    for name, draw, height in (
        ("fig-pair", open_questions.draw_diagram, 3.2), ("fig-5c", second_order.draw_5c, 2.4),
        ("fig-orders", second_order.draw_plane, 3.8), ("fig-sizes", suppression.draw_sizes, 3.0),
        ("fig-borders", suppression.draw_borders, 3.2),
    ):  # fmt: skip
        drawing = draw()
        drawing.set_size_inches(WIDTH, height)
        drawing.savefig(f"{name}.png", dpi=300)


def filled(text: str, values: dict[str, str]) -> str:
    """The text with its numbers; one that is missing is an error, and so is one that nothing names."""
    named = set(re.findall(r"\{\{(\w+)\}\}", text))
    if named != set(values):
        raise ValueError(f"paper.md and its numbers differ: {sorted(named ^ set(values))}")
    return re.sub(r"\{\{(\w+)\}\}", lambda found: values[found[1]], text)


def typeset() -> None:
    """paper.pdf from the filled text: pandoc writes Typst, which sets it."""
    import pypandoc
    import typst

    Path("paper.typ").write_text(
        pypandoc.convert_file("paper.filled.md", "typst", extra_args=["--standalone"]), encoding="utf-8"
    )
    typst.compile("paper.typ", output="paper.pdf")


def main(folder: str) -> None:
    Path(folder).mkdir(parents=True, exist_ok=True)
    os.chdir(folder)
    for name in RUNS:
        if not Path(f"{name}.json").exists():
            done = subprocess.run([sys.executable, "-m", "contin", "run", f"metronomes/{name}"], check=False)
            if done.returncode not in (0, 1):
                raise SystemExit(done.returncode)
    text = filled((HERE / "paper.md").read_text(encoding="utf-8"), numbers())
    Path("paper.filled.md").write_text(text, encoding="utf-8")
    figures()
    typeset()


if __name__ == "__main__":
    main(sys.argv[1])
