"""Small beats of the equations of motion as invariant tori, from the Neimark-Sacker point to their end.

`pair-tori.json` holds what the page draws of the run `metronomes/pair-tori`, which takes a minute:
`contin run metronomes/pair-tori && python docs/metronomes/tori.py pair-tori.json` writes it anew.
"""

import json
import sys
from pathlib import Path

import numpy as np
from drawing import BLUE, GREEN, MU, RED, MarkdownTable, panels, points, results

STORED = Path(__file__).parent / "pair-tori.json"
KEPT = ("mu", "rotation", "period", "x1.max", "x2.max", "unstable")
SIZES = {"average": 0.0, "eps = 0.005": 0.005, "eps = 0.01": 0.01}


def families():
    """Of each eps: mu, time of a beat in slow time, the larger and the smaller swing's greatest amplitude."""
    average, motion = results("pair-small-beats.json")["beats"], results(STORED)
    columns = average["columns"]
    found = {"average": tuple(np.array(columns[key]) for key in ("mu", "period", "r1.max", "r2.max"))}
    for words, name, eps in (("eps = 0.005", "beats 0_005", 0.005), ("eps = 0.01", "beats", 0.01)):
        c = {key: np.array(column) for key, column in motion[name]["columns"].items()}
        found[words] = c["mu"], eps * c["period"] / c["rotation"], c["x1.max"], c["x2.max"]
    return found


def ends():
    """Of each eps: mu at birth, at the end, and swings (returns) in a beat at birth."""
    average, motion = results("pair-small-beats.json"), results(STORED)
    found = {
        "average": (points(average["unequal"], "HB", "mu")[0], average["beats"]["ends"][1]["at"]["mu"], np.nan),
    }
    for words, name in (("eps = 0.005", "beats 0_005"), ("eps = 0.01", "beats")):
        branch = motion[name]
        birth, rotation = branch["columns"]["mu"][0], branch["columns"]["rotation"][0]
        found[words] = birth, branch["ends"][1]["at"]["mu"], 1 / rotation
    return found


def draw():
    """Greatest amplitudes, and the time of a beat, over mu; average and motion."""
    drawing, axes = panels(1, 2, 9.6, 3.3)
    for (words, (mu, beat, large, small)), colour in zip(families().items(), (GREEN, RED, BLUE), strict=True):
        axes[0, 0].plot(mu, large, color=colour, label=words)
        axes[0, 0].plot(mu, small, color=colour, linestyle=(0, (4, 1.5)))
        axes[0, 1].plot(mu, beat, color=colour, label=words)
    axes[0, 0].set(xlabel=MU, ylabel="greatest amplitude in a beat")
    axes[0, 1].set(xlabel=MU, ylabel="slow time of a beat", ylim=(0, 100))
    axes[0, 1].legend(frameon=False, fontsize=8)
    return drawing


def large_end():
    """mu at which the large beats end, from below."""
    return results(STORED)["large beats"]["ends"][1]["at"]["mu"]


def table():
    rows = []
    for words, (birth, end, swings) in ends().items():
        rows.append((words, f"{birth:.6f}", f"{end:.7f}", "" if np.isnan(swings) else f"{swings:.2f}"))
    rows.append(("large beats, eps = 0.01", "", f"{large_end():.7f}", ""))
    return MarkdownTable("| born at mu | homoclinic at mu | swings a beat, at birth", rows)


def trimmed(document: dict) -> dict:
    """The tori of the run: the columns that are drawn, and the ends."""
    tori = [branch for branch in document["branches"] if branch["kind"] == "torus"]
    kept = [
        {"name": b["name"], "columns": {key: b["columns"][key] for key in KEPT},
         "ends": [{key: end[key] for key in ("reason", "at") if key in end} for end in b["ends"]]}
        for b in tori
    ]  # fmt: skip
    return {"branches": kept}


def check():
    """Birth and end lie below those of the average by O(eps), and differ from the linear extrapolation by O(eps^2)."""
    found = ends()
    for k in (0, 1):
        zero, half, one = (found[words][k] for words in SIZES)
        assert 1.7 < (one - zero) / (half - zero) < 2.0
        assert abs(2 * half - one - zero) < 0.1 * abs(one - zero)
    assert abs(found["eps = 0.01"][1] - 4.15629) < 1e-5
    assert abs(found["eps = 0.01"][1] - large_end()) < 1e-6  # gluing: the same value from both sides


if __name__ == "__main__":
    STORED.write_text(json.dumps(trimmed(json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))), indent=1) + "\n")
