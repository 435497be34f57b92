"""Conditions at the sides of a domain: each is solved for the value or the slope of one field there.

u = A (value), dx(u) = g(u, v) (slope along the axis), dn(u) = g (slope along the outward normal); also implicitly, as
long as the value, or the slope, occurs linearly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from contin.errors import ExpressionError
from contin.model.expression import ZERO, Expression, div, mul, neg, substitute, symbol, symbols_in
from contin.model.inline import Formulas
from contin.model.scope import Calls, Scope
from contin.model.source import Path
from contin.pde.grid import Grid, Side
from contin.pde.slots import Slot, Slots
from contin.symbolic.calculus.derivatives import derivative

ALL = "all"


@dataclass(frozen=True)
class SideCondition:
    """On `side` the value of `field`, or its slope along the side's axis, is `right`.

    A value's `right` contains parameters and coordinates; that of a slope may contain values of fields too.
    """

    field: str
    side: Side
    kind: Literal["value", "slope"]
    right: Expression
    path: Path


class ConditionReader:
    """Reads the section `boundary`."""

    def __init__(self, formulas: Formulas, slots: Slots, grid: Grid) -> None:
        self.formulas, self.slots, self.grid = formulas, slots, grid
        self.problems = formulas.problems
        self._scope = formulas.scope

    def read(self, written: dict[str, list[str]]) -> list[SideCondition]:
        """All conditions; what is wrong, and which are missing, is noted."""
        found: list[SideCondition] = []
        for key, texts in written.items():
            path: Path = ("boundary", key)
            if key not in self.grid.sides and (key != ALL or not self.grid.sides):
                known = ", ".join([*self.grid.sides, ALL]) if self.grid.sides else "none, as every axis is periodic"
                self.problems.add(path, f"there is no side {key!r}; sides are {known}", key=True)
                continue
            sides = self.grid.sides if key == ALL else {key: self.grid.sides[key]}
            for k, text in enumerate(texts):
                for side in sides.values():
                    condition = self._condition(text, side, (*path, k))
                    if condition is None:
                        break
                    found.append(condition)
        if not self.problems:
            self._complete(found)
        return found

    def _condition(self, text: str, side: Side, path: Path) -> SideCondition | None:
        left, sign, right = text.partition("=")
        if not sign or right.startswith("=") or left.endswith(("<", ">", "!")):
            self.problems.add(path, f"a condition is an equation with one `=`, such as {self.slots.fields[0]} = 0")
            return None
        before = len(self.problems.found)
        scope = self._with_normal(side)
        residual = self.formulas.read(left, path, scope) - self.formulas.read(right, path, scope)
        if len(self.problems.found) > before:
            return None
        try:
            return self._solved(residual, side, path)
        except ExpressionError as error:
            self.problems.add(path, str(error))
            return None

    def _with_normal(self, side: Side) -> Scope:
        sign = -1 if side.end == 0 else 1

        def normal(arguments: Sequence[Expression], position: int) -> Expression:
            if len(arguments) != 1:
                raise ExpressionError("dn takes 1 argument, as in dn(u) = 0", position)
            return mul(sign, self.slots.along(arguments[0], side.axis, position))

        calls: dict[str, Calls] = {**self._scope.calls, "dn": normal}
        s = self._scope
        return Scope(s.names, s.functions, s.conditions, s.unavailable, s.budget, calls)

    def _solved(self, residual: Expression, side: Side, path: Path) -> SideCondition:
        """residual = 0 for a value or a slope."""
        names = self.slots.used([residual])
        slots: dict[str, Slot] = {name: slot for name in names if (slot := self.slots.of(name)) is not None}
        slopes = [name for name in names if slots[name].order]
        if len(slopes) > 1:
            raise ExpressionError(f"two slopes, {slopes[0]} and {slopes[1]}: write a condition for each field's own")
        target = slopes[0] if slopes else names[0] if len(names) == 1 else None
        if target is None:
            what = f"the values of {' and '.join(names)}" if names else "no field"
            raise ExpressionError(f"a condition for {what}: write one for each field, as in u = 0 or dn(u) = 0")
        slot = slots[target]
        if slot.order > 1 or (slot.order and not slot.orders[side.axis]):
            axis = self.grid.axes[side.axis].name
            raise ExpressionError(f"{target} at a side: conditions are for a field or its slope d{axis} there")
        slope = derivative(residual, target)
        if slope is ZERO or any(name in symbols_in([slope]) for name in self.slots.used([slope])):
            raise ExpressionError(f"{target} must occur linearly in a condition: write {target} = ...")
        rest = substitute([residual], {symbol(target): ZERO})[0]
        return SideCondition(slot.field, side, "slope" if slot.order else "value", neg(div(rest, slope)), path)

    def _complete(self, found: Sequence[SideCondition]) -> None:
        for name, side in self.grid.sides.items():
            for field in self.slots.fields:
                given = [c for c in found if c.side == side and c.field == field]
                if not given:
                    advice = f"add `{field} = 0` or `dn({field}) = 0` under boundary.{name}, or under boundary.{ALL}"
                    self.problems.add(("boundary",), f"no condition for {field} at {name}; {advice}", key=True)
                elif len(given) > 1:
                    self.problems.add(given[1].path, f"a second condition for {field} at {name}; leave one of them out")

