"""A boundary-value problem as a two-point problem in standard form: u' = F(u, p, s) on [0, 1], g(u(0), u(1), p) = 0.

u = (states, free parameters, integrals): a free parameter q obeys q' = 0, an integral I' = L * integrand with I(0) = 0,
and the independent variable t runs from t0 to t1 = t0 + L as t = t0 + L s. So there are as many conditions as unknown
functions, whatever the user's conditions are. (Ascher, Mattheij and Russell 1995, sec. 11.3.)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contin.abi import Address, Array
from contin.errors import InputError
from contin.lowering.calls import Call, Calls, make_call
from contin.lowering.machine import MachineCode, compile_routines
from contin.lowering.routines import Layout, form_routine, jacobian_routine
from contin.lowering.system import CompiledSystem, compile_system
from contin.model.evaluate import node_values
from contin.model.explain import explain_not_finite
from contin.model.expression import ZERO, Expression, call, number, power, substitute, symbol, symbols_in
from contin.model.functionals import condition_count
from contin.model.model import Model
from contin.model.parts import TIME, Forcing, Interval, State
from contin.problems.orbits.forcing_period import ForcingPeriod

INTEGRALS = ("integral", "mean", "norm")


@dataclass(frozen=True, eq=False)
class TwoPoint:
    """The standard form of `model` with the parameters `free` among the unknowns.

    names : of the unknown functions u, (n,): states, free parameters, integrals.  parameters : all that are not free.
    system : F as a forced flow of period 1 in s, compiled; its observables are the functions inside the model's
    functionals.  conditions : g.
    """

    model: Model
    free: tuple[str, ...]
    names: tuple[str, ...]
    parameters: tuple[str, ...]
    system: CompiledSystem
    conditions: Conditions
    inner: tuple[str, ...]  # functionals, in the order of the system's observables

    @property
    def n(self) -> int:
        return len(self.names)

    @property
    def n_states(self) -> int:
        return len(self.model.states)

    @cached_property
    def period(self) -> ForcingPeriod:
        """The interval of s, as the kernels ask for it."""
        return ForcingPeriod.of(self.system)

    @cached_property
    def length(self) -> Expression:
        """t1 - t0."""
        assert self.model.interval is not None
        return self.model.interval.end - self.model.interval.start

    def why_not_finite(self, u: Array, p: Array) -> str:
        """Why the equations have no value at u (n,) and p (m + 1,), in the user's own formulas; empty where they have.

        The last entry of p is the place s in [0, 1].
        """
        interval = _interval(self.model)
        known = dict(zip((*self.names, *self.parameters), (*u.tolist(), *p[:-1].tolist()), strict=True))
        ends = node_values((interval.start, interval.end), known)
        start = ends[interval.start]
        known[interval.name] = start + (ends[interval.end] - start) * float(p[-1])
        written = dict(zip(self.model.state_names, self.model.equations, strict=True))
        text = explain_not_finite(written, known)
        return f"Not finite at this point: {text}" if text else (self.system.why_not_finite(u, p) or "")


def two_point(model: Model, free: Sequence[str]) -> TwoPoint:
    """The standard form; InputError where the conditions are too few or too many for the free parameters."""
    interval = _interval(model)
    if len(model.conditions) - len(model.states) != len(free):
        raise InputError(condition_count(model, free))
    integrals = _integrals(model)
    hidden = [f"{functional}:" for functional in integrals]
    names = (*model.state_names, *free, *hidden)
    length = interval.end - interval.start
    time = {symbol(interval.name): interval.start + length * symbol(TIME)}
    rates = [*model.equations, *[ZERO] * len(free), *integrals.values()]
    equations = [length * rate for rate in substitute(rates, time)]
    inner = {name: f.inner for name, f in model.functionals.items() if f.kind not in ("start", "end")}
    observed = dict(zip(inner, substitute(list(inner.values()), time), strict=True))
    parameters = tuple(p for p in model.parameters if p.name not in free)
    flow = Model.from_parts(
        name=model.name, states=tuple(State(name, number(0)) for name in names), parameters=parameters,
        equations=tuple(equations), observables=observed, forcing=Forcing(number(1)),
    )  # fmt: skip
    known = tuple(p.name for p in parameters)
    conditions = Conditions(names, known, _conditions(model, free, hidden, length))
    return TwoPoint(model, tuple(free), names, known, compile_system(flow), conditions, tuple(inner))


def _interval(model: Model) -> Interval:
    if model.interval is None:
        raise InputError(f"model {model.name!r} is of kind {model.kind!r}, not a boundary-value problem (kind: bvp)")
    return model.interval


def _integrals(model: Model) -> dict[str, Expression]:
    """Integrands of the functionals in conditions, by the functional."""
    used = symbols_in([c.residual for c in model.conditions])
    found = {}
    for name, f in model.functionals.items():
        if name in used and f.kind in INTEGRALS:
            found[name] = power(f.inner, number(2)) if f.kind == "norm" else f.inner
    return found


def _conditions(model: Model, free: Sequence[str], hidden: Sequence[str], length: Expression) -> list[Expression]:
    """g in the symbols NAME(start), NAME(end) of the unknown functions, and parameters."""
    meaning: dict[Expression, Expression] = {symbol(name): symbol(f"{name}(start)") for name in free}
    for name, f in model.functionals.items():
        if f.kind in INTEGRALS:
            total = symbol(f"{name}:(end)")
            meaning[symbol(name)] = {
                "integral": total, "mean": total / length, "norm": call("sqrt", total / length)
            }[f.kind]  # fmt: skip
    written = substitute([c.residual for c in model.conditions], meaning)
    return [*written, *[symbol(f"{name}(start)") for name in hidden]]


class Conditions:
    """g(u(0), u(1), p), compiled: values, first and higher derivatives with respect to (u(0), u(1), p)."""

    def __init__(self, names: Sequence[str], parameters: Sequence[str], residuals: Sequence[Expression]) -> None:
        ends = tuple(f"{name}({end})" for end in ("start", "end") for name in names)
        self.n, self.size = len(names), len(ends)
        self._residuals = [*residuals, *[ZERO] * (self.size - len(residuals))]  # as many as arguments: square calls
        self._layout = Layout(ends, tuple(parameters))
        self._layout.check({f"condition {k + 1}": r for k, r in enumerate(residuals)})
        self._calls = Calls(self.size, len(parameters))
        self._code: dict[int, tuple[MachineCode, Call]] = {}

    def jacobian(self, first: Array, last: Array, p: Array) -> tuple[Array, Array]:
        """g (n,) and its derivatives (n, 2 n + m)."""
        value, matrix = self._calls.jacobian(self._function(1), np.concatenate([first, last]), p)
        return value[: self.n], matrix[: self.n]

    def derivative(self, first: Array, last: Array, p: Array, *directions: NDArray[Any]) -> Array:
        """D^k g along k >= 2 real directions (2 n + m,), (n,)."""
        ends = np.concatenate([first, last])
        return self._calls.form(self._function(len(directions)), ends, p, directions)[: self.n]

    @property
    def jacobian_address(self) -> Address:
        """Of (u(0) and u(1), p, g, G): g (2 n,) and its derivatives (2 n, 2 n + m), zero in their last n rows."""
        self._function(1)
        return self._code[1][0].addresses["conditions"]

    def _function(self, order: int) -> Call:
        """Derivatives of this order: the Jacobian, or a form."""
        if order not in self._code:
            what, layout = self._residuals, self._layout
            routine = (
                jacobian_routine("conditions", what, layout)
                if order == 1
                else form_routine("conditions", what, layout, order)
            )
            code = compile_routines([routine])
            self._code[order] = code, make_call(code.addresses["conditions"], 3 + order)
        return self._code[order][1]
