"""How products of many small matrices at once (`contin.kernels.lanes`) become machine vectors: numba intrinsics.

A plain loop over the lanes of one product reads three numbers and writes one for each multiplication. Here a tile of
the result stays in registers while all products are subtracted from it: about one access each, two to four times
faster. The order of the operations on a number is that of the plain loops, and so are its digits.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Final, TypeAlias

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.types import Type
from numba.core.typing import Signature
from numba.extending import intrinsic

if TYPE_CHECKING:
    from numba.core.base import BaseContext

Intrinsic: TypeAlias = tuple[Signature, Callable[..., ir.Value]]  # what it is of these types, and what emits it

WIDTHS: Final = (4, 2, 1)  # lanes in a vector
TILES: Final = ((4, (2, 1)), (2, (4, 1)), (1, (4, 1)))  # rows of a tile, and its columns; with what it reads, registers
FUSED: Final = ("contract",)
WORD, NUMBER = ir.IntType(64), ir.DoubleType()


@intrinsic
def address(typing_context: BaseContext, array: Type, at: Type) -> Intrinsic:
    """Address of the element with this index in the flat, contiguous array."""
    return types.intp(array, types.intp), _address


def _address(context: BaseContext, builder: ir.IRBuilder, signature: Signature, args: Sequence[ir.Value]) -> ir.Value:
    data = cgutils.create_struct_proxy(signature.args[0])(context, builder, args[0]).data
    return builder.ptrtoint(builder.gep(data, [args[1]]), WORD)


@intrinsic
def subtract_lanes(
    typing_context: BaseContext, c: Type, c_step: Type, rows: Type, columns: Type, f: Type, f_step: Type, p: Type,
    p_step: Type, depth: Type, far: Type, lanes: Type,
) -> Intrinsic:  # fmt: skip
    """See `contin.kernels.lanes.subtract_products`."""
    return types.void(*[types.intp] * 11), _subtract


def _subtract(context: BaseContext, builder: ir.IRBuilder, signature: Signature, args: Sequence[ir.Value]) -> ir.Value:
    c, c_step, rows, columns, f, f_step, p, p_step, depth, far, lanes = args
    target, left, right = (builder.inttoptr(place, NUMBER.as_pointer()) for place in (c, f, p))

    def tile(row: ir.Value, height: int, column: ir.Value, width: int) -> None:
        rows_of = [builder.add(row, _word(k)) for k in range(height)]
        columns_of = [builder.mul(builder.add(column, _word(k)), far) for k in range(width)]
        lefts = [_at(builder, left, builder.mul(r, f_step)) for r in rows_of]
        rights = [_at(builder, right, x) for x in columns_of]
        targets = [
            [_at(builder, target, builder.add(builder.mul(r, c_step), x)) for x in columns_of] for r in rows_of
        ]  # fmt: skip
        _in_groups(
            builder, lanes, WIDTHS,
            lambda lane, count: _sums(builder, count, lane, targets, lefts, rights, depth, far, p_step),
        )  # fmt: skip

    with builder.if_then(builder.icmp_signed(">", depth, _word(0))):
        done = _word(0)
        for height, widths in TILES:
            groups = builder.udiv(builder.sub(rows, done), _word(height))
            with cgutils.for_range(builder, groups) as loop:
                row = builder.add(done, builder.mul(loop.index, _word(height)))
                _in_groups(builder, columns, widths, partial(tile, row, height))
            done = builder.add(done, builder.mul(groups, _word(height)))
    return context.get_dummy_value()


@intrinsic
def forward_lanes(
    typing_context: BaseContext, right: Type, rows: Type, count: Type, a: Type, step: Type, far: Type, lanes: Type
) -> Intrinsic:
    """right[r] -= sum of a[r, k] right[k] over k < min(r, count), one row after another, in every lane."""
    return types.void(*[types.intp] * 7), _forward


def _forward(context: BaseContext, builder: ir.IRBuilder, signature: Signature, args: Sequence[ir.Value]) -> ir.Value:
    right, rows, count, a, step, far, lanes = args
    vector, matrix = (builder.inttoptr(place, NUMBER.as_pointer()) for place in (right, a))

    def solved(lane: ir.Value, width: int) -> None:
        with cgutils.for_range(builder, rows) as loop:
            r = loop.index
            depth = builder.select(builder.icmp_signed("<", r, count), r, count)
            target = [[_at(builder, vector, builder.mul(r, far))]]
            left = [_at(builder, matrix, builder.mul(r, step))]
            with builder.if_then(builder.icmp_signed(">", depth, _word(0))):
                _sums(builder, width, lane, target, left, [vector], depth, far, far)

    _in_groups(builder, lanes, WIDTHS, solved)
    return context.get_dummy_value()


@intrinsic
def backward_lanes(
    typing_context: BaseContext, right: Type, count: Type, a: Type, step: Type, known: Type, given: Type, far: Type,
    lanes: Type,
) -> Intrinsic:  # fmt: skip
    """right[k] = (right[k] - sum of a[k, c] x[c] over c > k) / a[k, k] from the last row to the first, in every lane.

    x : right[:count], then the `given` rows of known.
    """
    return types.void(*[types.intp] * 8), _backward


def _backward(context: BaseContext, builder: ir.IRBuilder, signature: Signature, args: Sequence[ir.Value]) -> ir.Value:
    right, count, a, step, known, given, far, lanes = args
    vector, matrix, beside = (builder.inttoptr(place, NUMBER.as_pointer()) for place in (right, a, known))
    one = _word(1)

    def solved(lane: ir.Value, width: int) -> None:
        kind = NUMBER if width == 1 else ir.VectorType(NUMBER, width)
        with cgutils.for_range(builder, count) as loop:
            k = builder.sub(builder.sub(count, one), loop.index)
            place, row = _at(builder, vector, builder.mul(k, far)), _at(builder, matrix, builder.mul(k, step))
            with builder.if_then(builder.icmp_signed(">", given, _word(0))):
                left = [_at(builder, row, builder.mul(count, far))]
                _sums(builder, width, lane, [[place]], left, [beside], given, far, far)
            after = builder.mul(builder.add(k, one), far)
            with builder.if_then(builder.icmp_signed(">", loop.index, _word(0))):
                left, below = [_at(builder, row, after)], [_at(builder, vector, after)]
                _sums(builder, width, lane, [[place]], left, below, loop.index, far, far)
            target = builder.bitcast(_at(builder, place, lane), kind.as_pointer())
            pivot = builder.bitcast(_at(builder, row, builder.add(builder.mul(k, far), lane)), kind.as_pointer())
            builder.store(builder.fdiv(builder.load(target, align=8), builder.load(pivot, align=8)), target, align=8)

    _in_groups(builder, lanes, WIDTHS, solved)
    return context.get_dummy_value()


def _sums(
    builder: ir.IRBuilder, count: int, lane: ir.Value, targets: list[list[ir.Value]], lefts: list[ir.Value],
    rights: list[ir.Value], depth: ir.Value, far: ir.Value, p_step: ir.Value,
) -> None:  # fmt: skip
    """A tile of `count` lanes from `lane` on, from all products."""
    kind = NUMBER if count == 1 else ir.VectorType(NUMBER, count)

    def number(place: ir.Value, offset: ir.Value) -> ir.Value:
        return builder.bitcast(_at(builder, place, offset), kind.as_pointer())

    places = [[number(place, lane) for place in row] for row in targets]
    before = [[builder.load(place, align=8) for place in row] for row in places]
    entry, body, end = builder.block, builder.append_basic_block("products"), builder.append_basic_block("stored")
    builder.branch(body)
    builder.position_at_end(body)
    k = builder.phi(WORD)
    k.add_incoming(_word(0), entry)
    sums = [[builder.phi(kind) for _ in row] for row in before]
    columns, row = builder.add(lane, builder.mul(k, far)), builder.add(lane, builder.mul(k, p_step))
    factors = [builder.load(number(place, row), align=8) for place in rights]
    after = []
    for place, totals in zip(lefts, sums, strict=True):
        x = builder.load(number(place, columns), align=8)
        products = [builder.fmul(x, factor, flags=FUSED) for factor in factors]
        after.append([builder.fsub(t, y, flags=FUSED) for t, y in zip(totals, products, strict=True)])
    following = builder.add(k, _word(1))
    k.add_incoming(following, body)
    for totals, first, last in zip(sums, before, after, strict=True):
        for total, x, y in zip(totals, first, last, strict=True):
            total.add_incoming(x, entry)
            total.add_incoming(y, body)
    builder.cbranch(builder.icmp_signed("<", following, depth), body, end)
    builder.position_at_end(end)
    for values, row_places in zip(after, places, strict=True):
        for value, place in zip(values, row_places, strict=True):
            builder.store(value, place, align=8)


def _in_groups(
    builder: ir.IRBuilder, total: ir.Value, sizes: Sequence[int], together: Callable[[ir.Value, int], None]
) -> None:
    """`together(first, size)` for all of `total`: in groups of the first size, what is left in those of the next."""
    done = _word(0)
    for size in sizes:
        groups = builder.udiv(builder.sub(total, done), _word(size))
        with cgutils.for_range(builder, groups) as loop:
            together(builder.add(done, builder.mul(loop.index, _word(size))), size)
        done = builder.add(done, builder.mul(groups, _word(size)))


def _word(value: int) -> ir.Value:
    return ir.Constant(WORD, value)


def _at(builder: ir.IRBuilder, pointer: ir.Value, offset: ir.Value) -> ir.Value:
    return builder.gep(pointer, [offset])
