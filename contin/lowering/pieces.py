"""A piecewise-smooth flow taken apart: smooth equations with the choice of formula as inputs, and switching surfaces.

Every comparison that chooses a formula is written as a product of signs of *surface functions* h_j(u, p), and each sign
becomes an input s_j = +-1 (a mode). With the modes held, the equations are smooth on both sides of every surface, so an
integrator may step across one, find the crossing, and go on from there with the other formula. Products are taken
apart (x*y > 0 has the surfaces x = 0 and y = 0), so that crossing two surfaces in one step is not mistaken for none.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

from contin.abi import NO_FUNCTION, Address, Array
from contin.lowering.calls import Calls, make_call
from contin.lowering.machine import MachineCode, compile_routines
from contin.lowering.routines import Layout, jacobian_routine, vector_routine
from contin.lowering.switching import piecewise_nodes, up_to_scale
from contin.model.expression import (
    COMPARISONS,
    Expression,
    compare,
    if_,
    mask_of,
    mul,
    neg,
    number,
    numeric_value,
    postorder,
    split_coefficient,
    sub,
    substitute,
    symbol,
)
from contin.model.printing import to_text

MODE: Final = "mode {}"  # no name in a model contains a blank


@dataclass(frozen=True, eq=False)
class Pieces:
    """Machine code of a flow with its modes as inputs; the owner of that code's memory.

    The array p is (parameters, modes s_j = +-1, time if forced), `p_size` long; modes begin at `first_mode`.
    jacobian : (u, p, F, J) with J (n, n + p_size).  surfaces : (u, p, H, dH), H (count,), dH (count, n + p_size).
    value : (u, p, F).
    """

    n: int
    p_size: int
    first_mode: int
    functions: tuple[Expression, ...]
    value_address: Address
    jacobian_address: Address
    code: tuple[MachineCode, ...]
    layout: Layout
    holding_code: MachineCode | None = None  # of surfaces some of which are held

    @cached_property
    def _distances(self) -> tuple[Calls, MachineCode]:
        """The surface functions alone."""
        code = compile_routines([vector_routine("distances", self.functions, self.layout)])
        return Calls(self.n, self.p_size), code

    def distances(self, u: Array, p: Array) -> Array:
        """h_j at N points, (N, count): u (N, n), p (N, p_size); the modes in p do not matter."""
        calls, code = self._distances
        address = code.addresses["distances"]
        return calls.vectors(make_call(address, 3), address, self.count, u, p)

    @property
    def count(self) -> int:
        """Number of switching surfaces."""
        return len(self.functions)

    @property
    def surfaces_address(self) -> Address:
        return (self.holding_code or self.code[-1]).addresses.get("surfaces", NO_FUNCTION)

    def holding(self, signs: Mapping[int, int]) -> Pieces:
        """The same flow with the formulas of one side (+-1) of these surfaces, wherever the state is: smooth there."""
        functions = [number(signs[j]) if j in signs else h for j, h in enumerate(self.functions)]
        return replace(self, holding_code=compile_routines([jacobian_routine("surfaces", functions, self.layout)]))

    def name(self, index: int) -> str:
        """A surface in words: the formula that vanishes there."""
        return f"{to_text(self.functions[index])} = 0"


def compile_pieces(
    equations: Sequence[Expression], layout: Layout, time: str | None, smooth: Callable[[str], MachineCode]
) -> Pieces:
    """Machine code of `equations` with modes; `time` is the name of the last of `layout.others` in a forced model.

    smooth : gives the code of their "value" and "jacobian", which serves where there are no surfaces.
    """
    frozen, functions = freeze(equations, layout.names, parameters=set(layout.others) - {time})
    parameters = layout.others[:-1] if time is not None else layout.others
    if not functions:
        value, jacobian = smooth("value"), smooth("jacobian")
        addresses = value.addresses["value"], jacobian.addresses["jacobian"]
        sizes = len(layout.states), len(layout.others), len(parameters)
        return Pieces(*sizes, (), *addresses, (value, jacobian), layout)
    modes = tuple(MODE.format(k) for k in range(len(functions)))
    others = parameters + modes + ((time,) if time is not None else ())
    extended = Layout(layout.states, others)
    code = compile_routines([
        vector_routine("value", frozen, extended), jacobian_routine("jacobian", frozen, extended),
        jacobian_routine("surfaces", functions, extended),
    ])  # fmt: skip
    addresses = code.addresses["value"], code.addresses["jacobian"]
    sizes = len(layout.states), len(others), len(parameters)
    return Pieces(*sizes, tuple(functions), *addresses, (code,), extended)


def freeze(
    equations: Sequence[Expression], names: Iterable[str], parameters: Iterable[str] = ()
) -> tuple[list[Expression], list[Expression]]:
    """Equations with every choice of formula made by mode symbols, and the surface functions that belong to these.

    `names` are what may vary (states, parameters, time); conditions without them are left as they are. Of conditions
    on `parameters` alone, too, which no trajectory crosses, the surfaces are listed, but k == 2 is asked of k itself.
    """
    chosen = set(piecewise_nodes(equations))
    names = list(names)
    surfaces, moving = Surfaces(mask_of(names)), mask_of(set(names).difference(parameters))
    replaced: dict[Expression, Expression] = {}
    for node in postorder(equations):  # operands first
        condition = surfaces.condition(node) if node in chosen else None
        if condition is None or not any(a.mask & moving for a in node.args):
            continue
        if node.op in COMPARISONS:
            replaced[node] = condition
            continue
        args = substitute(node.args, replaced)
        if node.op in ("min", "max"):
            smaller, larger = (args[1], args[0]) if node.op == "min" else args
            replaced[node] = if_(condition, smaller, larger)  # args[0] is the larger one where the condition holds
        elif node.op == "abs":
            replaced[node] = if_(condition, args[0], neg(args[0]))
        else:
            replaced[node] = if_(condition, number(1), number(-1 if node.op == "sign" else 0))
    return substitute(equations, replaced), surfaces.functions


class Surfaces:
    """Surface functions in order of occurrence, each once up to a factor, and conditions in terms of their modes."""

    def __init__(self, mask: int) -> None:
        self.functions: list[Expression] = []
        self._mask = mask
        self._known: dict[object, tuple[int, bool]] = {}  # number of the surface, sign of its leading coefficient

    def condition(self, node: Expression) -> Expression | None:
        """The comparison holds; for a function: its argument (a - b for min and max) is positive.

        None where nothing in it moves.
        """
        pair = node.op in COMPARISONS or node.op in ("min", "max")
        function = sub(*node.args) if pair else node.args[0]
        if not function.mask & self._mask:
            return None
        coefficient, rest = split_coefficient(function)
        sides = [number(-1 if coefficient < 0 else 1)]
        for factor in rest.args if rest.op == "mul" else (rest,):
            base, exponent = factor, 1.0
            if factor.op == "pow" and factor.args[1].is_number:
                base, exponent = factor.args[0], float(numeric_value(factor.args[1]))
            if exponent % 2 == 0:
                continue  # never negative
            moving = base if exponent % 2 == 1 else factor
            sides.append(self._mode(moving) if moving.mask & self._mask else moving)
        return compare(node.op if node.op in COMPARISONS else ">", mul(*sides), number(0))

    def _mode(self, function: Expression) -> Expression:
        """Sign of a function, as a mode of its surface."""
        key, positive = up_to_scale(function)
        index, same = self._known.setdefault(key, (len(self.functions), positive))
        if index == len(self.functions):
            self.functions.append(function)
        mode = symbol(MODE.format(index))
        return mode if same == positive else neg(mode)
