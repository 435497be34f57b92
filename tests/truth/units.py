"""The same model in other units of its states, of time and of its parameters, and every verb's answer in the old ones.

Old state = unit * new state, old time = unit * new time, old parameter = unit * new parameter; a model that is right in
one of these is right in all of them, so that labels, kinds and ends must be the same, and numbers agree once converted.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

import contin
from contin.model.expression import Expression, div, mul, number, substitute, symbol
from contin.model.model import Model
from contin.model.parts import Start


@dataclass(frozen=True)
class Units:
    """Sizes of the new units in the old ones, for all states (alternating with its inverse if `mixed`)."""

    state: float = 1.0
    time: float = 1.0
    parameter: float = 1.0
    mixed: bool = False

    def of_state(self, k: int) -> float:
        return 1.0 / self.state if self.mixed and k % 2 else self.state

    def __str__(self) -> str:
        return f"{'mixed ' if self.mixed else ''}x {self.state:g}, t {self.time:g}, p {self.parameter:g}"


ORDINARY = Units()
SHORT = (
    Units(state=1e15), Units(state=1e-9), Units(time=1e12), Units(time=1e-9), Units(parameter=1e12),
    Units(parameter=1e-9), Units(1e15, 1e12, 1e-9), Units(1e-9, 1e-9, 1e12),
)  # fmt: skip
"""States of order 1e-15 and 1e9, times of order 1e-12 and 1e9, parameters alike, and all of it together."""
LONG = (
    *SHORT,
    *(Units(s, t, p) for s in (1e15, 1e6, 1.0, 1e-3, 1e-9) for t in (1e12, 1e-9) for p in (1e12, 1e-9)),
    Units(1e6, mixed=True), Units(1e-6, 1e12, 1e-9, mixed=True), Units(1e4, 1e9, 1e6, mixed=True),
)  # fmt: skip


def in_units(model: Model, units: Units) -> Model:
    """The model written in other units; a map keeps its time."""
    states = {s.name: number(units.of_state(k)) for k, s in enumerate(model.states)}
    parameters = {p.name: number(units.parameter) for p in model.parameters}
    old = {symbol(n): mul(unit, symbol(n)) for n, unit in {**states, **parameters}.items()}

    def written(formula: Expression) -> Expression:
        return substitute([formula], old)[0]

    clock = number(1.0 if model.kind == "map" else units.time)
    return model.replace(
        states=tuple(replace(s, value=div(written(s.value), states[s.name])) for s in model.states),
        parameters=tuple(
            replace(
                p,
                value=div(written(p.value), parameters[p.name]),
                range=None if p.range is None else tuple(div(written(e), parameters[p.name]) for e in p.range),
            )
            for p in model.parameters
        ),
        equations=tuple(
            div(mul(clock, written(e)), states[n]) for n, e in zip(model.state_names, model.equations, strict=True)
        ),
        observables={n: written(e) for n, e in model.observables.items()},
        definitions={}, functions={}, expect=(),
        starts=tuple(
            Start(
                s.name, {n: div(written(e), states[n]) for n, e in s.states.items()},
                {n: div(written(e), parameters[n]) for n, e in s.parameters.items()},
            )
            for s in model.starts
        ),
    )  # fmt: skip


@dataclass(frozen=True)
class Verbs:
    """contin's verbs for a model in other units; arguments and answers are in the old ones."""

    old: Model
    units: Units

    @property
    def model(self) -> Model:
        return in_units(self.old, self.units)

    def unit(self, name: str) -> float:
        """Of a column: a state's, a parameter's, of time; 1 for what else there is."""
        base = name.split(".")[0]
        if base in self.old.state_names:
            return self.units.of_state(self.old.state_names.index(base))
        if base in self.old.parameter_names:
            return self.units.parameter
        return (1.0 if self.old.kind == "map" else self.units.time) if base in ("period", "t") else 1.0

    def new(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """Values, ranges, and mappings of them (`parameters`) by name, in the new units."""
        return {
            n: self.new(v) if isinstance(v, Mapping) else (np.asarray(v) / self.unit(n)).tolist()
            for n, v in values.items()
        }

    def range(self, name: str, ends: tuple[float, float]) -> tuple[float, float]:
        return ends[0] / self.unit(name), ends[1] / self.unit(name)

    def old_values(self, values: Mapping[str, Any]) -> dict[str, float]:
        return {n: float(v) * self.unit(n) for n, v in values.items() if not isinstance(v, bool | np.bool_)}


SMOOTH = 1e-6  # relative distance of numbers that are one
ROUGH = 2e-3  # ... of a settled state near a fold, where settling is slow


def summary(verbs: Verbs, branch: Any, names: tuple[str, ...]) -> dict[str, Any]:
    """What must not depend on the units: labels with stability and where they are, reasons of the ends."""
    points = []
    for point in branch.points:
        values = verbs.old_values(point.values)
        forms = {k: v for k, v in point.normal_form.items() if isinstance(v, str)}
        points.append((point.type, {n: values[n] for n in names}, forms))
    return {"points": points, "ends": [end.reason for end in branch.ends], "stable": _runs(branch.columns["unstable"])}


def _runs(column: Any) -> list[int]:
    counts = np.asarray(column).tolist()
    return [c for k, c in enumerate(counts) if k == 0 or c != counts[k - 1]]


def compare(one: Mapping[str, Any], two: Mapping[str, Any], sizes: Mapping[str, float], rel: float = 1e-6) -> list[str]:
    """How two summaries differ, in words; nothing where they agree."""
    found = [f"{key}: {one[key]} != {two[key]}" for key in one if key != "points" and one[key] != two[key]]
    kinds = [[(t, f) for t, _, f in s["points"]] for s in (one, two)]
    if kinds[0] != kinds[1]:
        return [*found, f"labels: {kinds[0]} != {kinds[1]}"]
    for (label, a, _), (_, b, _) in zip(one["points"], two["points"], strict=True):
        for name, value in a.items():
            if abs(value - b[name]) > rel * (abs(value) + sizes.get(name, 1.0)):
                found.append(f"{label}: {name} = {value!r} != {b[name]!r}")
    return found


Check = Callable[[Verbs], Mapping[str, Any]]
FHN = Model(
    "fitzhugh-nagumo", states={"v": -1.2, "w": -0.6},
    parameters={"I": {"value": 0, "range": [0, 2]}, "e": {"value": 0.08, "range": [0.02, 0.2]}},
    equations={"v": "v - v^3/3 - w + I", "w": "e*(v + 0.7 - 0.8*w)"},
)  # fmt: skip
CUSP = Model(
    "cusp", states={"x": -2}, parameters={"p": {"value": -3, "range": [-3, 3]}, "q": {"value": 3, "range": [-1, 4]}},
    equations={"x": "p + q*x - x^3"},
)  # fmt: skip
PITCHFORK = Model(
    "pitchfork", states={"x": 0, "y": 0}, parameters={"p": {"value": -1, "range": [-1, 1]}},
    equations={"x": "p*x - x^3 + x*y", "y": "-y + 0.3*x^2"}, symmetries={"flip": {"x": "-x"}},
)  # fmt: skip
HENON = Model(
    "henon", kind="map", states={"x": 0.3, "y": 0.1}, parameters={"a": {"value": 0.2, "range": [-0.3, 0.6]}, "b": 0.3},
    equations={"x": "1 - a*x^2 + y", "y": "b*x"},
)  # fmt: skip
DELAYED = Model(
    "delayed-logistic", kind="map", states={"x": 0.3, "y": 0.3}, parameters={"r": {"value": 1.5, "range": [1.1, 2.3]}},
    equations={"x": "r*x*(1 - y)", "y": "x"},
)  # fmt: skip
DOUBLE_ZERO = Model(  # the unfolding of Bogdanov and Takens, with further terms
    "double-zero", states={"x": 1, "y": 0},
    parameters={"a": {"value": -1, "range": [-1, 0.5]}, "b": {"value": -0.5, "range": [-1, 1]}},
    equations={"x": "y", "y": "a + b*y + x^2 + x*y + 0.3*x^3"},
)  # fmt: skip
SADDLE_LOOP = Model(  # x'' = x - x^2 + small damping: the loop of x' = 0 exists at nu near 6/7 mu (here mu = 1)
    "loop", states={"x": 1, "y": 0}, parameters={"nu": {"value": 1.1, "range": [0.5, 1.5]}, "e": 0.2},
    equations={"x": "y", "y": "x - x^2 + e*y*(x - nu)"},
)  # fmt: skip
VDP = Model(
    "van-der-pol", states={"x": 2, "y": 0}, parameters={"m": {"value": 1, "range": [0.2, 3]}},
    equations={"x": "y", "y": "m*(1 - x^2)*y - x"},
)  # fmt: skip


def line(model: Model, start: Any, parameter: str, names: tuple[str, ...], **given: float) -> Check:
    """Equilibria (fixed points) in one parameter over its range, from a start."""

    def check(verbs: Verbs) -> Mapping[str, Any]:
        first = contin.equilibrium(verbs.model, verbs.new(start), verbs.new(given))
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
    "all equilibria": (CUSP.replace(parameters=CUSP.parameters), searched(CUSP, {"x": (-5, 5)})),
    "a phase diagram": (CUSP, phases(CUSP, ("p", "q"))),
}  # fmt: skip
