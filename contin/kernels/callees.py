"""What a kernel calls, read from its Python code: kernels of their own, and parts that are put in place in it."""

from __future__ import annotations

from types import CodeType, FunctionType
from typing import TypeGuard

from contin.kernels import sources
from contin.kernels.mode import Declaration


def called_by(declaration: Declaration) -> dict[str, Declaration]:
    """The kernel and all that it calls, directly or not, by name."""
    found: dict[str, Declaration] = {}
    todo = [declaration]
    while todo:
        one = todo.pop()
        if one.name not in found:
            found[one.name] = one
            todo += _direct(one.function.__code__, one.function.__globals__)
    return found


def _direct(code: CodeType, names: dict[str, object]) -> list[Declaration]:
    """Kernels that a function's text names, and those that the parts do which are put in place in it."""
    found = []
    for value in (names.get(name) for name in code.co_names):
        kernel = declared(value)
        if kernel is not None:
            found.append(kernel)
        elif _is_part(value):
            found += _direct(value.__code__, value.__globals__)
    return found


def text_length(declaration: Declaration) -> int:
    """Bytes of Python code of a kernel, parts that are put in place included: it measures how long it takes to make."""

    def length(code: CodeType, names: dict[str, object]) -> int:
        parts = (names.get(name) for name in code.co_names)
        inner = [p for p in parts if declared(p) is None and _is_part(p)]
        return len(code.co_code) + sum(length(p.__code__, p.__globals__) for p in inner)

    return length(declaration.function.__code__, declaration.function.__globals__)


def declared(value: object) -> Declaration | None:
    """What a kernel (`contin.kernels.compile.Kernel`) was declared as; None of anything else."""
    found = getattr(value, "declaration", None)
    return found if isinstance(found, Declaration) else None


def _is_part(value: object) -> TypeGuard[FunctionType]:
    module = getattr(value, "__module__", None)
    return isinstance(module, str) and module.startswith(sources.BASE) and hasattr(value, "__code__")
