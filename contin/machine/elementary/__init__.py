"""Elementary functions with the same bits on every processor, in place of the C library's.

libm chooses its code by the processor (with or without fused multiply-add), so the last digit differs between machines.
These use IEEE additions, multiplications, divisions and square roots only, in a fixed order. Errors are below 0.55 ulp
(`tests/machine`), results below the smallest normal number may be one unit off.
"""

from contin.machine.elementary.code import FUNCTIONS, addresses, llvm_text, loop_address
from contin.machine.elementary.translate import symbol

__all__ = ["FUNCTIONS", "addresses", "llvm_text", "loop_address", "symbol"]
