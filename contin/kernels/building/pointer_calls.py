"""Calls of the machine code at an address, with the data pointers of float64 arrays: numba intrinsics."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, TypeAlias

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.types import Type
from numba.core.typing import Signature
from numba.extending import intrinsic

if TYPE_CHECKING:
    from numba.core.base import BaseContext

Intrinsic: TypeAlias = tuple[Signature, Callable[..., ir.Value]]  # what it is of these types, and what emits it


def _emit(context: BaseContext, builder: ir.IRBuilder, signature: Signature, args: Sequence[ir.Value]) -> ir.Value:
    byte_pointer = ir.IntType(8).as_pointer()
    function_type = ir.FunctionType(ir.VoidType(), [byte_pointer] * (len(args) - 1))
    function = builder.inttoptr(args[0], function_type.as_pointer())
    pointers = []
    for array_type, array in zip(signature.args[1:], args[1:], strict=True):
        data = cgutils.create_struct_proxy(array_type)(context, builder, array).data
        pointers.append(builder.bitcast(data, byte_pointer))
    builder.call(function, pointers)
    return context.get_dummy_value()


@intrinsic
def call3(typing_context: BaseContext, address: Type, a: Type, b: Type, c: Type) -> Intrinsic:
    """Call `void f(double*, double*, double*)` at `address`."""
    return types.void(types.intp, a, b, c), _emit


@intrinsic
def call4(typing_context: BaseContext, address: Type, a: Type, b: Type, c: Type, d: Type) -> Intrinsic:
    """Call `void f(double*, double*, double*, double*)` at `address`."""
    return types.void(types.intp, a, b, c, d), _emit


@intrinsic
def call5(typing_context: BaseContext, address: Type, a: Type, b: Type, c: Type, d: Type, e: Type) -> Intrinsic:
    """Call `void f(double*, ...)` with five pointers at `address`."""
    return types.void(types.intp, a, b, c, d, e), _emit


@intrinsic
def call6(
    typing_context: BaseContext, address: Type, a: Type, b: Type, c: Type, d: Type, e: Type, f: Type
) -> Intrinsic:
    """Call `void f(double*, ...)` with six pointers at `address`."""
    return types.void(types.intp, a, b, c, d, e, f), _emit
