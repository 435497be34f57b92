"""How `contin.kernels.vector` becomes machine vectors: numba intrinsics.

numba turns plain loops into vector instructions too, but tests before each of them whether the arrays overlap, and
leaves up to fifteen numbers at the end to be done one by one: half of the time for rows of twenty to a hundred numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, TypeAlias

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.types import Type
from numba.core.typing import Signature
from numba.extending import intrinsic

if TYPE_CHECKING:
    from numba.core.base import BaseContext

Intrinsic: TypeAlias = tuple[Signature, Callable[..., ir.Value]]  # what it is of these types, and what emits it

LANES, ROWS, PIVOTS = 4, 2, 4  # numbers in a vector; rows worked on together; rows of P
FUSED = ("contract",)
WORD, NUMBER = ir.IntType(64), ir.DoubleType()
VECTOR = ir.VectorType(NUMBER, LANES)


@intrinsic
def add_four(
    typing_context: BaseContext, c: Type, c_at: Type, c_step: Type, rows: Type, p: Type, p_at: Type, p_step: Type,
    f: Type, f_at: Type,
    f_row: Type, f_column: Type, columns: Type,
) -> Intrinsic:  # fmt: skip
    """C += F P, C (rows, columns), F (rows, 4), P (4, columns), each somewhere in a contiguous array of float64.

    *_at : index of the first element in the flat array.  *_step : distance of rows; f_row, f_column: of rows and
    columns of F. C must not overlap F or P. Cost: 8 rows columns operations, some 13 in a nanosecond and core of 2020.
    """
    return _signature(c, p, f), partial(_update, 1)


@intrinsic
def subtract_four(
    typing_context: BaseContext, c: Type, c_at: Type, c_step: Type, rows: Type, p: Type, p_at: Type, p_step: Type,
    f: Type, f_at: Type,
    f_row: Type, f_column: Type, columns: Type,
) -> Intrinsic:  # fmt: skip
    """C -= F P, as `add_four`."""
    return _signature(c, p, f), partial(_update, -1)


@intrinsic
def multiply(
    typing_context: BaseContext, out: Type, out_at: Type, a: Type, a_at: Type, a_step: Type, rows: Type, v: Type,
    v_at: Type,
    columns: Type,
) -> Intrinsic:  # fmt: skip
    """out = A v, A (rows, columns), each somewhere in a contiguous array of float64; places as of `add_four`.

    out must not overlap A or v.
    """
    word = types.intp
    return types.void(out, word, a, word, word, word, v, word, word), _multiply


def _signature(c: Type, p: Type, f: Type) -> Signature:
    word = types.intp
    return types.void(c, word, word, word, p, word, word, f, word, word, word, word)


def _update(
    sign: int, context: BaseContext, builder: ir.IRBuilder, signature: Signature, args: Sequence[ir.Value]
) -> ir.Value:
    combine = builder.fadd if sign > 0 else builder.fsub

    target, pivots, factors = (_first(context, builder, signature, args, k) for k in (0, 4, 7))
    target_step, rows, pivot_step, row_step, column_step, columns = (args[k] for k in (2, 3, 6, 9, 10, 11))
    pivot_rows = [_at(builder, pivots, builder.mul(_word(j), pivot_step)) for j in range(PIVOTS)]
    vectors = builder.udiv(columns, _word(LANES))
    beyond = builder.mul(vectors, _word(LANES))

    def together(start: ir.Value, count: int) -> None:
        """`count` rows from `start` on."""
        targets, scalars = [], []
        for k in range(count):
            row = builder.add(start, _word(k))
            targets.append(_at(builder, target, builder.mul(row, target_step)))
            place = _at(builder, factors, builder.mul(row, row_step))
            scalars.append(
                [builder.load(_at(builder, place, builder.mul(_word(j), column_step))) for j in range(PIVOTS)]
            )
        broadcasts = [[_broadcast(builder, x) for x in row] for row in scalars]

        def columns_at(offset: ir.Value, values: list[list[ir.Value]], type_: ir.Type) -> None:
            def pointer(row: ir.Value) -> ir.Value:
                return builder.bitcast(_at(builder, row, offset), type_.as_pointer())

            above = [builder.load(pointer(row), align=8) for row in pivot_rows]
            for k in range(count):
                place = pointer(targets[k])
                x = builder.load(place, align=8)
                for value, u in zip(values[k], above, strict=True):
                    x = combine(x, builder.fmul(value, u, flags=FUSED), flags=FUSED)
                builder.store(x, place, align=8)

        with cgutils.for_range(builder, vectors) as loop:
            columns_at(builder.mul(loop.index, _word(LANES)), broadcasts, VECTOR)
        with cgutils.for_range(builder, builder.sub(columns, beyond)) as loop:
            columns_at(builder.add(beyond, loop.index), scalars, NUMBER)

    _in_groups(builder, rows, ROWS, together)
    return context.get_dummy_value()


def _multiply(context: BaseContext, builder: ir.IRBuilder, signature: Signature, args: Sequence[ir.Value]) -> ir.Value:
    target, matrix, vector = (_first(context, builder, signature, args, k) for k in (0, 2, 6))
    step, rows, columns = args[4], args[5], args[8]
    vectors = builder.udiv(columns, _word(LANES))
    beyond = builder.mul(vectors, _word(LANES))

    def together(start: ir.Value, count: int) -> None:
        """`count` rows from `start` on."""
        places = [_at(builder, matrix, builder.mul(builder.add(start, _word(k)), step)) for k in range(count)]
        sums = [_zero(builder, VECTOR, [0.0] * LANES) for _ in range(count)]
        rests = [_zero(builder, NUMBER, 0.0) for _ in range(count)]

        def columns_at(offset: ir.Value, totals: list[ir.Value], type_: ir.Type) -> None:
            def load(row: ir.Value) -> ir.Value:
                return builder.load(builder.bitcast(_at(builder, row, offset), type_.as_pointer()), align=8)

            x = load(vector)
            for place, total in zip(places, totals, strict=True):
                product = builder.fmul(load(place), x, flags=FUSED)
                builder.store(builder.fadd(builder.load(total), product, flags=FUSED), total)

        with cgutils.for_range(builder, vectors) as loop:
            columns_at(builder.mul(loop.index, _word(LANES)), sums, VECTOR)
        with cgutils.for_range(builder, builder.sub(columns, beyond)) as loop:
            columns_at(builder.add(beyond, loop.index), rests, NUMBER)
        for k, (total, rest) in enumerate(zip(sums, rests, strict=True)):
            parts = [builder.extract_element(builder.load(total), ir.Constant(ir.IntType(32), j)) for j in range(LANES)]
            value = builder.fadd(builder.fadd(parts[0], parts[1]), builder.fadd(parts[2], parts[3]))
            place = _at(builder, target, builder.add(start, _word(k)))
            builder.store(builder.fadd(value, builder.load(rest)), place, align=8)

    _in_groups(builder, rows, 4, together)
    return context.get_dummy_value()


def _in_groups(builder: ir.IRBuilder, rows: ir.Value, size: int, together: Callable[[ir.Value, int], None]) -> None:
    """`together(first row, count)` for all `rows`: in groups of `size`, what is left one by one."""
    groups = builder.udiv(rows, _word(size))
    with cgutils.for_range(builder, groups) as loop:
        together(builder.mul(loop.index, _word(size)), size)
    grouped = builder.mul(groups, _word(size))
    with cgutils.for_range(builder, builder.sub(rows, grouped)) as loop:
        together(builder.add(grouped, loop.index), 1)


def _first(
    context: BaseContext, builder: ir.IRBuilder, signature: Signature, args: Sequence[ir.Value], k: int
) -> ir.Value:
    """Address of the element that arguments k (an array) and k + 1 (an index) name."""
    data = cgutils.create_struct_proxy(signature.args[k])(context, builder, args[k]).data
    return builder.gep(data, [args[k + 1]])


def _zero(builder: ir.IRBuilder, type_: ir.Type, value: ir.Value) -> ir.Value:
    """A variable that is zero here (its place is made once, at the top of the function)."""
    variable = cgutils.alloca_once(builder, type_)
    builder.store(ir.Constant(type_, value), variable)
    return variable


def _word(value: int) -> ir.Value:
    return ir.Constant(WORD, value)


def _at(builder: ir.IRBuilder, pointer: ir.Value, offset: ir.Value) -> ir.Value:
    return builder.gep(pointer, [offset])


def _broadcast(builder: ir.IRBuilder, x: ir.Value) -> ir.Value:
    place = ir.Constant(ir.IntType(32), 0)
    single = builder.insert_element(ir.Constant(VECTOR, ir.Undefined), x, place)
    everywhere = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES)
    return builder.shuffle_vector(single, ir.Constant(VECTOR, ir.Undefined), everywhere)
