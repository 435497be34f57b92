"""A long integration, looked at every so many steps: tolerances below rounding, stiffness, too many steps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.kernels.piecewise import flight as kernel
from contin.simulate.natural import above_rounding

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem

CHUNK = 20_000  # steps between two looks (at Ctrl-C, too)
STIFF_CHUNKS = 5  # so many times in succession the step is limited by stability, not by accuracy: the model is stiff
STABLE = 2.0  # the step times the fastest decay rate, beyond which that is so (DOP853 is stable to about 6)
SURE, HOPELESS = 10 * CHUNK, 100.0  # after so many steps, so many times the budget still needed: it is not begun
LONG = 20 * CHUNK  # steps; what takes less is not worth another method


@dataclass(frozen=True, eq=False)
class Integrated:
    """The state u (n,) of an integration, its parameters p, and its absolute tolerances (n,): views of its memory."""

    system: CompiledSystem
    u: Array
    p: Array
    allowed: Array

    def raised(self) -> bool:
        """Put the tolerances above the rounding errors of the equations; True where they were below."""
        if not np.all(np.isfinite(self.u)):
            return False
        higher = above_rounding(self.system, self.allowed, self.u, own_parameters(self.system, self.p))
        changed = not np.array_equal(higher, self.allowed)
        self.allowed[:] = higher
        return changed


def in_chunks(
    flown: Callable[[bool], int], now: Integrated, controls: Array, counts: NDArray[np.int64], budget: int
) -> tuple[int, bool, float]:  # fmt: skip
    """Chunks of steps until the kernel is done or there is no hope that it will be.

    flown : the kernel, told whether it has begun; its status.

    The kernel's status, whether the flow is stiff, and how many steps would still be needed.
    """
    started, stiff, left = False, 0, 0.0
    while True:
        status = flown(started)
        started = True
        if status not in (kernel.STEPS, kernel.SMALL) or counts[2] > budget:
            break
        higher = now.raised()
        if status == kernel.SMALL and not higher:
            break
        left = (float(controls[1]) - float(controls[0])) / max(float(controls[2]), 1e-300)
        if counts[2] > SURE and not higher and left > HOPELESS * budget:
            break
        stiff = stiff + 1 if left > LONG and is_stiff(now.system, now.u, now.p, float(controls[2])) else 0
        if stiff >= STIFF_CHUNKS:
            break
    return status, stiff >= STIFF_CHUNKS, left


def is_stiff(system: CompiledSystem, u: Array, p: Array, h: float) -> bool:
    """True where the step times the fastest decay rate is near the limit of the method's stability."""
    jacobian = np.asarray(system.jacobian(u, own_parameters(system, p))[1])[:, : system.n]
    if not np.all(np.isfinite(jacobian)):
        return False
    return bool(-h * float(np.linalg.eigvals(jacobian).real.min()) > STABLE)


def own_parameters(system: CompiledSystem, p: Array) -> Array:
    """Parameters, and the time of a forced system, of those of its pieces."""
    return np.append(p[: system.m], p[-1]) if system.is_forced else np.ascontiguousarray(p[: system.m])
