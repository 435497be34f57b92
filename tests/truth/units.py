"""The same model in other units of its states, of time and of its parameters, and every verb's answer in the old ones.

Old state = unit * new state, old time = unit * new time, old parameter = unit * new parameter; a model that is right in
one of these is right in all of them, so that labels, kinds and ends must be the same, and numbers agree once converted.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from contin.model.expression import Expression, div, mul, number, substitute, symbol
from contin.model.functionals import ENDS
from contin.model.model import Model
from contin.model.parts import TIME, Start


@dataclass(frozen=True)
class Units:
    """Sizes of the new units in the old ones, for all states (alternating with its inverse if `mixed`)."""

    state: float = 1.0
    time: float = 1.0
    parameter: float = 1.0
    mixed: bool = False

    def of_state(self, k: int) -> float:
        return 1.0 / self.state if self.mixed and k % 2 else self.state

    def of_parameter(self, k: int) -> float:
        return self.parameter

    def __str__(self) -> str:
        return f"{'mixed ' if self.mixed else ''}x {self.state:g}, t {self.time:g}, p {self.parameter:g}"


@dataclass(frozen=True)
class Scattered(Units):
    """Each state and each parameter in a unit of its own: exponents from lists, used again from the beginning."""

    states: tuple[float, ...] = ()
    parameters: tuple[float, ...] = ()

    def of_state(self, k: int) -> float:
        return self.states[k % len(self.states)]

    def of_parameter(self, k: int) -> float:
        return self.parameters[k % len(self.parameters)]

    def __str__(self) -> str:
        return f"x {self.states}, t {self.time:g}, p {self.parameters}"


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
    """The model written in other units, M du/dt = f row by row; a map keeps its time, an algebraic system has none."""
    states = {s.name: number(units.of_state(k)) for k, s in enumerate(model.states)}
    parameters = {p.name: number(units.of_parameter(k)) for k, p in enumerate(model.parameters)}
    clock = number(1.0 if model.kind in ("map", "algebraic") else units.time)
    names = {**states, **parameters, model.interval.name if model.interval else TIME: clock}
    old = {symbol(n): mul(unit, symbol(n)) for n, unit in names.items()}
    sums = {
        symbol(n): mul(clock if f.kind == "integral" else states[str(f.inner.value)], symbol(n))
        for n, f in model.functionals.items() if f.kind in ("integral", *ENDS)
    }  # fmt: skip

    def written(formula: Expression, unit: Expression | None = None) -> Expression:
        new = substitute(substitute([formula], old), sums)[0] if sums else substitute([formula], old)[0]
        return new if unit is None else div(new, unit)

    def maybe(formula: Expression | None, unit: Expression) -> Expression | None:
        return None if formula is None else written(formula, unit)

    forcing, interval = model.forcing, model.interval
    mass = {
        row: {n: mul(written(e), div(states[n], states[row])) for n, e in entries.items()}
        for row, entries in model.mass.items()
    }
    return model.replace(
        states=tuple(
            replace(s, value=written(s.value, states[s.name]), scale=maybe(s.scale, states[s.name]))
            for s in model.states
        ),
        parameters=tuple(
            replace(
                p, value=written(p.value, parameters[p.name]), scale=maybe(p.scale, parameters[p.name]),
                range=None if p.range is None else tuple(written(e, parameters[p.name]) for e in p.range),
            )
            for p in model.parameters
        ),
        equations=tuple(
            mul(clock, written(e)) if model.kind == "algebraic" else written(mul(clock, e), states[n])
            for n, e in zip(model.state_names, model.equations, strict=True)
        ),
        observables={n: written(e) for n, e in model.observables.items()},
        symmetries=tuple(
            replace(s, map={n: written(e, states[n]) for n, e in s.map.items()}) for s in model.symmetries
        ),
        forcing=None if forcing is None else replace(forcing, period=written(forcing.period, clock)),
        interval=None if interval is None else replace(
            interval, start=written(interval.start, clock), end=written(interval.end, clock)
        ),
        conditions=tuple(replace(c, residual=written(c.residual)) for c in model.conditions),
        functionals={
            n: f if f.kind in ENDS else replace(f, inner=written(f.inner)) for n, f in model.functionals.items()
        },
        mass=mass,
        events=tuple(
            replace(e, when=written(e.when), jumps={n: written(j, states[n]) for n, j in e.jumps.items()})
            for e in model.events
        ),
        definitions={}, functions={}, expect=(),
        starts=tuple(
            Start(
                s.name, {n: written(e, states[n]) for n, e in s.states.items()},
                {n: written(e, parameters[n]) for n, e in s.parameters.items()},
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
            return self.units.of_parameter(self.old.parameter_names.index(base))
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


IN_FORMULAS = ("surface", "side")  # words with a formula of the model, which is written in its units
SMOOTH = 1e-6  # relative distance of numbers that are one
ROUGH = 2e-3  # ... of a settled state near a fold, where settling is slow


def summary(verbs: Verbs, branch: Any, names: tuple[str, ...]) -> dict[str, Any]:
    """What must not depend on the units: labels with stability and where they are, reasons of the ends."""
    points = []
    for point in branch.points:
        values = verbs.old_values(point.values)
        forms = {k: v for k, v in point.normal_form.items() if isinstance(v, str) and k not in IN_FORMULAS}
        points.append((point.type, {n: values[n] for n in names}, forms))
    runs = _runs(branch.columns.get("unstable", ()))
    return {"points": points, "ends": [end.reason for end in branch.ends], "stable": runs}


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
