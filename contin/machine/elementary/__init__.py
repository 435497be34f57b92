"""Elementary functions with the same bits on every processor, in place of the C library's and numpy's.

These choose their code by the processor (with or without fused multiply-add, with wider vectors), so the last digit
differs between machines. Ours use IEEE additions, multiplications, divisions and square roots only, in a fixed order.
Errors are below 0.51 ulp, of hyperbolic ones below 0.64 (`tests/machine`); results below the smallest normal number
are rounded twice.

Machine code calls them by `symbol` and `addresses`; Python calls `elementary.exp(x)` with numbers or arrays.
"""

from contin.machine.elementary.code import addresses, llvm_text, loop_address, source
from contin.machine.elementary.functions import (
    acos,
    acosh,
    angle,
    asin,
    asinh,
    atan,
    atan2,
    atanh,
    cos,
    cosh,
    exp,
    exp2,
    expm1,
    hypot,
    log,
    log1p,
    log2,
    log10,
    pow,
    sin,
    sinh,
    square,
    tan,
    tanh,
)
from contin.machine.elementary.names import FUNCTIONS, symbol

__all__ = [
    "FUNCTIONS",
    "acos",
    "acosh",
    "addresses",
    "angle",
    "asin",
    "asinh",
    "atan",
    "atan2",
    "atanh",
    "cos",
    "cosh",
    "exp",
    "exp2",
    "expm1",
    "hypot",
    "llvm_text",
    "log",
    "log1p",
    "log2",
    "log10",
    "loop_address",
    "pow",
    "sin",
    "sinh",
    "source",
    "square",
    "symbol",
    "tan",
    "tanh",
]
