"""The forcing period of a periodically forced model as machine code."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from contin.lowering.machine import compile_routines
from contin.lowering.routines import jacobian_routine

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem


@dataclass(frozen=True, eq=False)
class ForcingPeriod:
    """(u, p, T, dT) at `address`; holds the code that it points into."""

    address: int
    code: Any

    @classmethod
    def of(cls, system: CompiledSystem) -> ForcingPeriod:
        """Of a compiled forced model."""
        code = compile_routines([jacobian_routine("forcing", [system.forcing_period], system.layout)])
        return cls(code.addresses["forcing"], code)
