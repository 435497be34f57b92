"""contin beside AUTO-07p on equilibria, by hand: `python tests/benchmarks/equilibria.py`.

How it is measured: `beside.py`. Every benchmark first asserts its special points to 1e-8.
"""

from __future__ import annotations

from beside import Auto, compare, compare_steps
from systems import pair, reactor

from contin.api import continuation, diagram, equilibrium
from contin.continuation.branch import Branch


def pair_line() -> None:
    """The pair's in-phase line, mu from 10 to 0.5 in steps of 0.001, full detection."""
    model = pair()
    start = equilibrium(model, "in-phase", {"mu": 10})

    def work(finer: int = 1) -> Branch:
        step = 0.001 / 9.5 / finer
        settings = {"step": step, "max_step": step, "steps": 9501 * finer}
        return continuation(start, "mu", (0.5, 10), direction="down", settings=settings)

    found = work()
    assert abs(found["BP1"].values["mu"] - 4.75646174352128) < 1e-8  # -15 pi beta/8 + 27a^2/(64b) + ..., beta = 0.8
    auto = Auto.of(model, "in-phase", {"mu": 10})

    def run(finer: int = 1) -> tuple[float, int]:
        steps = {"NMX": 9500 * finer, "DS": -0.001 / finer, "DSMIN": 1e-5 / finer, "DSMAX": 0.001 / finer}
        return auto.run(NDIM=3, UZSTOP={1: 0.5}, **steps)

    compare("pair, n = 3", found.steps, work, auto and run)
    compare_steps("pair, n = 3", work, auto and run)


def reactor_line() -> None:
    """AUTO's demo ab, thousands of small steps, n = 2, full detection."""
    model = reactor()
    start = equilibrium(model)

    def work(finer: int = 1) -> Branch:
        step = 2.8e-4 / finer  # about as many steps as AUTO takes
        settings = {"step": step, "max_step": step, "steps": 10_000 * finer}
        return continuation(start, "p1", (0, 2), direction="up", settings=settings)

    found = work()
    # folds: u2 = p2 u1/(1 + p3), p1 = u1/(1 - u1) exp(-14 u1/3), dp1/du1 = 0 at u1 (1 - u1) = 3/14
    roots = [(1 - (1 - 12 / 14) ** 0.5) / 2, (1 + (1 - 12 / 14) ** 0.5) / 2]
    folds = [u / (1 - u) * 2.718281828459045 ** (-14 * u / 3) for u in roots]
    got = [p.values["p1"] for p in found.points if p.type == "LP"]
    assert all(min(abs(g - fold) for g in got) < 1e-8 for fold in folds)
    auto = Auto.of(model)

    def run(finer: int = 1) -> tuple[float, int]:
        return auto.run(NDIM=2, NMX=5000 * finer, DS=1e-3 / finer, DSMIN=1e-5 / finer, DSMAX=2e-3 / finer)

    compare("ab, n = 2", found.steps, work, auto and run)
    compare_steps("ab, n = 2", work, auto and run)


def pair_diagram() -> None:
    """The pair's whole diagram of equilibria, explored."""
    model = pair()

    def work() -> object:
        return diagram(model, "mu", (0.05, 8), start=["in-phase", "anti-phase"], orbits=False)

    found = diagram(model, "mu", (0.05, 8), start=["in-phase", "anti-phase"], orbits=False)
    fork = found["in-phase/BP1"]
    wanted = {"HB1": 4.53161898330735564, "LP1": 0.14562601707, "LP2": 0.248773957711}
    assert all(abs(fork[label].values["mu"] - value) < 1e-8 for label, value in wanted.items())
    compare("pair, whole diagram of equilibria", sum(b.steps for b in found), work, None)


if __name__ == "__main__":
    pair_line()
    reactor_line()
    pair_diagram()
