"""Products of many small matrices at once, in machine vectors over the lanes; inside kernels alone.

Element (r, c) of lane i of a matrix stands `step` r + `far` c + i numbers after its first: the lanes are contiguous.
"""

from typing import Any

from contin.kernels import mode
from contin.kernels.compile import vector_kernel


def _intrinsic(name: str) -> Any:
    return None if mode.compiler is None else mode.compiler.intrinsic(name)


address, subtract_lanes = _intrinsic("address"), _intrinsic("subtract_lanes")
forward_lanes, backward_lanes = _intrinsic("forward_lanes"), _intrinsic("backward_lanes")


@vector_kernel("i, i, i, i, i, i, i, i, i, i, i")
def subtract_products(c, c_step, rows, columns, f, f_step, p, p_step, depth, far, lanes):
    """C -= F P in every lane: C (rows, columns), F (rows, depth), P (depth, columns).

    c, f, p : addresses of their first elements, `address(array, index)`. C must not overlap F or P.
    """
    subtract_lanes(c, c_step, rows, columns, f, f_step, p, p_step, depth, far, lanes)
