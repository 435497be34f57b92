"""Every verb on a model in other units: what it answers, in the old units, as data that must not depend on them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import contin
from contin.model.model import Model
from tests.truth.unit_models import (
    BAUTIN,
    BRATU,
    CIRCLES,
    CUSP,
    DELAYED,
    DOUBLE_ZERO,
    DRIVEN,
    FHN,
    FREED,
    HALVES,
    HENON,
    HENON_PLANE,
    LOGISTIC,
    NAGUMO,
    PENDULUM,
    PITCHFORK,
    ROTATED,
    SADDLE_LOOP,
    SLIDING,
    TWISTED,
    VDP,
)  # fmt: skip
from tests.truth.units import Verbs, summary

Check = Callable[[Verbs], Mapping[str, Any]]


def line(model: Model, start: Any, parameter: str, names: tuple[str, ...], **given: float) -> Check:
    """Equilibria (fixed points) in one parameter over its range, from a start."""

    def check(verbs: Verbs) -> Mapping[str, Any]:
        place = None if start is None else verbs.new(start)
        first = contin.equilibrium(verbs.model, place, verbs.new(given))
        return summary(verbs, contin.continuation(first, parameter), names)

    return check


def orbits(model: Model, start: Any, parameter: str, label: str, names: tuple[str, ...]) -> Check:
    """The family born at a Hopf point."""

    def check(verbs: Verbs) -> Mapping[str, Any]:
        branch = contin.continuation(contin.equilibrium(verbs.model, verbs.new(start)), parameter)
        family = contin.continuation(branch[label].switch(parameter), parameter)
        return summary(verbs, family, names)

    return check


def simulated(model: Model, parameter: str, names: tuple[str, ...], transient: float = 0.0) -> Check:
    """Orbits from a simulation."""

    def check(verbs: Verbs) -> Mapping[str, Any]:
        orbit = contin.periodic_orbit(verbs.model, transient=transient / verbs.units.time)
        period = orbit.period * verbs.units.time
        family = contin.continuation(orbit, parameter)
        return {**summary(verbs, family, names), "period": round(period, 6)}

    return check


def locus(model: Model, start: Any, parameter: str, label: str, pair: tuple[str, str]) -> Check:
    """The curve of a special point in two parameters."""

    def check(verbs: Verbs) -> Mapping[str, Any]:
        branch = contin.continuation(contin.equilibrium(verbs.model, verbs.new(start)), parameter)
        ranges = {n: verbs.model.parameter_range(n) for n in pair}
        return summary(verbs, contin.continuation(branch[label].locus(pair), pair, ranges), pair)

    return check


def diagrams(model: Model, parameter: str, names: tuple[str, ...], start: Any = None) -> Check:
    """The automatic explorer: every branch."""

    def check(verbs: Verbs) -> Mapping[str, Any]:
        found = contin.diagram(verbs.model, parameter, start=start)
        parts = [(branch.name, summary(verbs, branch, names)) for branch in found.branches]
        points = [point for _, part in parts for point in part["points"]]
        ends = [(name, part["ends"], part["stable"]) for name, part in parts]
        return {"points": points, "ends": ends}

    return check


def swept(model: Model, parameter: str, quantity: str, ends: tuple[float, float], steps: int) -> Check:
    """A hysteresis sweep: outcomes, and the largest value of a quantity."""

    def check(verbs: Verbs) -> Mapping[str, Any]:
        found = contin.sweep(verbs.model, parameter, verbs.range(parameter, ends), steps=steps)
        top = found.columns[f"{quantity}.max"] * verbs.unit(quantity)
        jumps = [(d, round(a * verbs.unit(parameter), 9), round(b * verbs.unit(parameter), 9))
                 for d, a, b in found.jumps(quantity)]  # fmt: skip
        points = [("", {quantity: float(value)}, {}) for value in top]
        return {"points": points, "outcomes": found.outcomes, "jumps": jumps}

    return check


def scanned(model: Model, axis: str, values: tuple[float, ...], measure: str, threshold: float) -> Check:
    """A scan with classes."""

    def check(verbs: Verbs) -> Mapping[str, Any]:
        new = [v / verbs.unit(axis) for v in values]
        large = f"q_max > {threshold / verbs.unit(measure)!r}"
        found = contin.scan(verbs.model, {axis: new}, measures={"q": measure}, classes={"large": large})
        table = found.columns
        points = [("", {measure: float(v) * verbs.unit(measure)}, {}) for v in table["q_max"]]
        return {"points": points, "classes": table["class"], "outcomes": table["outcome"]}

    return check


def flown(model: Model, time: float, start: Any = None, method: str = "DOP853") -> Check:
    """A trajectory's end."""

    def check(verbs: Verbs) -> Mapping[str, Any]:
        clock = 1.0 if model.kind == "map" else verbs.units.time
        found = contin.simulate(
            verbs.model, None if start is None else verbs.new(start), time=time / clock, samples=11, method=method
        )
        last = {n: float(found.columns[n][-1]) * verbs.unit(n) for n in model.state_names}
        return {"points": [("", last, {})], "outcome": found.outcome}

    return check


def searched(model: Model, box: Mapping[str, tuple[float, float]] | None) -> Check:
    """All equilibria in a box."""

    def check(verbs: Verbs) -> Mapping[str, Any]:
        found = contin.find_equilibria(verbs.model, None if box is None else verbs.new(box))
        units = [verbs.unit(n) for n in model.state_names]
        places = sorted(tuple((e.u * units).tolist()) for e in found)
        return {"points": [("", dict(zip(model.state_names, place, strict=True)), {}) for place in places]}

    return check


def phases(model: Model, pair: tuple[str, str]) -> Check:
    """A phase diagram: its curves and regions."""

    def check(verbs: Verbs) -> Mapping[str, Any]:
        found = contin.phase(verbs.model, pair)
        curves = sorted((curve.locus, tuple(p.type for p in curve.points)) for curve in found.loci)
        regions = sorted(region.name for region in found.regions)
        return {"points": [], "curves": curves, "regions": regions}

    return check


def chain(
    model: Model, start: Any, parameter: str, labels: tuple[str, ...], pair: tuple[str, str], names: tuple[str, ...],
    settings: Mapping[str, Any] | None = None,
) -> Check:  # fmt: skip
    """From a start through labels, one branch after another, to the curve of the last one in two parameters."""

    def check(verbs: Verbs) -> Mapping[str, Any]:
        branch = contin.continuation(contin.equilibrium(verbs.model, verbs.new(start)), parameter)
        for label in labels[:-1]:
            branch = contin.continuation(branch[label].switch(parameter), parameter)
        ranges = {n: verbs.model.parameter_range(n) for n in pair}
        curve = contin.continuation(branch[labels[-1]].locus(pair), pair, ranges, settings=settings)
        return summary(verbs, curve, names)

    return check


def family_locus(model: Model, parameter: str, label: str, pair: tuple[str, str], method: str | None = None) -> Check:
    """Orbits from a simulation, and the curve of a special one in two parameters."""

    def check(verbs: Verbs) -> Mapping[str, Any]:
        family = contin.continuation(contin.periodic_orbit(verbs.model, method=method), parameter)
        ranges = {n: verbs.model.parameter_range(n) for n in pair}
        curve = contin.continuation(family[label].locus(pair), pair, ranges)
        parts = summary(verbs, family, (parameter,)), summary(verbs, curve, pair)
        return {"points": [*parts[0]["points"], *parts[1]["points"]], "ends": parts[0]["ends"] + parts[1]["ends"],
                "stable": [parts[0]["stable"], parts[1]["stable"]]}  # fmt: skip

    return check


def connected(model: Model, first: Any, last: Any, pair: tuple[str, str], **given: float) -> Check:
    """A curve of connecting orbits: its ends, and the first parameter's values at them."""

    def check(verbs: Verbs) -> Mapping[str, Any]:
        ends = [verbs.new(one) for one in (first, last) if one is not None]
        start = contin.connecting_orbit(verbs.model, *ends, parameters=verbs.new(given))
        ranges = {n: verbs.model.parameter_range(n) for n in pair}
        curve = contin.continuation(start, pair, ranges)
        places = [("", {n: float(curve.columns[n][k]) * verbs.unit(n) for n in pair}, {}) for k in (0, -1)]
        return {"points": places, "ends": [end.reason for end in curve.ends], "labels": [p.type for p in curve.points]}

    return check


def bounded(
    model: Model, parameter: str, names: tuple[str, ...], free: tuple[str, ...] = (), extrema: Any = ()
) -> Check:
    """A boundary-value problem."""

    def check(verbs: Verbs) -> Mapping[str, Any]:
        start = contin.boundary_problem(verbs.model, free=free)
        ranges = verbs.model.parameter_range(parameter)
        return summary(verbs, contin.continuation(start, parameter, ranges, extrema=extrema), names)

    return check


def cycles(model: Model, parameter: str, label: str, names: tuple[str, ...]) -> Check:
    """Cycles of a map, from a doubling."""

    def check(verbs: Verbs) -> Mapping[str, Any]:
        branch = contin.continuation(contin.equilibrium(verbs.model), parameter)
        return summary(verbs, contin.continuation(branch[label].switch(parameter), parameter), names)

    return check


def responses(model: Model, parameter: str, names: tuple[str, ...]) -> Check:
    """The diagram of a forced flow: its periodic responses."""
    return diagrams(model, parameter, names)


CHECKS: dict[str, tuple[Model, Check]] = {
    "equilibria with Hopf points": (FHN, line(FHN, {"v": -1.2, "w": -0.6}, "I", ("I", "v", "w"))),
    "folds": (CUSP, line(CUSP, {"x": -2}, "p", ("p", "x"))),
    "a pitchfork of rest": (PITCHFORK, line(PITCHFORK, {"x": 0, "y": 0}, "p", ("p",))),
    "orbits from a Hopf point": (FHN, orbits(FHN, {"v": -1.2, "w": -0.6}, "I", "HB1", ("I", "period"))),
    "orbits from a simulation": (VDP, simulated(VDP, "m", ("m",))),
    "a curve of folds with its cusp": (CUSP, locus(CUSP, {"x": -2}, "p", "LP1", ("p", "q"))),
    "a curve of Hopf points": (FHN, locus(FHN, {"v": -1.2, "w": -0.6}, "I", "HB1", ("I", "e"))),
    "folds to a double zero": (DOUBLE_ZERO, locus(DOUBLE_ZERO, {"x": 0.9, "y": 0}, "a", "LP1", ("a", "b"))),
    "a map's flip and fold": (HENON, line(HENON, {"x": 0.8, "y": 0.25}, "a", ("a", "x"))),
    "a map's torus": (DELAYED, line(DELAYED, {"x": 0.3, "y": 0.3}, "r", ("r", "x"))),
    "a homoclinic end": (SADDLE_LOOP, orbits(SADDLE_LOOP, {"x": 1, "y": 0}, "nu", "HB1", ("nu",))),
    "a diagram": (PITCHFORK, diagrams(PITCHFORK, "p", ("p",))),
    "a diagram with orbits": (FHN, diagrams(FHN, "I", ("I",))),
    "a sweep": (CUSP, swept(CUSP, "p", "x", (-3.05, 3.05), 12)),
    "a sweep from rest": (PITCHFORK, swept(PITCHFORK, "p", "x", (-1.0, 1.0), 4)),
    "a sweep of a map": (HENON, swept(HENON, "a", "x", (0.1, 0.5), 4)),
    "a scan": (CUSP, scanned(CUSP, "p", (-3.0, -1.0, 1.0, 3.0), "x", 0.0)),
    "a trajectory": (VDP, flown(VDP, 20.0)),
    "a stiff trajectory": (VDP, flown(VDP, 20.0, method="LSODA")),
    "iterates": (HENON, flown(HENON, 30.0)),
    "all equilibria": (CUSP, searched(CUSP, {"x": (-5, 5)})),
    "a phase diagram": (CUSP, phases(CUSP, ("p", "q"))),
    "an algebraic system": (CIRCLES, line(CIRCLES, {"x": -0.9, "y": 0.1}, "p", ("p", "x", "y"))),
    "a boundary-value problem": (BRATU, bounded(BRATU, "lam", ("lam",))),
    "an integral condition": (FREED, bounded(FREED, "lam", ("lam", "s"), ("s",), ("s",))),
    "fronts": (NAGUMO, connected(NAGUMO, {"u": 1}, {"u": 0}, ("c", "a"))),
    "loops": (NAGUMO, connected(NAGUMO, {"u": 0}, None, ("c", "a"), c=0.001)),
    "a curve of folds of orbits": (
        BAUTIN, chain(BAUTIN, {"x": 0, "y": 0}, "a", ("HB1", "LPC1"), ("a", "b"), ("a", "b"))
    ),
    "a curve of doublings of orbits": (TWISTED, family_locus(TWISTED, "p", "PD1", ("p", "q"))),
    "folds of orbits by shooting": (HALVES, family_locus(HALVES, "be", "LPC1", ("al", "be"))),
    "a curve of flips": (HENON_PLANE, chain(HENON_PLANE, {"x": 0.8, "y": 0.25}, "a", ("PD1",), ("a", "b"), ("a", "b"))),
    "cycles of a map": (LOGISTIC, cycles(LOGISTIC, "r", "PD1", ("r",))),
    "a vertical family": (PENDULUM, diagrams(PENDULUM, "d", ("d",))),
    "a forced oscillator": (DRIVEN, responses(DRIVEN, "w", ("w",))),
    "a surface": (SLIDING, diagrams(SLIDING, "p", ("p",))),
    "two symmetries": (ROTATED, diagrams(ROTATED, "p", ("p",))),
    "a phase diagram with orbits": (BAUTIN, phases(BAUTIN, ("a", "b"))),
    "a phase diagram with loops": (DOUBLE_ZERO, phases(DOUBLE_ZERO, ("a", "b"))),
    "a phase diagram of a map": (HENON_PLANE, phases(HENON_PLANE, ("a", "b"))),
    "a phase diagram with a symmetry": (ROTATED, phases(ROTATED, ("p", "k"))),
}  # fmt: skip
LONG_ONES = ("loops", "fronts", "a phase diagram of a map", "tori of a forced flow", "a surface of a manifold")
SLOW = frozenset((*LONG_ONES, *(name for name in CHECKS if name.startswith("a phase diagram with"))))
