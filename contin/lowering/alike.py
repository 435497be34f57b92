"""Formulas that differ only in their symbols and constants: one piece of machine code for all of them.

A large model is n equations of a few shapes (a chain, a grid, a network): the neighbours, and the constants, differ. A
shape is the graph of an equation with its states and constants numbered by first occurrence. It is differentiated and
compiled once, as a function of its slots, and called for all its equations in one loop; the derivative with respect to
a slot is an entry of the Jacobian, so the sparsity is known, and neither time nor memory grow faster than n.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.lowering.calls import Calls
from contin.lowering.machine import MachineCode, compile_routines
from contin.lowering.routines import Layout, vector_routine
from contin.lowering.tape import as_float
from contin.model.expression import ZERO, Expression, postorder, rebuild, symbol
from contin.symbolic.calculus.derivatives import direction_symbols, directional, sparse_jacobian
from contin.symbolic.calculus.remove_singularities import remove_singularities

LITERAL: Final = 16  # integers up to this are part of a shape, as exponents are: they decide how it is computed


def slot_symbols(count: int) -> list[Expression]:
    """Symbols of the slots; their names cannot occur in a model."""
    return [symbol(f"@slot{k}") for k in range(count)]


@dataclass(frozen=True, eq=False)
class Shape:
    """One shape: its formula in the slots (states first, then constants) and parameters, and who has it.

    rows (G,) : numbers of the formulas.  states (G, L) : the state in each slot.  constants (G, C).
    """

    formula: Expression
    rows: NDArray[np.intp]
    states: NDArray[np.intp]
    constants: Array

    @property
    def size(self) -> int:
        """Number of slots of both kinds."""
        return int(self.states.shape[1] + self.constants.shape[1])


def shapes_of(formulas: Sequence[Expression], names: Sequence[str]) -> list[Shape]:
    """The shapes of formulas in the states `names`; every other symbol is a parameter."""
    number = {name: k for k, name in enumerate(names)}
    nodes: dict[tuple[object, ...], list[Expression]] = {}
    found: dict[tuple[object, ...], list[tuple[int, list[int], list[float]]]] = {}
    for row, formula in enumerate(formulas):
        key, order, states, constants = _key(formula, number)
        nodes.setdefault(key, order)
        found.setdefault(key, []).append((row, states, constants))
    return [_shape(nodes[key], number, members) for key, members in found.items()]


def _key(formula: Expression, number: Mapping[str, int]) -> tuple[Any, list[Expression], list[int], list[float]]:
    """What formulas of one shape have in common; the nodes, and the states and constants in the slots."""
    order = postorder([formula])
    place: dict[Expression, int] = {}
    parts: list[object] = []
    states: list[int] = []
    constants: list[float] = []
    exponents = {node.args[1] for node in order if node.op == "pow"}
    for k, node in enumerate(order):
        place[node] = k
        if node.op == "symbol":
            state = number.get(str(node.value))
            parts.append(node.value if state is None else -1)
            if state is not None:
                states.append(state)
        elif node.op == "number" and _is_slot(node, exponents):
            parts.append(-2)
            constants.append(as_float(node))
        else:
            parts.append((node.op, node.value, tuple([place[a] for a in node.args])))
    return tuple(parts), order, states, constants


def _is_slot(node: Expression, exponents: set[Expression]) -> bool:
    value = as_float(node)
    return not (value.is_integer() and abs(value) <= LITERAL) and math.isfinite(value) and node not in exponents


def _shape(
    order: Sequence[Expression], number: Mapping[str, int], members: Sequence[tuple[int, list[int], list[float]]]
) -> Shape:
    rows = np.array([row for row, _, _ in members], dtype=np.intp)
    states = np.array([s for _, s, _ in members], dtype=np.intp).reshape(len(members), -1)
    constants = np.array([c for _, _, c in members], dtype=float).reshape(len(members), -1)
    slots = slot_symbols(states.shape[1] + constants.shape[1])
    exponents = {node.args[1] for node in order if node.op == "pow"}
    done: dict[Expression, Expression] = {}
    state = constant = 0
    for node in order:
        if node.op == "symbol" and str(node.value) in number:
            done[node] = slots[state]
            state += 1
        elif node.op == "number" and _is_slot(node, exponents):
            done[node] = slots[states.shape[1] + constant]
            constant += 1
        else:
            done[node] = rebuild(node, tuple(done[a] for a in node.args)) if node.args else node
    return Shape(remove_singularities([done[order[-1]]])[0], rows, states, constants)


class Alike:
    """Values and derivatives of many formulas in states (n,) and parameters (m,), by shapes."""

    def __init__(self, formulas: Sequence[Expression], names: Sequence[str], parameters: Sequence[str]) -> None:
        self.count, self.n, self.parameters = len(formulas), len(names), tuple(parameters)
        self.shapes = shapes_of(formulas, names)
        self._code: dict[str, tuple[MachineCode, list[int]]] = {}

    def value(self, u: Array, p: Array) -> Array:
        """(count,)."""
        out = np.empty(self.count)
        for shape, result in zip(self.shapes, self._run("value", u, p), strict=True):
            out[shape.rows] = result[:, 0]
        return out

    @cached_property
    def pattern(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """(rows, columns) of the entries of `slopes`, each place once."""
        rows = [np.repeat(s.rows, s.states.shape[1]) for s in self.shapes]
        columns = [s.states.ravel() for s in self.shapes]
        return np.concatenate([*rows, np.empty(0, np.intp)]), np.concatenate([*columns, np.empty(0, np.intp)])

    def slopes(self, u: Array, p: Array) -> Array:
        """Derivatives with respect to the states, at the places of `pattern`."""
        return np.concatenate([r.ravel() for r in self._run("slopes", u, p)] or [np.empty(0)])

    def parameter_slopes(self, u: Array, p: Array) -> Array:
        """Derivatives with respect to the parameters, (count, m)."""
        out = np.empty((self.count, len(self.parameters)))
        for shape, result in zip(self.shapes, self._run("parameters", u, p), strict=True):
            out[shape.rows] = result
        return out

    def form(self, u: Array, p: Array, directions: Sequence[Array]) -> Array:
        """D^k f[v1, .., vk], (count,); directions (n + m,), real."""
        out = np.empty(self.count)
        for shape, result in zip(self.shapes, self._run(f"form{len(directions)}", u, p, directions), strict=True):
            out[shape.rows] = result[:, 0]
        return out

    def _run(self, what: str, u: Array, p: Array, directions: Sequence[Array] = ()) -> list[Array]:
        code, widths = self._compiled(what)
        results = []
        for k, (shape, width) in enumerate(zip(self.shapes, widths, strict=True)):
            parts = [u[shape.states], shape.constants]
            for v in directions:
                parts += [v[shape.states], np.zeros_like(shape.constants)]
                parts.append(np.broadcast_to(v[self.n :], (len(shape.rows), len(self.parameters))))
            address, size = code.addresses[f"{what}_{k}"], self._width(what, shape)
            results.append(Calls(width, len(p)).vectors(None, address, size, np.hstack(parts), p))
        return results

    def _width(self, what: str, shape: Shape) -> int:
        return {"slopes": int(shape.states.shape[1]), "parameters": len(self.parameters)}.get(what, 1)

    def _compiled(self, what: str) -> tuple[MachineCode, list[int]]:
        """Machine code of one kind of function for all shapes, and how many inputs each takes beside the parameters."""
        known = self._code.get(what)
        if known is None:
            routines, widths = [], []
            for k, shape in enumerate(self.shapes):
                slots = [str(s.value) for s in slot_symbols(shape.size)]
                outputs, extra = self._outputs(what, shape, slots)
                layout = Layout((*slots, *extra), self.parameters)
                routines.append(vector_routine(f"{what}_{k}", outputs, layout))
                widths.append(len(layout.states))
            known = self._code[what] = compile_routines(routines), widths
        return known

    def _outputs(self, what: str, shape: Shape, slots: list[str]) -> tuple[list[Expression], list[str]]:
        """The formulas of one kind of function, and the symbols of directions that they take."""
        if what == "value":
            return [shape.formula], []
        if what.startswith("form"):
            names = [*slots, *self.parameters]
            directions = [direction_symbols(k + 1, len(names)) for k in range(int(what.removeprefix("form")))]
            return directional([shape.formula], names, directions), [str(d.value) for row in directions for d in row]
        names = slots[: shape.states.shape[1]] if what == "slopes" else list(self.parameters)
        entries = sparse_jacobian([shape.formula], names)
        return [entries.get((0, j), ZERO) for j in range(len(names))], []
