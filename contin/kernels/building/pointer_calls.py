"""Calls of the machine code at an address, with the data pointers of float64 arrays: numba intrinsics."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic


def _emit(context: Any, builder: Any, signature: Any, args: Any) -> Any:
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
def call3(typing_context: Any, address: Any, a: Any, b: Any, c: Any) -> Any:
    """Call `void f(double*, double*, double*)` at `address`."""
    return types.void(types.intp, a, b, c), _emit


@intrinsic
def call4(typing_context: Any, address: Any, a: Any, b: Any, c: Any, d: Any) -> Any:
    """Call `void f(double*, double*, double*, double*)` at `address`."""
    return types.void(types.intp, a, b, c, d), _emit


@intrinsic
def call5(typing_context: Any, address: Any, a: Any, b: Any, c: Any, d: Any, e: Any) -> Any:
    """Call `void f(double*, ...)` with five pointers at `address`."""
    return types.void(types.intp, a, b, c, d, e), _emit


@intrinsic
def call6(typing_context: Any, address: Any, a: Any, b: Any, c: Any, d: Any, e: Any, f: Any) -> Any:
    """Call `void f(double*, ...)` with six pointers at `address`."""
    return types.void(types.intp, a, b, c, d, e, f), _emit
