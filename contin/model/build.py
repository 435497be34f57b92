"""Plain data in the shape of a model file -> the parts of a `Model`, or one error with everything that is wrong."""

from __future__ import annotations

import gc
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

from contin.errors import InputError
from contin.model import schema
from contin.model.advice import closest
from contin.model.evaluate import evaluate, evaluate_all
from contin.model.expression import Expression, depends_on, postorder
from contin.model.functionals import FunctionalReader
from contin.model.inline import MANY, Formulas
from contin.model.kinds import JUMPING
from contin.model.lexer import canonical_name
from contin.model.naming import check_label, check_names
from contin.model.parts import (
    TIME,
    Averaging,
    Event,
    Expectation,
    Forcing,
    Interval,
    Limit,
    Oscillator,
    Parameter,
    Rotator,
    State,
    Symmetry,
    Total,
)
from contin.model.rotation import check_rotation
from contin.model.shape import check_version, plain, validate
from contin.model.source import Path, Problems, Source
from contin.model.starts import StartReader
from contin.model.symmetry import check_symmetries
from contin.model.values import parameter_values
from contin.records import Record


def parts_from_mapping(
    mapping: Record, source: Source, *, version_required: bool = False, check: bool = True
) -> dict[str, Any]:
    """Fields of a `Model`; `check` compares the symmetries with the equations."""
    problems = Problems(source)
    data = plain(mapping)
    check_version(data, problems, version_required)
    entry = validate(data, problems)
    with without_collection(len(entry.states) > MANY):
        parts = _Builder(entry, problems).parts()
    problems.raise_if_any()
    if check and not parts["mass"] and (parts["symmetries"] or parts["rotation"]):
        check_symmetries(parts, problems)
        if parts["rotation"]:
            check_rotation(parts, problems)
        problems.raise_if_any()
    return parts


@contextmanager
def without_collection(wanted: bool) -> Iterator[None]:
    """Garbage is not looked for while many objects are made that stay: each look would go through all of them."""
    stopped = wanted and gc.isenabled()
    if stopped:
        gc.disable()
    try:
        yield
    finally:
        if stopped:
            gc.enable()


def _time_name(entry: schema.ModelEntry) -> str | None:
    """What equations call the time of a flow, or the independent variable of a boundary-value problem."""
    if entry.kind == "bvp":
        return TIME if entry.time is None else canonical_name(entry.time.name)
    return TIME if entry.kind == "flow" else None


class _Builder:
    def __init__(self, entry: schema.ModelEntry, problems: Problems) -> None:
        self.entry, self.problems = entry, problems
        self.states = [canonical_name(n) for n in entry.states]
        self.parameters = [canonical_name(n) for n in entry.parameters]
        self.time = _time_name(entry)
        symbols = [*self.states, *self.parameters, *([self.time] if self.time is not None else [])]
        observed = {
            canonical_name(n): f"{n} is an observable; put it under definitions to use it in formulas"
            for n in entry.observables
        }
        self.formulas = Formulas(problems, symbols, observed)
        self.formulas.expect_many(self.states)

    def parts(self) -> dict[str, Any]:
        entry = self.entry
        check_names(entry, self.problems)
        self.formulas.declare(entry.functions, entry.definitions)
        time = self.time if entry.kind == "bvp" else None
        reader = StartReader(self.formulas, self.states, self.parameters, self.problems, time)
        self.constants, self.guesses = reader.constants, reader.scope
        numbers = FunctionalReader(self.formulas, self.states, time or TIME, self.problems)
        parts: dict[str, object] = {
            "name": entry.name,
            "kind": entry.kind,
            "title": entry.title,
            "source": entry.source,
            "description": entry.description,
            "states": tuple(self.state(n) for n in entry.states),
            "parameters": tuple(self.parameter(n) for n in entry.parameters),
            "functions": self.formulas.functions,
            "definitions": self.formulas.definitions,
            "equations": self.equations(),
            "observables": {
                canonical_name(n): numbers.number(v, ("observables", n))
                if entry.kind == "bvp"
                else self.formulas.read(v, ("observables", n), self.formulas.scope)
                for n, v in entry.observables.items()
            },
            "labels": self.labels(),
            "symmetries": tuple(self.symmetry(n) for n in entry.symmetries),
            "rotation": self.images(entry.rotation, ("rotation",)),
            "starts": tuple(
                reader.read(n, {**(s.model_extra or {}), "parameters": s.parameters}, ("starts", n))
                for n, s in entry.starts.items()
            ),
            "averaging": self.averaging(),
            "forcing": self.forcing(),
            "limits": self.limits(),
            "events": self.events(),
            "expect": tuple(self.expectation(i) for i in range(len(entry.expect))),
            "mass": self.mass(),
            **self.boundary(numbers),
            **self.conserved(),
        }
        for section in ("starts", "symmetries"):
            for name in getattr(entry, section):
                check_label(name, (section, name), self.problems)
        if not self.problems:
            self.check_numbers(parts)
        return parts

    def state(self, key: str) -> State:
        item, path = self.entry.states[key], ("states", key)
        name = canonical_name(key)
        if not isinstance(item, schema.StateEntry):
            return State(name, self.formulas.read(item, path, self.guesses))
        period, minimum = item.period, item.minimum
        return State(
            name,
            self.formulas.read(item.value, (*path, "value"), self.guesses),
            item.unit,
            item.description,
            None if period is None else self.formulas.read(period, (*path, "period"), self.constants),
            None if minimum is None else self.formulas.read(minimum, (*path, "minimum"), self.constants),
            item.beyond,
            None if item.scale is None else self.formulas.read(item.scale, (*path, "scale"), self.constants),
        )

    def parameter(self, key: str) -> Parameter:
        item, path = self.entry.parameters[key], ("parameters", key)
        name = canonical_name(key)
        if not isinstance(item, schema.ParameterEntry):
            return Parameter(name, self.formulas.read(item, path, self.constants))
        bounds = None
        if item.range is not None:
            low, high = (self.formulas.read(v, (*path, "range", i), self.constants) for i, v in enumerate(item.range))
            bounds = (low, high)
        value = self.formulas.read(item.value, (*path, "value"), self.constants)
        scale = None if item.scale is None else self.formulas.read(item.scale, (*path, "scale"), self.constants)
        return Parameter(name, value, bounds, item.unit, item.description, scale)

    def equations(self) -> tuple[Expression, ...]:
        written = {canonical_name(n): n for n in self.entry.equations}
        known = set(self.states)
        for name, key in written.items():
            if name not in known:
                advice = closest(name, self.states) or f"states are {', '.join(self.states)}"
                self.problems.add(("equations", key), f"{name} is not a state: {advice}", key=True)
        missing = [s for s in self.states if s not in written]
        if missing:
            what = ", ".join(missing)
            self.problems.add(("equations",), f"no equation for {what}; add `{missing[0]}: ...`", key=True)
        scope = self.formulas.scope
        return tuple(
            self.formulas.read(self.entry.equations[written[s]], ("equations", written[s]), scope)
            for s in self.states
            if s in written
        )

    def mass(self) -> dict[str, dict[str, Expression]]:
        """Rows of the mass matrix by the state whose equation they belong to."""
        entry, found = self.entry, {}
        if entry.mass and entry.kind != "flow":
            self.problems.add(("mass",), f"`mass` belongs to kind: flow; this is kind: {entry.kind}", key=True)
        for key in ("averaging", "rotation"):
            if entry.mass and getattr(entry, key):
                self.problems.add((key,), f"a flow with a mass matrix takes no `{key}`", key=True)
        for key, written in entry.mass.items():
            name, path = canonical_name(key), ("mass", key)
            if self.is_state(name, path):
                row = written if isinstance(written, Mapping) else {key: written}
                entries = {
                    canonical_name(k): self.formulas.read(v, (*path, k) if row is written else path, self.constants)
                    for k, v in row.items()
                    if self.is_state(canonical_name(k), (*path, k))
                }
                found[name] = {k: v for k, v in entries.items() if not (v.op == "number" and v.value == 0)}
        return found

    def is_state(self, name: str, path: Path) -> bool:
        if name not in self.states:
            advice = closest(name, self.states) or f"states are {', '.join(self.states)}"
            self.problems.add(path, f"{name} is not a state: {advice}", key=True)
        return name in self.states

    def labels(self) -> dict[str, str]:
        """What tables of simulations call a state or an observable."""
        known = [*self.states, *(canonical_name(n) for n in self.entry.observables)]
        labels: dict[str, str] = {}
        for key, label in self.entry.labels.items():
            self.one_of(key, known, "state or observable", ("labels", key))
            if not label or label in labels.values():
                self.problems.add(("labels", key), f"{label!r} is empty, or the label of another column")
            labels[canonical_name(key)] = label
        return labels

    def symmetry(self, name: str) -> Symmetry:
        return Symmetry(name, self.images(self.entry.symmetries[name], ("symmetries", name)))

    def images(self, written: Record, section: Path) -> dict[str, Expression]:
        """A formula for each of some states."""
        images: dict[str, Expression] = {}
        for key, value in written.items():
            state, path = canonical_name(key), (*section, key)
            if state not in self.states:
                advice = closest(state, self.states) or f"states are {', '.join(self.states)}"
                reason = "a parameter; a symmetry maps states" if state in self.parameters else f"not a state: {advice}"
                self.problems.add(path, f"{state} is {reason}", key=True)
                continue
            images[state] = self.formulas.read(value, path, self.formulas.scope)
        return images

    def limits(self) -> tuple[Limit, ...]:
        def margin(k: int, text: object) -> Expression:
            return self.formulas.read(text, ("limits", k, "margin"), self.formulas.scope)

        return tuple(
            Limit(margin(k, item.margin), item.beyond, item.accuracy) for k, item in enumerate(self.entry.limits)
        )

    def events(self) -> tuple[Event, ...]:
        entry, found = self.entry, []
        if entry.events and (entry.kind != "flow" or entry.mass):
            what = "a flow with a mass matrix" if entry.mass else f"this is kind: {entry.kind}"
            self.problems.add(("events",), f"`events` belongs to kind: flow without `mass`; {what}", key=True)
        moving = [*self.states, TIME]
        for k, item in enumerate(entry.events):
            path: Path = ("events", k)
            when = self.formulas.read(item.when, (*path, "when"), self.formulas.scope)
            if not depends_on(when, moving):
                self.problems.add((*path, "when"), "no state and no t occurs: it never crosses zero; write e.g. v - 30")
            elif any(n.op in JUMPING and depends_on(n, moving) for n in postorder([when])):
                advice = "for events at times n*T write sin(pi*t/T), direction: both"
                self.problems.add((*path, "when"), f"floor, ceil and mod jump over zero; {advice}")
            if not item.set:
                self.problems.add((*path, "set"), "nothing jumps; write e.g. set: {v: c, u: u + d}")
            jumps = {
                canonical_name(name): self.formulas.read(value, (*path, "set", name), self.formulas.scope)
                for name, value in item.set.items()
                if self.is_state(canonical_name(name), (*path, "set", name))
            }
            found.append(Event(when, item.direction, jumps))
        return tuple(found)

    def averaging(self) -> Averaging | None:
        item = self.entry.averaging
        if item is None:
            return None
        self.one_of(item.small, self.parameters, "parameter", ("averaging", "small"))
        roles: list[tuple[Path, str]] = []
        for i, oscillator in enumerate(item.oscillators):
            roles.append((("oscillators", i, "position"), oscillator.position))
            roles.append((("oscillators", i, "velocity"), oscillator.velocity))
        roles += [(("rotators", i, "phase"), rotator.phase) for i, rotator in enumerate(item.rotators)]
        for key, names in (("slow", item.slow), ("slaved", item.slaved)):
            roles += [((key, i), name) for i, name in enumerate(names)]
        self.different_states(roles)
        if self.entry.kind == "map":
            self.problems.add(("averaging",), "a map cannot be averaged; use kind: flow", key=True)
        if "forcing" in item.model_fields_set and self.entry.forcing is None:
            self.problems.add(("averaging", "forcing"), "the model has no forcing; write `forcing: {period: ...}`")
        return Averaging(
            canonical_name(item.small),
            tuple(
                Oscillator(canonical_name(o.position), canonical_name(o.velocity), o.harmonic) for o in item.oscillators
            ),
            item.forcing,
            tuple(Rotator(canonical_name(r.phase), r.harmonic) for r in item.rotators),
            tuple(canonical_name(n) for n in item.slow),
            tuple(canonical_name(n) for n in item.slaved),
        )

    def different_states(self, roles: Sequence[tuple[Path, str]]) -> None:
        """Each of the names, with its place under `averaging`, is a state, and no state has two roles."""
        used: list[str] = []
        for place, state in roles:
            path = ("averaging", *place)
            self.one_of(state, self.states, "state", path)
            if state in used:
                what = "belongs to an oscillator" if place[0] == "oscillators" else "has a role"
                self.problems.add(path, f"{state} already {what}")
            used.append(state)

    def one_of(self, name: str, names: list[str], what: str, path: Path) -> None:
        if canonical_name(name) not in names:
            advice = closest(name, names) or f"there are {', '.join(names) or 'none'}"
            self.problems.add(path, f"{name!r} is not a {what}: {advice}")

    def forcing(self) -> Forcing | None:
        item = self.entry.forcing
        if item is None:
            return None
        if self.entry.kind == "map":
            self.problems.add(("forcing",), "a map has no time; use kind: flow", key=True)
        return Forcing(self.formulas.read(item.period, ("forcing", "period"), self.constants))

    def conserved(self) -> dict[str, Any]:
        """Whether conserved totals are to be looked for, or those that were."""
        written = self.entry.conserved
        if isinstance(written, bool):
            return {"conserved": written}
        totals = []
        for key, item in written.items():
            path: Path = ("conserved", key)
            self.one_of(key, self.parameters, "parameter", path)
            value = self.formulas.read(item.value, (*path, "value"), self.constants)
            state = State(canonical_name(item.state), value, item.unit, item.description)
            law = {
                canonical_name(n): self.formulas.read(c, (*path, "law", n), self.constants) for n, c in item.law.items()
            }
            for name in law:
                self.one_of(name, [*self.states, state.name], "state", (*path, "law", name))
            totals.append(Total(canonical_name(key), law, state, item.note or ""))
        return {"totals": tuple(totals)}

    def boundary(self, numbers: FunctionalReader) -> dict[str, Any]:
        """The interval and the conditions of a boundary-value problem."""
        entry = self.entry
        if entry.kind != "bvp":
            for key, given in (("time", entry.time is not None), ("conditions", bool(entry.conditions))):
                if given:
                    self.problems.add((key,), f"`{key}` belongs to kind: bvp; this is kind: {entry.kind}", key=True)
            return {}
        for key in ("forcing", "averaging", "symmetries", "rotation"):
            if getattr(entry, key):
                self.problems.add((key,), f"a boundary-value problem takes no `{key}`", key=True)
        if self.time in (*self.states, *self.parameters):
            advice = "give the independent variable another name"
            self.problems.add(("time", "name"), f"{self.time} is declared already; {advice}")
        written = entry.time or schema.IntervalEntry()
        ends = [
            self.formulas.read(v, ("time", key), self.constants)
            for key, v in (("from", written.start), ("to", written.end))
        ]
        conditions = tuple(numbers.condition(text, ("conditions", k)) for k, text in enumerate(entry.conditions))
        if not conditions:
            self.problems.add(("conditions",), "a boundary-value problem needs conditions, such as u(start) = 0")
        interval = Interval(str(self.time), ends[0], ends[1])
        return {"interval": interval, "conditions": conditions, "functionals": dict(numbers.found)}

    def expectation(self, i: int) -> Expectation:
        item = self.entry.expect[i]
        points = item.at if isinstance(item.at, list) else [item.at]
        at = []
        for k, point in enumerate(points):
            path: Path = ("expect", i, "at", k) if isinstance(item.at, list) else ("expect", i, "at")
            at.append({n: self.formulas.read(v, (*path, n), self.constants) for n, v in point.items()})
        runs = [] if item.run is None else item.run if isinstance(item.run, list) else [item.run]
        for k, run in enumerate(runs):
            path = ("expect", i, "run", k) if isinstance(item.run, list) else ("expect", i, "run")
            free = run.get("parameter")
            for name in free if isinstance(free, list) else [free] if free is not None else []:
                if not item.transform:  # a pass may add parameters
                    self.one_of(str(name), self.parameters, "parameter", (*path, "parameter"))
        return Expectation(item.label, tuple(at), item.tolerance, tuple(runs), tuple(item.transform or ()))

    def check_numbers(self, parts: Record) -> None:
        """What can be said only in numbers: values are finite, ranges ordered, periods positive."""
        try:
            values = parameter_values(parts["parameters"], [])
        except (InputError, ArithmeticError) as error:
            self.problems.add(("parameters",), str(error), key=True)
            return
        keys = {canonical_name(k): k for k in (*self.entry.parameters, *self.entry.states)}
        for parameter in parts["parameters"]:
            if parameter.range is not None:
                low, high = evaluate_all(parameter.range, values)
                if not low < high or abs(low) == float("inf") or abs(high) == float("inf"):
                    path: Path = ("parameters", keys[parameter.name], "range")
                    self.problems.add(path, f"expected [low, high] with low < high, got [{low:.6g}, {high:.6g}]")
                elif not low <= values[parameter.name] <= high:
                    path = ("parameters", keys[parameter.name], "value")
                    self.problems.warn(
                        path,
                        f"{values[parameter.name]:.6g} is outside its own range [{low:.6g}, {high:.6g}]: runs in "
                        f"{parameter.name} over this range need another start, or `parameters:`",
                    )
        for state in parts["states"]:
            if state.period is not None:
                self.positive(state.period, values, ("states", keys[state.name], "period"))
        for section in ("states", "parameters"):
            for part in parts[section]:
                if part.scale is not None:
                    self.positive(part.scale, values, (section, keys[part.name], "scale"), "a scale")
        if parts["forcing"] is not None:
            self.positive(parts["forcing"].period, values, ("forcing", "period"))

    def positive(self, formula: Expression, values: Mapping[str, float], path: Path, what: str = "a period") -> None:
        value = evaluate(formula, values)
        if not 0 < value < float("inf"):
            self.problems.add(path, f"{what} must be positive and finite, got {value:.6g}")
