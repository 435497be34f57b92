"""The forcing period of a periodically forced model as machine code."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from contin.abi import Array
from contin.lowering.machine import compile_routines
from contin.lowering.routines import gradient_routine, jacobian_routine
from contin.model.evaluate import evaluate
from contin.model.expression import Expression
from contin.symbolic.calculus.derivatives import derivative

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem


@dataclass(frozen=True, eq=False)
class ForcingPeriod:
    """(u, p, T, dT) at `address`, (u, p, v, dT v, d^2T[v, .]) at `gradient_address`; `code` is what they point into.

    `period` is T as a formula in `parameters`.
    """

    address: int
    gradient_address: int
    code: Any
    period: Expression
    parameters: tuple[str, ...]

    @classmethod
    def of(cls, system: CompiledSystem) -> ForcingPeriod:
        """Of a compiled forced model."""
        period, layout = system.forcing_period, system.layout
        routines = [jacobian_routine("forcing", [period], layout), gradient_routine("gradient", [period], layout)]
        code = compile_routines(routines)
        addresses = code.addresses
        return cls(addresses["forcing"], addresses["gradient"], code, period, tuple(system.parameter_names))

    def second_derivative(self, p: Array, active: int) -> float:
        """d^2T/dp^2 by one parameter, at all parameters p."""
        name = self.parameters[active]
        values = dict(zip(self.parameters, p.tolist(), strict=False))  # the last of p is the time
        return float(evaluate(derivative(derivative(self.period, name), name), values))
