"""contin beside AUTO-07p on curves in two parameters, by hand: `python tests/benchmarks/loci.py`.

AUTO's demo ab: the curves of folds and Hopf points through the first such point of the branch. AUTO's demo abc: the
curve of folds of cycles through the first such orbit; the Roessler system: period doublings; both with n = 3, on 50
intervals of 4 points. Both programs go in steps so short that the step control plays no part, with all detection on.
How it is measured: `beside.py`. Closed forms, or published points, are asserted first.
"""

from __future__ import annotations

from collections.abc import Callable
from math import exp
from typing import Any

from beside import Auto, compare
from systems import reactor, roessler, two_reactions

from contin.api import continuation, equilibrium
from contin.continuation.branch import Branch

LINE = {"NDIM": 2, "NMX": 400, "DS": 1e-2, "DSMAX": 5e-2, "RL1": 0.5}
CURVE = {"NDIM": 2, "NMX": 1000, "DS": 1e-3, "DSMAX": 5e-3, "ISW": 2, "ICP": [1, 3]}
ORBITS = {"NDIM": 3, "IPS": 2, "ISP": 2, "THL": {11: 0.0}, "EPSS": 1e-6, "DSMIN": 1e-5}
ORBIT_CURVE = {"NDIM": 3, "IPS": 2, "ILP": 0, "ISP": 0, "ISW": 2, "DS": 0.01, "DSMIN": 1e-5}


def equilibria(title: str, label: str, type_: str, check: Callable[[Branch], None]) -> None:
    """The curve through the first point of a type."""
    point = continuation(equilibrium(reactor()), "p1", (0, 0.5))[label]
    bounds = {"p1": (0, 0.5), "p3": (0, 3)}
    settings = {"steps": 1000, "step": 5e-4, "max_step": 5e-4}

    def work() -> Branch:
        return continuation(point.locus(), ["p1", "p3"], bounds, settings=settings)

    curve = work()
    check(curve)
    auto = Auto.of(reactor())
    if auto is None:
        return compare(title, curve.steps, work, None)
    constants = CURVE | {"IRS": auto.from_point(type_, **LINE)}
    return compare(title, curve.steps, work, lambda: auto.run(**constants))


def on_the_folds(curve: Branch) -> None:
    """u2 = 14 u1 / (1 + p3), p1 = u1 exp(-u2) / (1 - u1), and u1 (1 - u1) = (1 + p3) / 14."""
    u = curve.columns["u1"]
    p3 = 14 * u * (1 - u) - 1
    p1 = [a / (1 - a) * exp(-14 * a / (1 + b)) for a, b in zip(u, p3, strict=True)]
    assert max(abs(p3 - curve.columns["p3"])) < 1e-8
    assert max(abs(p1 - curve.columns["p1"])) < 1e-8


def with_zero_trace(curve: Branch) -> None:
    """-2 - p3 - p1 e + p1 p2 (1 - u1) e = 0, e = exp(u2)."""
    u1, u2, p1, p3 = (curve.columns[k] for k in ("u1", "u2", "p1", "p3"))
    e = [exp(x) for x in u2]
    assert max(abs(-2 - p3 - p1 * e + 14 * p1 * (1 - u1) * e)) < 1e-8


def orbits(
    title: str, label: str, family: Branch, names: tuple[str, str], box: dict[str, tuple[float, float]], step: float,
    auto: Auto | None, restart: dict[str, Any], wanted: dict[str, float],
) -> None:  # fmt: skip
    """The curve of special orbits through a point of a family; `wanted`: values on it, of one parameter."""
    point = family[label]
    settings = {"intervals": 50, "step": step, "max_step": step, "steps": 100}

    def work() -> Branch:
        return continuation(point.locus(names), names, box, direction="up", settings=settings)

    whole = continuation(point.locus(names), names, box, settings={"intervals": 50}, values={names[0]: [*wanted]})
    found = [(p.values[names[0]], p.values[names[1]]) for p in whole.points if p.type == "UZ"]
    for value, there in wanted.items():
        assert min(abs(second - there) for first, second in found if abs(first - value) < 1e-9) < 1e-8
    constants = ORBIT_CURVE | restart | {"NMX": 100, "DSMAX": 0.05}
    compare(title, work().steps, work, auto and (lambda: auto.run(**constants)))


def folds_of_cycles() -> None:
    """The curve turns in a where D = 0.219982798 (AUTO-07p, NTST 100, EPSL 1e-10).

    AUTO starts a curve of folds with a short run of it, whose end has the extended system's unknowns.
    """
    model = two_reactions()
    born = continuation(equilibrium(model), "D", (0, 0.5))["HB1"]
    family = continuation(born.switch(), "D", (0, 0.5), settings={"intervals": 50})
    assert abs(family["LPC1"].values["D"] - 0.213697369218) < 1e-9
    auto = Auto.of(model)
    restart: dict[str, Any] = {}
    if auto is not None:
        label = auto.from_point("HB", NDIM=3, NMX=400, DS=1e-2, DSMAX=5e-2, RL1=0.4)
        label = auto.from_point("LP", **ORBITS, IRS=label, ICP=[1, 11], NMX=60, DS=0.02, DSMAX=0.1)
        label = auto.from_point("EP", True, **ORBIT_CURVE | {"DS": 0.02}, IRS=label, ICP=[1, 2, 11], NMX=5, DSMAX=0.1)
        restart = {"IRS": label, "ICP": [2, 1, 11]}
    box = {"D": (0.0, 0.5), "a": (0.5, 1.5)}
    wanted = {0.219982798: 0.982182587}
    orbits("folds of cycles, n = 3", "LPC1", family, ("D", "a"), box, 0.004, auto, restart, wanted)


def period_doublings() -> None:
    """Points of AUTO-07p on the Roessler system's first curve (NTST 50, EPSL 1e-10)."""
    model = roessler()
    born = continuation(equilibrium(model), "a", (0.05, 0.4))["HB1"]
    family = continuation(born.switch(), "a", (0.05, 0.4), settings={"intervals": 50})
    auto = Auto.of(model)
    restart: dict[str, Any] = {}
    if auto is not None:
        label = auto.from_point("HB", NDIM=3, NMX=100, DS=0.01, DSMAX=0.02, UZSTOP={1: 0.4})
        constants = ORBITS | {"IRS": label, "ICP": [1, 11], "NMX": 150, "DS": 0.01, "DSMAX": 0.2, "UZSTOP": {1: 0.4}}
        label = auto.from_point("PD", **constants)
        label = auto.from_point("EP", True, **ORBIT_CURVE, IRS=label, ICP=[1, 2, 11], NMX=5, DSMAX=0.1)
        restart = {"IRS": label, "ICP": [2, 1, 11]}
    wanted = {5: 0.2634689961, 6: 0.2202132777, 7: 0.1903102199}
    box = {"c": (2.0, 12.0), "a": (0.05, 0.5)}
    orbits("period doublings, n = 3", "PD1", family, ("c", "a"), box, 0.01, auto, restart, wanted)


if __name__ == "__main__":
    equilibria("fold curve, n = 2", "LP1", "LP", on_the_folds)
    equilibria("Hopf curve, n = 2", "HB1", "HB", with_zero_trace)
    folds_of_cycles()
    period_doublings()
