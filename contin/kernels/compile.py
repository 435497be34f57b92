"""How kernels are declared: the decorators, and what a declared kernel is when nothing is being compiled.

In a process that computes, a decorated function becomes a `Kernel`: a name, a signature, and machine code that is
looked for when it is first called (`contin.kernels.library`). numba is not imported. In a process that compiles
(`contin.kernels.building`) the same decorators hand the functions to numba; `contin.kernels.mode` says which it is.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from contin.kernels import mode
from contin.kernels.mode import Declaration
from contin.kernels.signature import describe

Decorator = Callable[[Callable[..., Any]], Any]


class Kernel:
    """Machine code by name. It is found, or made, at the first call; every kernel has exactly one signature."""

    def __init__(self, declaration: Declaration) -> None:
        self.declaration = declaration
        self.__doc__ = declaration.function.__doc__
        self._call: Callable[..., Any] | None = None

    def __call__(self, *arguments: Any) -> Any:
        call = self._call
        if call is None:
            from contin.kernels.library import callable_of  # not before: most commands call no kernel

            call = self._call = callable_of(self.declaration)
        try:
            return call(*arguments)
        except TypeError as error:
            given = ", ".join(describe(value) for value in arguments)
            stated = self.declaration.signature
            raise TypeError(f"{self.declaration.name}({stated}) got {given}") from error

    def __repr__(self) -> str:
        return f"<kernel {self.declaration.name}({self.declaration.signature})>"


def _declare(signature: str, *, vector: bool = False, allocating: bool = False, inlined: bool = False) -> Decorator:
    def decorate(function: Callable[..., Any]) -> Any:
        declaration = Declaration(function, signature, vector, allocating, inlined)
        return Kernel(declaration) if mode.compiler is None else mode.compiler.kernel(declaration)

    return decorate


def kernel(signature: str) -> Decorator:
    """A kernel with this signature (`contin.kernels.signature`), which runs without the interpreter lock.

    Its memory comes from the caller: a kernel makes no arrays. Counting references to them makes machine code, and the
    time to compile it, several times larger; `allocating` is for those that need it.
    """
    return _declare(signature)


def inlined(signature: str) -> Decorator:
    """A small kernel without memory of its own, whose code LLVM puts in place where others call it: no call is made."""
    return _declare(signature, inlined=True)


def allocating(signature: str) -> Decorator:
    """A kernel that makes arrays of its own."""
    return _declare(signature, allocating=True)


def vector_kernel(signature: str) -> Decorator:
    """A kernel whose sums may be reordered and whose products be fused with them: its loops become vector instructions.

    Only for plain linear algebra. Loops over unsigned ranges, `range(np.uint64(a), np.uint64(b))`: for a signed index
    numba tests whether it counts from the end, and with that test no loop is vectorised.
    """
    return _declare(signature, vector=True)


def allocating_vector_kernel(signature: str) -> Decorator:
    """... that makes arrays of its own."""
    return _declare(signature, vector=True, allocating=True)


def part(function: Callable[..., Any]) -> Any:
    """A few lines without types of their own: numba puts them in place, and types them, wherever they are called."""
    return function if mode.compiler is None else mode.compiler.part(function)


def _pointer_call(name: str) -> Any:
    """Calls the machine code at an address with the data pointers of float64 arrays; inside kernels alone."""
    return None if mode.compiler is None else mode.compiler.intrinsic(name)


call3 = _pointer_call("call3")  # void f(double*, double*, double*)
call4 = _pointer_call("call4")
call5 = _pointer_call("call5")
call6 = _pointer_call("call6")
