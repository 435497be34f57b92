"""The vector field of two states, the others held: its values at many points, its flow forwards and backwards."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Final, Protocol, Union, cast

import numpy as np

from contin.abi import Array
from contin.api.machine_code import compiled
from contin.api.requirements import refuse_forced
from contin.errors import InputError
from contin.model.advice import closest
from contin.model.expression import neg, number, substitute, symbol
from contin.model.kinds import need_model, need_time
from contin.model.model import Model
from contin.records import Record
from contin.systems.functions.function_problem import FunctionProblem
from contin.systems.protocol import System

TwoStates = Union[Model, FunctionProblem]
RATES: Final = ("rate_of_the_first", "rate_of_the_second")
DIFFERENCE: Final = 1e-5  # steps of differences, as a part of the window: their error is about 1e-10 of the field


class Shown(Protocol):
    """What a picture and a report ask of a field."""

    @property
    def names(self) -> tuple[str, str]: ...

    @property
    def name(self) -> str: ...

    @property
    def title(self) -> str: ...

    @property
    def units(self) -> Mapping[str, str]: ...

    @property
    def is_map(self) -> bool: ...

    @property
    def periods(self) -> Array: ...

    @property
    def parameters(self) -> dict[str, float]: ...

    @property
    def held(self) -> Mapping[str, float]: ...

    def motion(self, points: Array) -> Array: ...


@dataclass(frozen=True, eq=False)
class PlanarField:
    """d(x, y)/dt = f(x, y) of a flow, or (x, y) -> f(x, y) of a map; `held`: the values of the other states.

    `planar` is the model of the two states alone, `p` (m,) its parameters, `periods` (2,) those of angles, else 0.
    """

    model: TwoStates
    planar: TwoStates
    p: Array
    held: Mapping[str, float]

    @property
    def names(self) -> tuple[str, str]:
        first, second = self.planar.state_names
        return first, second

    @property
    def name(self) -> str:
        return str(self.model.name)

    @property
    def title(self) -> str:
        return str(getattr(self.model, "title", None) or self.model.name)

    @property
    def units(self) -> dict[str, str]:
        """Of the states that have one."""
        states = getattr(self.planar, "states", ()) or ()
        return {s.name: s.unit for s in states if getattr(s, "unit", None)}

    @property
    def is_map(self) -> bool:
        return bool(self.planar.kind == "map")

    @cached_property
    def periods(self) -> Array:
        return np.asarray(self.planar.periods(self.parameters), dtype=float)

    @property
    def parameters(self) -> dict[str, float]:
        return dict(zip(self.planar.parameter_names, self.p.tolist(), strict=True))

    @cached_property
    def backwards(self) -> TwoStates:
        """The model whose trajectories are those of the flow run backwards in time."""
        model = self.planar
        if isinstance(model, FunctionProblem):
            forwards = model.residual
            return FunctionProblem(
                lambda u, p: -np.asarray(forwards(u, p)), model.u0, model.values, states=model.state_names,
                typical=model.typical, name=model.name,
            )  # fmt: skip
        return model.replace(equations=tuple(neg(e) for e in model.equations), events=(), symmetries=(), rotation={})

    @cached_property
    def _system(self) -> System:
        if isinstance(self.planar, FunctionProblem):
            return cast(System, compiled(self.planar))
        rates = dict(zip(RATES, self.planar.equations, strict=True))
        return cast(System, compiled(self.planar.replace(observables=rates, events=())))

    def values(self, points: Array) -> Array:
        """f at points (K, 2); nan where it is not finite."""
        system = self._system
        with np.errstate(all="ignore"):
            if isinstance(self.planar, FunctionProblem):
                found = np.array([system.value(u, self.p) for u in points]).reshape(len(points), 2)
            else:
                rows = np.tile(self.p, (len(points), 1))
                found = np.asarray(system.observables(np.ascontiguousarray(points), rows)).reshape(len(points), 2)
        return np.where(np.isfinite(found), found, np.nan)

    def motion(self, points: Array) -> Array:
        """The direction field: f of a flow, f - u of a map (an angle the short way round)."""
        found = self.values(points)
        if not self.is_map:
            return found
        moved = found - points
        for k in np.flatnonzero(self.periods):
            moved[:, k] -= self.periods[k] * np.round(moved[:, k] / self.periods[k])
        return np.asarray(moved)

    def trace(self, points: Array, widths: Array) -> Array:
        """The divergence of f at points (K, 2), by central differences in the sizes `widths` (2,)."""
        total = np.zeros(len(points))
        for k in range(2):
            step = np.zeros(2)
            step[k] = DIFFERENCE * widths[k]
            total += (self.values(points + step)[:, k] - self.values(points - step)[:, k]) / (2.0 * step[k])
        return total

    def bend(self, at: Array, direction: Array, widths: Array) -> Array:
        """D^2 f(at)[d, d] by a central difference."""
        h = np.sqrt(DIFFERENCE) / max(float(np.max(np.abs(direction) / widths)), 1e-300)
        ahead, here, behind = self.values(np.array([at + h * direction, at, at - h * direction]))
        return np.asarray((ahead - 2.0 * here + behind) / (h * h))


def planar_field(
    model: TwoStates,
    x: str,
    y: str,
    parameters: Record | None = None,
    at: Record | None = None,
    start: str | Record | None = None,
) -> PlanarField:
    """The field of states x and y; the others are held at their values in the start, or `at`."""
    need_model(model)
    need_time(model, "phase plane")
    refuse_forced(model)
    if not (isinstance(model, (FunctionProblem, Model))) or getattr(model, "mass", None):
        raise InputError(
            f"model {model.name!r}: a phase plane is drawn of ordinary flows and maps, without a mass matrix"
        )
    if getattr(model, "uses_time", False):
        raise InputError(
            f"model {model.name!r} uses the time t: its trajectories cross in the plane (`contin simulate`)"
        )
    names = list(model.state_names)
    if not names and isinstance(model, FunctionProblem):
        raise InputError(
            f"model {model.name!r}: a phase plane is drawn of two states with names, and its {model.n} states have none"
        )
    for name in (x, y, *(at or {})):
        if name not in names:
            raise InputError(f"no state {name!r}: {closest(name, names) or 'there are ' + ', '.join(names)}")
    if x == y:
        raise InputError(f"a phase plane has two different states; got {x} and {y}")
    if at and (x in at or y in at):
        others = [name for name in names if name not in (x, y)]
        raise InputError(f"at: {x if x in at else y} is on an axis; {_others(others)}")
    u, p = model.start_point(start, dict(parameters or {}))
    values = {**dict(zip(names, u.tolist(), strict=True)), **{k: float(v) for k, v in (at or {}).items()}}
    held = {name: values[name] for name in names if name not in (x, y)}
    two = _of_function(model, x, y, values) if isinstance(model, FunctionProblem) else _of_formulas(model, x, y, values)
    return PlanarField(model, two, np.asarray(p, dtype=float), held)


def _others(names: list[str]) -> str:
    return f"states that may be held: {', '.join(names)}" if names else "there is no other state to hold"


def _of_formulas(model: Model, x: str, y: str, values: Mapping[str, float]) -> Model:
    order = [model.state_names.index(name) for name in (x, y)]
    states = tuple(model.states[k] for k in order)
    constants = {symbol(n): number(v) for n, v in values.items() if n not in (x, y)}
    equations = tuple(substitute([model.equations[k] for k in order], constants))
    whole = not constants
    return model.replace(
        states=states, equations=equations, observables={}, rotation={}, averaging=None, expect=(), labels={},
        symmetries=(), starts=(), limits=model.limits if whole else (), events=model.events if whole else (),
        conserved=False, functions={}, definitions={},
    )  # fmt: skip


def _of_function(model: FunctionProblem, x: str, y: str, values: Mapping[str, float]) -> FunctionProblem:
    names, residual = list(model.state_names), model.divided().residual
    order = [names.index(name) for name in (x, y)]
    whole = np.array([values[name] for name in names])

    def field(u: Array, p: Record) -> Array:
        full = whole.astype(np.result_type(whole, np.asarray(u)))
        full[order] = u
        return np.asarray(residual(full, p))[order]

    return FunctionProblem(field, whole[order], model.values, kind=model.kind, states=(x, y), name=model.name)
