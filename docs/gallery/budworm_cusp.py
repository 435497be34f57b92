"""Two folds that meet in a cusp: the spruce budworm."""

from matplotlib.figure import Figure

import contin
from contin.plot.picture import picture

MODEL = {
    "name": "budworm",
    "states": {"x": 0.5},
    "parameters": {"r": 0.3, "k": 10},
    "equations": {"x": "r*x*(1 - x/k) - x^2/(1 + x^2)"},
}


def compute():
    """The equilibria in r, and the curve of their folds in (r, k)."""
    model = contin.load(MODEL)
    line = contin.continuation(contin.equilibrium(model), "r", (0.1, 0.8), name="line")
    folds = contin.continuation(line["LP1"].locus(), ("r", "k"), {"r": (0.05, 0.9), "k": (4, 14)}, name="folds")
    return line, folds


def cusp(folds) -> float:
    """k at the cusp; 3 sqrt(3) in closed form."""
    return next(p for p in folds.points if p.type == "CP").values["k"]


def draw() -> Figure:
    line, folds = compute()
    figure = picture(8, 3.2, dpi=100.0)
    left, right = figure.subplots(1, 2)
    stable = line.columns["stable"]
    for wanted, style in ((True, "-"), (False, "--")):
        x = line.columns["x"].copy()
        x[stable != wanted] = float("nan")
        left.plot(line.columns["r"], x, style, color="C0", label="stable" if wanted else "unstable")
    left.set(xlabel="growth rate r", ylabel="budworm x")
    left.legend(frameon=False)
    right.plot(folds.columns["r"], folds.columns["k"], color="C3")
    point = next(p for p in folds.points if p.type == "CP")
    right.plot(point.values["r"], point.values["k"], "ko")
    right.annotate(
        "cusp", (point.values["r"], point.values["k"]), xytext=(-8, -4), textcoords="offset points", ha="right"
    )
    right.set(xlabel="growth rate r", ylabel="capacity k")
    return figure
