"""Whether this process compiles kernels (numba is at work) or calls them (it is not even imported)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol


@dataclass(frozen=True)
class Declaration:
    """A kernel as its source states it."""

    function: Callable[..., Any]
    signature: str
    vector: bool
    """Sums may be reordered and fused."""
    allocating: bool
    """Makes arrays of its own."""
    inlined: bool
    """LLVM puts its code in place where other kernels call it."""

    @property
    def name(self) -> str:
        """`algebraic.march` for the function `march` in `contin.kernels.algebraic`: the symbol of its machine code."""
        return f"{self.function.__module__.removeprefix('contin.kernels.')}.{self.function.__qualname__}"


class Compiler(Protocol):
    """What the decorators need of a compiler."""

    def kernel(self, declaration: Declaration) -> Any: ...
    def part(self, function: Callable[..., Any]) -> Any: ...
    def intrinsic(self, name: str) -> Any: ...


compiler: Compiler | None = None  # set by `contin.kernels.building` before it imports any kernel
