"""Derivatives in formulas: dx(u), dxx(u), dxy(u), lap(u) of fields, and of formulas by the chain rule.

A derivative of a field is a symbol named as it is written, which no formula can contain otherwise. That of a formula is
the total derivative: dx(D(u)*dx(u)) becomes D'(u)*dx(u)^2 + D(u)*dxx(u).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product

from contin.errors import ExpressionError
from contin.model.expression import ONE, ZERO, Expression, add, mul, symbol, symbols_in
from contin.model.scope import Calls
from contin.pde.grid import Grid
from contin.symbolic.calculus.derivatives import sparse_jacobian


@dataclass(frozen=True)
class Slot:
    """A field, or its derivative of order `orders[k]` along the k-th axis."""

    field: str
    orders: tuple[int, ...]

    @property
    def order(self) -> int:
        """0 for the field itself."""
        return sum(self.orders)


class Slots:
    """The symbols of fields and their derivatives on a grid."""

    def __init__(self, grid: Grid, fields: Sequence[str]) -> None:
        self.grid, self.fields = grid, tuple(fields)
        self._known = {name: Slot(name, (0,) * len(grid.axes)) for name in fields}

    def of(self, name: str) -> Slot | None:
        """What a symbol stands for, None for coordinates and parameters."""
        return self._known.get(name)

    def symbol(self, slot: Slot) -> Expression:
        """The symbol of a derivative."""
        letters = "".join(axis.name * k for axis, k in zip(self.grid.axes, slot.orders, strict=True))
        name = f"d{letters}({slot.field})" if letters else slot.field
        self._known[name] = slot
        return symbol(name)

    def used(self, formulas: Sequence[Expression]) -> list[str]:
        """Names of the fields and derivatives in formulas."""
        return [name for name in symbols_in(formulas) if name in self._known]

    def along(self, formula: Expression, axis: int, position: int) -> Expression:
        """The total derivative of a formula along one axis."""
        names = symbols_in([formula])
        slopes = sparse_jacobian([formula], names)
        terms = []
        for j, name in enumerate(names):
            slope = slopes.get((0, j))
            if slope is None:
                continue
            slot = self._known.get(name)
            if slot is not None:
                terms.append(mul(slope, self._raised(slot, axis, position)))
            elif name == self.grid.axes[axis].name:
                terms.append(mul(slope, ONE))
        return add(*terms) if terms else ZERO

    def _raised(self, slot: Slot, axis: int, position: int) -> Expression:
        orders = tuple(k + (j == axis) for j, k in enumerate(slot.orders))
        touched = [a for a, k in zip(self.grid.axes, orders, strict=True) if k]
        if len(touched) > 1:
            wrong = next((a for a in touched if a.by_ghosts), None)
            if wrong is not None:
                raise ExpressionError(
                    f"a mixed derivative of {slot.field} needs axes that are periodic or of method chebyshev; "
                    f"write `method: chebyshev` under domain.{wrong.name}", position,
                )  # fmt: skip
        axis_ = self.grid.axes[axis]
        if orders[axis] > axis_.largest_order:
            what = f"the derivative of order {orders[axis]} of {slot.field} along {axis_.name}"
            raise ExpressionError(
                f"{what} is not made: derivatives go to order 4 on a periodic axis, and to order 2 between two ends, "
                "where one condition at each end is taken (`kind: bvp` takes any order)", position,
            )  # fmt: skip
        return self.symbol(Slot(slot.field, orders))

    def calls(self) -> dict[str, Calls]:
        """dx, dxx, ..., dxy and lap as the parser takes them."""
        axes = self.grid.axes
        calls: dict[str, Calls] = {"lap": self._call(lambda e, at: self._laplacian(e, at), "lap")}
        for orders in product(range(5), repeat=len(axes)):
            if 0 < sum(orders) <= 4:
                name = "d" + "".join(axis.name * k for axis, k in zip(axes, orders, strict=True))
                calls[name] = self._call(self._repeated(orders), name)
        return calls

    def _call(self, make: Callable[[Expression, int], Expression], name: str) -> Calls:
        def read(arguments: Sequence[Expression], position: int) -> Expression:
            if len(arguments) != 1:
                raise ExpressionError(f"{name} takes 1 argument, as in {name}({self.fields[0]})", position)
            return make(arguments[0], position)

        return read

    def _repeated(self, orders: tuple[int, ...]) -> Callable[[Expression, int], Expression]:
        def make(formula: Expression, position: int) -> Expression:
            for axis, count in enumerate(orders):
                for _ in range(count):
                    formula = self.along(formula, axis, position)
            return formula

        return make

    def _laplacian(self, formula: Expression, position: int) -> Expression:
        twice = [
            self.along(self.along(formula, axis, position), axis, position) for axis in range(len(self.grid.axes))
        ]
        return add(*twice)
