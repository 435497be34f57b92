"""`Model`: a system of ordinary differential equations or a map, with everything that is known about it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, dataclass, fields
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contin import lazy
from contin.errors import InputError, NotFiniteError
from contin.model.advice import closest
from contin.model.build import parts_from_mapping
from contin.model.evaluate import evaluate_all
from contin.model.explain import explain_not_finite
from contin.model.expression import Expression, depends_on, number, symbol
from contin.model.model_parts import ModelParts
from contin.model.parser import parse
from contin.model.parts import (
    TIME,
    Start,
    Symmetry,
)
from contin.model.source import CallSource
from contin.model.starts import start_from_mapping
from contin.model.totals import with_totals
from contin.model.values import Override, parameter_values
from contin.model.writer import model_latex, model_text, summary
from contin.records import Json, Record

Array = NDArray[np.float64]


@dataclass(frozen=True, init=False, repr=False)
class Model(ModelParts):
    """A system d(state)/dt = equations(state, parameters) (kind 'flow') or next state = equations (kind 'map').

    Of kind 'algebraic' the equations vanish. Of kind 'bvp' they are d(state)/dt on an interval (`interval`), with
    `conditions` at its ends and on integrals, whose `functionals` are listed by the symbols that stand for them.

    `Model(name=..., states={...}, parameters={...}, equations={...}, ...)` takes the keys and values of a model file,
    as texts, numbers or expressions, checks them alike and gives a model equal to the loaded file. Passes, which hold
    finished parts, use `Model.from_parts` and `replace`.

    `equations` are in the order of `states` and contain states and parameters only, and `t` (of a flow without
    `forcing` for simulations alone): functions and definitions are inserted. `functions` and `definitions` are kept for
    printing. `labels`: what tables of simulations call a state or an observable.

    `mass`: rows of the matrix M in M d(state)/dt = equations, {state: {state: entry}}; rows left out are those of the
    identity. `constraints`, `vanishing`: set by the pass that turns such a flow into one without M
    (`symbolic.passes.index_one`).
    """

    def __init__(self, name: str, **entries: object) -> None:
        parts = parts_from_mapping({"name": name, **entries}, CallSource(f"Model({name!r})"))
        self._set(parts)

    @classmethod
    def build(cls, name: str, **entries: object) -> Model:
        """The same as `Model(name, ...)`."""
        return cls(name, **entries)

    @classmethod
    def from_parts(cls, **parts: object) -> Model:
        """A model of finished parts (the fields of this class); nothing is parsed or checked."""
        model = object.__new__(cls)
        model._set(parts)
        return model

    def replace(self, **parts: Any) -> Model:
        """A copy with some fields exchanged for other finished parts."""
        return Model.from_parts(**{f.name: getattr(self, f.name) for f in fields(self)} | parts)

    def _set(self, parts: Record) -> None:
        known = {f.name for f in fields(self)}
        if not known.issuperset(parts):
            raise TypeError(f"a model has no part {', '.join(sorted(set(parts) - known))}")
        for f in fields(self):
            if f.name in parts:
                value = parts[f.name]
            elif f.default_factory is not MISSING:
                value = f.default_factory()
            elif f.default is not MISSING:
                value = f.default
            else:
                raise TypeError(f"a model needs {f.name}")
            object.__setattr__(self, f.name, value)

    def __hash__(self) -> int:
        return hash((self.name, self.kind, self.states, self.parameters, self.equations))

    def __reduce__(self) -> tuple[Any, ...]:
        return lazy.module("yaml").load_model_text, (self.text(), self.name, False)

    # What it holds ----------------------------------------------------------------------------------------------------

    def symmetry(self, name: str) -> Symmetry:
        """The declared symmetry of this name."""
        found = next((s for s in self.symmetries if s.name == name), None)
        if found is None:
            raise InputError(_no_such("symmetry", name, [s.name for s in self.symmetries], self.name))
        return found

    def start(self, name: str) -> Start:
        """The named start."""
        found = next((s for s in self.starts if s.name == name), None)
        if found is None:
            raise InputError(_no_such("start", name, [s.name for s in self.starts], self.name))
        return found

    def expression(self, text: str) -> Expression:
        """A formula in states, parameters, definitions, functions and observables of this model."""
        names = {n: symbol(n) for n in (*self.state_names, *self.parameter_names)}
        if self.kind == "flow":
            names[TIME] = symbol(TIME)
        return parse(text, {**self.observables, **self.definitions, **names}, self.functions)

    @property
    def uses_time(self) -> bool:
        """True for a flow whose equations or observables contain `t` without `forcing`: for simulations alone."""
        if self.kind != "flow" or self.forcing is not None:
            return False
        jumping = [e for event in self.events for e in (event.when, *event.jumps.values())]
        return any(depends_on(e, [TIME]) for e in (*self.equations, *self.observables.values(), *jumping))

    # Numbers ----------------------------------------------------------------------------------------------------------

    def default_parameters(self, overrides: Mapping[str, Override] | None = None) -> dict[str, float]:
        """Values of all parameters, in order.

        `overrides` (numbers, texts or expressions in the parameters) replace defaults; parameters that are declared as
        expressions in others follow. Raises `InputError` for an unknown name or a circle, `NotFiniteError` if a value
        is not finite.
        """
        return parameter_values(self.parameters, [overrides], self.functions) if overrides else dict(self._defaults)

    @cached_property
    def _defaults(self) -> dict[str, float]:
        return parameter_values(self.parameters, [], self.functions)

    def parameter_range(self, name: str, overrides: Mapping[str, Override] | None = None) -> tuple[float, float] | None:
        """Declared range of a parameter, in numbers."""
        found = next((p for p in self.parameters if p.name == name), None)
        if found is None:
            raise InputError(_no_such("parameter", name, list(self.parameter_names), self.name))
        if found.range is None:
            return None
        low, high = evaluate_all(found.range, self.default_parameters(overrides))
        return low, high

    def start_point(
        self,
        start: str | Record | None = None,
        parameters: Mapping[str, Override] | None = None,
        *,
        finite: bool = True,
    ) -> tuple[Array, Array]:
        """Vectors u (n,) and p (m,) of a starting point.

        `start` is the name of a declared start, or a mapping of states (and `parameters`) to numbers or formulas in the
        parameters; states it does not mention have their default. Parameter values: model < start < `parameters`.
        `finite`: states that are infinite or not a number are refused.
        """
        found = with_totals(self._start(start), self.states, self.totals)
        values = parameter_values(self.parameters, [found.parameters, parameters or {}], self.functions)
        formulas = {s.name: found.states.get(s.name, s.value) for s in self.states}
        if self.interval is not None:  # functions of the independent variable, at its first value
            values = {**values, self.interval.name: float(next(iter(evaluate_all([self.interval.start], values))))}
        u = np.array([float(v) for v in evaluate_all(formulas.values(), values)])
        if finite and not np.all(np.isfinite(u)):
            raise NotFiniteError(f"model {self.name}, start: " + explain_not_finite(formulas, values, "state"))
        return u, np.array([values[name] for name in self.parameter_names], dtype=float)

    def start_functions(
        self, start: object = None, parameters: Mapping[str, Override] | None = None, points: int = 101
    ) -> tuple[dict[str, float], Array, Array]:
        """Parameter values, points t (K,) of the interval, and the states there, (K, n), of a boundary-value problem.

        `start` as of `start_point`; its formulas may contain the independent variable.
        """
        if self.interval is None:
            raise InputError(f"model {self.name!r} has no interval: it is of kind {self.kind!r}")
        found = self._start(start)
        values = parameter_values(self.parameters, [found.parameters, parameters or {}], self.functions)
        first, last = (float(v) for v in evaluate_all([self.interval.start, self.interval.end], values))
        if not (np.isfinite(first) and np.isfinite(last) and first != last):
            raise InputError(f"model {self.name}: its interval runs from {first:g} to {last:g}")
        formulas = [found.states.get(s.name, s.value) for s in self.states]
        times = np.linspace(first, last, points)
        rows = [evaluate_all(formulas, {**values, self.interval.name: float(t)}) for t in times]
        return dict(values), times, np.array(rows, dtype=float)

    def _start(self, start: object) -> Start:
        if start is None:
            return Start("", {})
        if isinstance(start, str):
            return self.start(start)
        if not isinstance(start, Mapping):
            start = self._listed(start)

        return start_from_mapping(self, start)

    def _listed(self, values: Json) -> dict[str, float]:
        """A start given as numbers in the order of the states."""
        names = self.state_names
        try:
            numbers = [float(v) for v in values]
        except (TypeError, ValueError):
            raise InputError(f"a start is a name, a mapping of states or a list of {len(names)} numbers") from None
        if len(numbers) != len(names):
            raise InputError(f"a start has {len(names)} values ({', '.join(names)}); got {len(numbers)}")
        return dict(zip(names, numbers, strict=True))

    def periods(self, overrides: Mapping[str, Override] | None = None) -> Array:
        """Period of each state (n,), 0 where it is not an angle."""
        values = self.default_parameters(overrides)
        return np.array([float(v) for v in evaluate_all([s.period or number(0) for s in self.states], values)])

    def scales(self, overrides: Mapping[str, Override] | None = None) -> Array:
        """Declared natural size of each state (n,), 0 where none is."""
        values = self.default_parameters(overrides)
        return np.array([float(v) for v in evaluate_all([s.scale or number(0) for s in self.states], values)])

    def parameter_scale(self, name: str, overrides: Mapping[str, Override] | None = None) -> float | None:
        """A parameter's declared natural size, or the width of its range; None without both."""
        parameter = next(p for p in self.parameters if p.name == name)
        if parameter.scale is not None:
            return float(evaluate_all([parameter.scale], self.default_parameters(overrides))[0])
        ends = self.parameter_range(name, overrides)
        return None if ends is None else ends[1] - ends[0]

    # Text -------------------------------------------------------------------------------------------------------------

    def text(self) -> str:
        """The model as a model file; loading it gives an equal model."""
        return model_text(self)

    def latex(self) -> str:
        """The equations and definitions as lines of a LaTeX `align*` environment."""
        return model_latex(self)

    def _repr_html_(self) -> str:
        return str(lazy.module("notebook models").model_page(self))

    def __str__(self) -> str:
        return summary(self)

    def __repr__(self) -> str:
        return f"Model({self.name!r}, states={self.state_names}, parameters={self.parameter_names})"


def _no_such(what: str, name: str, known: list[str], model: str) -> str:
    advice = closest(name, known) or (f"there are {', '.join(known)}" if known else f"it declares no {what}")
    return f"model {model} has no {what} {name!r}: {advice}"
