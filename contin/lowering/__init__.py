"""Expressions to machine code: graph -> LLVM IR -> function pointers."""

from contin.lowering.system import CompiledSystem, compile_system

__all__ = ["CompiledSystem", "Equations", "compile_system"]
