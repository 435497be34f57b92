"""Which outputs each compiled function of `contin.abi` has: formulas in, `Routine` out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from contin.errors import InputError
from contin.lowering.llvm_text import Routine, Store
from contin.lowering.tape import Tape
from contin.model.expression import ZERO, Expression, symbols_in
from contin.symbolic.calculus.derivatives import direction_symbols, directional, sparse_jacobian

FEW_ZEROS: Final = 8  # that many zeros of a matrix are stored one by one; more are cleared at once


@dataclass(frozen=True)
class Layout:
    """Where symbols stand: `states` in the array u, `others` (parameters, then the time if forced) in the array p."""

    states: tuple[str, ...]
    others: tuple[str, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """z = (u, p)."""
        return self.states + self.others

    def inputs(self, order: int = 0) -> dict[str, tuple[int, int]]:
        """Symbol -> (argument, index), with the components of `order` directions in the arguments 2, 3, ..."""
        inputs = {name: (0, i) for i, name in enumerate(self.states)}
        inputs.update({name: (1, i) for i, name in enumerate(self.others)})
        for k in range(order):
            for i, component in enumerate(direction_symbols(k + 1, len(self.names))):
                inputs[str(component.value)] = (2 + k, i)
        return inputs

    def check(self, expressions: Mapping[str, Expression]) -> None:
        """Raises `InputError` for a symbol that is neither state nor parameter."""
        known = set(self.names)
        for name, expression in expressions.items():
            unknown = [s for s in symbols_in([expression]) if s not in known]
            if unknown:
                raise InputError(f"{name}: {unknown[0]!r} is neither a state nor a parameter of this model")


def vector_routine(name: str, expressions: Sequence[Expression], layout: Layout) -> Routine:
    """(u, p, out): out[k] = k-th expression."""
    return _vector(name, expressions, layout, 0)


def form_routine(
    name: str, expressions: Sequence[Expression], layout: Layout, order: int, of_states: bool = False
) -> Routine:
    """(u, p, v_1, ..., v_k, out): the k-th derivative along k directions, each (n + m,).

    of_states : of directions whose components along `layout.others` are zero.
    """
    directions = [direction_symbols(k + 1, len(layout.names)) for k in range(order)]
    if of_states:
        directions = [[*d[: len(layout.states)], *[ZERO] * len(layout.others)] for d in directions]
    return _vector(name, directional(expressions, layout.names, directions), layout, order)


def _vector(name: str, expressions: Sequence[Expression], layout: Layout, order: int) -> Routine:
    tape = Tape(layout.inputs(order))
    outputs = [tape.evaluate(e) for e in expressions]
    statements, outputs = tape.pruned(outputs)
    stores = [Store(2 + order, i, statement) for i, statement in enumerate(outputs)]
    return Routine(name, 3 + order, statements, stores)


def gradient_routine(name: str, expressions: Sequence[Expression], layout: Layout) -> Routine:
    """(u, p, v, w, H): w = Df[v] and H = D^2f[v, .], (n, n + p_size), the derivative of w with respect to z."""
    direction = [direction_symbols(1, len(layout.names))]
    return jacobian_routine(name, directional(expressions, layout.names, direction), layout, 1)


def jacobian_routine(name: str, expressions: Sequence[Expression], layout: Layout, order: int = 0) -> Routine:
    """(u, p, F, J): values and their derivatives with respect to z, row by row so that both share what they can.

    `order` directions (see `Layout.inputs`), which the expressions may contain, stand between p and F.
    """
    columns = len(layout.names)
    rows: list[list[tuple[int, Expression]]] = [[] for _ in expressions]
    for (i, j), entry in sparse_jacobian(expressions, layout.names).items():
        rows[i].append((j, entry))
    zeros = len(expressions) * columns - sum(len(row) for row in rows)
    if zeros <= FEW_ZEROS:
        rows = [_dense(row, columns) for row in rows]
    tape = Tape(layout.inputs(order))
    targets: list[tuple[int, int]] = []
    outputs: list[int] = []
    for i, expression in enumerate(expressions):
        targets.append((2 + order, i))
        outputs.append(tape.evaluate(expression))
        for j, entry in rows[i]:
            targets.append((3 + order, i * columns + j))
            outputs.append(tape.evaluate(entry))
    statements, outputs = tape.pruned(outputs)
    stores = [Store(array, index, s) for (array, index), s in zip(targets, outputs, strict=True)]
    cleared = () if zeros <= FEW_ZEROS else ((3 + order, len(expressions) * columns),)
    return Routine(name, 4 + order, statements, stores, cleared)


def _dense(row: Sequence[tuple[int, Expression]], columns: int) -> list[tuple[int, Expression]]:
    entries = dict(row)
    return [(j, entries.get(j, ZERO)) for j in range(columns)]
