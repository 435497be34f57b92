"""Row updates of dense matrices, and products with a vector, in machine vectors; inside kernels alone.

    add_four(c, c_at, c_step, rows, p, p_at, p_step, f, f_at, f_row, f_column, columns)       C += F P
    subtract_four(...)                                                                         C -= F P
    multiply(out, out_at, a, a_at, a_step, rows, v, v_at, columns)                             out = A v

C (rows, columns), F (rows, 4), P (4, columns), A (rows, columns), each somewhere in a contiguous array of float64.
*_at : index of the first element in the flat array.  *_step : distance of rows; f_row, f_column : of rows and columns
of F. What is written must not overlap what is read. Cost: 8 rows columns operations, some 13 in a nanosecond and core
of 2020.
"""

from typing import Any

from contin.kernels import mode


def _intrinsic(name: str) -> Any:
    return None if mode.compiler is None else mode.compiler.intrinsic(name)


add_four, subtract_four, multiply = _intrinsic("add_four"), _intrinsic("subtract_four"), _intrinsic("multiply")
