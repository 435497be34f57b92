"""Expressions to machine code: graph -> LLVM IR -> function pointers."""
