"""Kernels as numba sees them inside other kernels: functions known by their signature, called by symbol.

numba's own dispatchers compile what they call first, and link its optimised body into every caller, where LLVM
optimises it again; a tower of kernels is then compiled as many times as it has storeys. A `KernelFunction` is a
declaration: the call is an external symbol, which the loader resolves.
"""

from __future__ import annotations

import inspect
from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

from numba import njit, types
from numba.core import typing
from numba.core.datamodel import models
from numba.core.extending import register_model
from numba.core.funcdesc import FunctionDescriptor
from numba.core.imputils import lower_constant
from numba.core.typing.typeof import typeof_impl

from contin.kernels.building import lanes, pointer_calls, vectors
from contin.kernels.building.types import numba_type
from contin.kernels.mode import Declaration
from contin.kernels.signature import Signature, parse

if TYPE_CHECKING:
    from llvmlite import ir
    from numba.core.base import BaseContext
    from numba.core.typing import Signature as NumbaSignature

REGISTRY: dict[str, KernelFunction] = {}


class KernelFunction:
    """A declared kernel in a process that compiles."""

    def __init__(self, declaration: Declaration) -> None:
        self.declaration = declaration
        self.type = KernelType(self)
        self._registered = False
        REGISTRY[declaration.name] = self

    @cached_property
    def signature(self) -> Signature:
        return parse(self.declaration.signature)

    @cached_property
    def numba_signature(self) -> NumbaSignature:
        stated = self.signature
        return typing.signature(numba_type(stated.result), *(numba_type(a) for a in stated.arguments))

    def register(self, context: BaseContext) -> None:
        """Tell numba how to call it."""
        if self._registered:
            return
        function, signature = self.declaration.function, self.numba_signature
        names = tuple(inspect.signature(function).parameters)
        if len(names) != len(signature.args):
            raise TypeError(f"{self.declaration.name} has {len(names)} arguments and {len(signature.args)} types")
        descriptor = FunctionDescriptor(
            native=True, modname=function.__module__, qualname=function.__qualname__, unique_name=function.__name__,
            doc="", typemap={}, restype=signature.return_type, calltypes={}, args=names, kws=(),
            mangler=lambda *_, **__: symbol(self.declaration.name), argtypes=signature.args,
        )  # fmt: skip
        context.insert_user_function(self, descriptor)
        self._registered = True


def symbol(name: str) -> str:
    """The symbol of a kernel's machine code in the calling convention that kernels have among themselves."""
    return f"contin.{name}"


class KernelType(types.Callable, types.Opaque):  # type: ignore[misc,unused-ignore]  # numba has no types
    """The type of one declared kernel."""

    def __init__(self, function: KernelFunction) -> None:
        self.function = function
        super().__init__(f"KernelType({function.declaration.name})")

    def get_call_type(self, context: BaseContext, args: Sequence[types.Type], kws: object) -> NumbaSignature:
        from numba.core.registry import cpu_target

        self.function.register(cpu_target.target_context)
        stated = self.function.numba_signature
        given = tuple(types.unliteral(a) for a in args)
        if len(given) != len(stated.args) or not all(map(_fits, given, stated.args)):
            name = self.function.declaration.name
            raise TypeError(f"{name} is declared as {self.function.declaration.signature!r} and called with {given}")
        return stated

    def get_call_signatures(self) -> tuple[tuple[NumbaSignature], bool]:
        return (self.function.numba_signature,), False

    def get_impl_key(self, signature: NumbaSignature) -> object:
        return self.function


def _fits(given: types.Type, stated: types.Type) -> bool:
    """Whether numba may hand over the one for the other: the same type, or a number for a number."""
    return bool(given == stated or (isinstance(given, types.Number) and isinstance(stated, types.Number)))


register_model(KernelType)(models.OpaqueModel)


@typeof_impl.register(KernelFunction)
def _type_of(value: KernelFunction, context: object) -> KernelType:
    return value.type


@lower_constant(KernelType)
def _constant(context: BaseContext, builder: ir.IRBuilder, kind: types.Type, value: object) -> ir.Value:
    return context.get_dummy_value()


class NumbaCompiler:
    """What the decorators of `contin.kernels.compile` become in a process that compiles."""

    def kernel(self, declaration: Declaration) -> KernelFunction:
        return KernelFunction(declaration)

    def part(self, function: Any) -> Any:
        return njit(inline="always", error_model="numpy")(function)

    def intrinsic(self, name: str) -> Any:
        home = next(module for module in (vectors, lanes, pointer_calls) if hasattr(module, name))
        return getattr(home, name)
