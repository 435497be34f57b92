"""Numbers made of fields, in observables: integral(u^2), mean(u), norm(u), max(u), min(u), and values u(0.5)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from contin.abi import Array
from contin.errors import ExpressionError
from contin.model.evaluate import evaluate
from contin.model.expression import Expression, number, symbol, symbols_in
from contin.model.inline import Formulas
from contin.model.printing import to_text
from contin.model.scope import Calls, Scope
from contin.model.source import Path
from contin.pde.arrays import ArrayFormulas
from contin.pde.equations import Discretised
from contin.pde.grid import Grid
from contin.pde.local_formula import LocalFormula, Values
from contin.pde.slots import Slots

Kind = Literal["integral", "mean", "norm", "max", "min", "at"]
KINDS: Final[tuple[Kind, ...]] = ("integral", "mean", "norm", "max", "min")


@dataclass(frozen=True)
class Measure:
    """One number of a formula: a kind, or its value `at` a point."""

    kind: Kind
    formula: Expression
    at: tuple[float, ...] = ()


class MeasureReader:
    """Reads observables; `found` says what the symbols in them stand for."""

    def __init__(self, formulas: Formulas, slots: Slots, grid: Grid) -> None:
        self.formulas, self.slots, self.grid = formulas, slots, grid
        self.found: dict[str, Measure] = {}
        scope = formulas.scope
        calls: dict[str, Calls] = dict(scope.calls)
        calls.update({kind: self._measure(kind) for kind in KINDS})
        calls.update({field: self._value(field) for field in slots.fields})
        self._scope = Scope(scope.names, scope.functions, scope.conditions, scope.unavailable, scope.budget, calls)

    def read(self, value: object, path: Path) -> Expression:
        """A formula that is one number."""
        formula = self.formulas.read(value, path, self._scope)
        varying = {*self.grid.coordinates, *self.slots.used([formula])}
        loose = next((name for name in symbols_in([formula]) if name in varying), None)
        if loose is not None:
            field = self.slots.fields[0]
            point = ", ".join(f"{axis.low:g}" for axis in self.grid.axes)
            self.formulas.problems.add(
                path,
                f"{loose} has a value everywhere: write integral({loose}), mean({loose}), norm({loose}), max({loose}), "
                f"min({loose}), or the value of a field at a point, {field}({point})",
            )
            return number(0)
        return formula

    def _measure(self, kind: Kind) -> Calls:
        def read(arguments: Sequence[Expression], position: int) -> Expression | None:
            if len(arguments) != 1:
                if kind in ("max", "min"):
                    return None
                raise ExpressionError(f"{kind} takes 1 argument, got {len(arguments)}", position)
            if any(name in self.found for name in symbols_in(arguments)):
                raise ExpressionError(f"a number cannot stand inside {kind}(...)", position)
            return self._known(f"{kind}({to_text(arguments[0])})", Measure(kind, arguments[0]))

        return read

    def _value(self, field: str) -> Calls:
        def read(arguments: Sequence[Expression], position: int) -> Expression:
            axes = self.grid.axes
            names = ", ".join(axis.name for axis in axes)
            if len(arguments) != len(axes) or any(symbols_in([a]) for a in arguments):
                what = f"write {field}({names}) with numbers for {names}: the value at a point"
                raise ExpressionError(what, position)
            at = tuple(float(evaluate(a, {})) for a in arguments)
            for axis, x in zip(axes, at, strict=True):
                if not axis.low <= x <= axis.high:
                    what = f"{axis.name} = {x:g} lies outside the domain [{axis.low:g}, {axis.high:g}]"
                    raise ExpressionError(what, position)
            shown = ", ".join(to_text(a) for a in arguments)
            return self._known(f"{field}({shown})", Measure("at", symbol(field), at))

        return read

    def _known(self, name: str, measure: Measure) -> Expression:
        self.found[name] = measure
        return symbol(name)


class Observer:
    """Columns of branches: of every field its norm sqrt(mean(u^2)), smallest and largest value; and the observables."""

    def __init__(
        self, system: Discretised, observables: Mapping[str, Expression], measures: Mapping[str, Measure]
    ) -> None:
        self.system, self.names = system, list(observables)
        used = set(symbols_in(list(observables.values())))
        self._measures = {name: (m, system.everywhere(m.formula)) for name, m in measures.items() if name in used}
        self._weights = {m.at: system.grid.interpolation(m.at) for m, _ in self._measures.values() if m.at}
        self._formulas = ArrayFormulas(list(observables.values()))

    def __call__(self, u: Array, p: Values) -> dict[str, float]:
        """{column: value}"""
        columns: dict[str, float] = {}
        weights, size = self.system.grid.weights, self.system.grid.weights.sum()
        for field, values in self.system.fields(u, p).items():
            columns[f"{field}.norm"] = float(np.sqrt(weights @ values**2 / size))
            columns[f"{field}.min"], columns[f"{field}.max"] = float(values.min()), float(values.max())
        known = {name: self._number(m, local, u, p) for name, (m, local) in self._measures.items()}
        found = self._formulas({**p, **known}, 1)
        columns.update({name: float(x[0]) for name, x in zip(self.names, found, strict=True)})
        return columns

    def _number(self, measure: Measure, local: LocalFormula, u: Array, p: Values) -> float:
        values = local.value(self.system.slot_values(local, u, p), p)
        weights = self.system.grid.weights
        if measure.kind == "at":
            return float(self._weights[measure.at] @ values)
        if measure.kind in ("max", "min"):
            return float(values.max() if measure.kind == "max" else values.min())
        if measure.kind == "norm":
            return float(np.sqrt(weights @ values**2 / weights.sum()))
        total = float(weights @ values)
        return total if measure.kind == "integral" else total / float(weights.sum())
