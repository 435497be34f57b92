"""Period doublings of the logistic map, and the ratio of their distances."""

from matplotlib.figure import Figure

import contin
from contin.plot.picture import picture

LEVELS = 5


def compute() -> list:
    """Branches of the cycles of period 1, 2, 4, ..., each from the period doubling of the one before."""
    model = contin.load("classics/logistic")
    branches = [contin.continuation(contin.equilibrium(model, "population"), "r", (1.5, 4), name="1")]
    for level in range(1, LEVELS + 1):
        start = branches[-1]["PD1"].switch()
        branches.append(contin.continuation(start, "r", (1.5, 4), name=str(2**level)))
    return branches


def ratio(branches) -> float:
    """(r_3 - r_2)/(r_4 - r_3) of successive doublings; 4.6692... in the limit (Feigenbaum 1978)."""
    r = [branch["PD1"].values["r"] for branch in branches[:-1]]
    return (r[3] - r[2]) / (r[4] - r[3])


def draw() -> Figure:
    branches = compute()
    figure = picture(8, 3.6, dpi=100.0)
    axes = figure.subplots()
    for level, branch in enumerate(branches):
        r, x = branch.columns["r"], branch.columns["x"]
        for point in range(2**level):
            name = f"period {2**level}" if point == 0 else None
            axes.plot(r, x, "-", color=f"C{level}", lw=1, label=name)
            x = r * x * (1 - x)
    axes.set(xlim=(2.8, 3.7), ylim=(0.3, 0.97), xlabel="r", ylabel="points of the cycle x")
    axes.legend(frameon=False, ncols=2)
    return figure
