"""LLVM assembly text to machine code in this process, through llvmlite's MCJIT."""

from __future__ import annotations

import ctypes
import ctypes.util
import sys
import threading
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, Final

from contin.abi import Address
from contin.lowering.llvm_text import UNSPLIT, Routine, declarations, elementary_functions, routine_text
from contin.lowering.objects_by_text import object_of
from contin.machine import elementary, target

if TYPE_CHECKING:
    from types import ModuleType

HUGE: Final = 25_000  # statements; more are compiled without optimisation

RUNTIME: Final = ("memset", "malloc", "free")

_lock = threading.Lock()
_ready = False


@dataclass(frozen=True)
class MachineCode:
    """Addresses of compiled routines, and the engine that owns the code: addresses die with this object."""

    engine: Any
    addresses: dict[str, Address]
    statements: dict[str, int]
    """Length of each routine, the measure of its cost."""


def compile_routines(routines: Sequence[Routine]) -> MachineCode:
    """Machine code of all routines, as one module. The longer it is, the less optimised (see `_level`)."""
    import llvmlite.binding as llvm

    called = sorted(set().union(*(elementary_functions(routine.statements) for routine in routines)))
    text = declarations(llvm.llvm_version_info[0], called) + "".join(routine_text(routine) for routine in routines)
    elementary.addresses(called)
    with _lock:
        _prepare(llvm)
        engine = _loaded(llvm, text, _level(routines))
        addresses = {r.name: int(engine.get_function_address(r.name)) for r in routines}
    return MachineCode(engine, addresses, {r.name: len(r.statements) for r in routines})


def _level(routines: Sequence[Routine]) -> int:
    """Of the code generator: 2 for short bodies; 1 for long ones; 0 for huge ones.

    At level 1 LLVM takes about 60 us a statement, at level 0 12 us for code half as fast.
    """
    longest = max((len(routine.statements) for routine in routines), default=0)
    if longest <= UNSPLIT:
        return 2
    return 1 if longest <= HUGE else 0


_LOOP = """
define void @many(ptr %f, i64 %count, ptr %u, i64 %du, ptr %p, i64 %dp, ptr %out, i64 %dout) {
entry:
  br label %next
next:
  %i = phi i64 [ 0, %entry ], [ %j, %next ]
  %iu = mul i64 %i, %du
  %ip = mul i64 %i, %dp
  %io = mul i64 %i, %dout
  %pu = getelementptr double, ptr %u, i64 %iu
  %pp = getelementptr double, ptr %p, i64 %ip
  %po = getelementptr double, ptr %out, i64 %io
  call void %f(ptr %pu, ptr %pp, ptr %po)
  %j = add i64 %i, 1
  %more = icmp slt i64 %j, %count
  br i1 %more, label %next, label %done
done:
  ret void
}
"""


MOST_POINTERS: Final = 8


def _loop_of(pointers: int) -> str:
    """(f, count, places): f(places[0] + i places[1], places[2] + i places[3], ..) for i < count, in bytes."""
    numbers = range(pointers)
    arguments = ", ".join(f"ptr %q{k}" for k in numbers)
    loads = [
        f"""  %a{k} = getelementptr i64, ptr %places, i64 {2 * k}
  %p{k} = load ptr, ptr %a{k}
  %b{k} = getelementptr i64, ptr %places, i64 {2 * k + 1}
  %s{k} = load i64, ptr %b{k}"""
        for k in numbers
    ]
    moved = [f"  %o{k} = mul i64 %i, %s{k}\n  %q{k} = getelementptr i8, ptr %p{k}, i64 %o{k}" for k in numbers]
    return "\n".join([
        f"define void @each{pointers}(ptr %f, i64 %count, ptr %places) {{", "entry:", *loads, "  br label %next",
        "next:", "  %i = phi i64 [ 0, %entry ], [ %j, %next ]", *moved, f"  call void %f({arguments})",
        "  %j = add i64 %i, 1", "  %more = icmp slt i64 %j, %count", "  br i1 %more, label %next, label %done",
        "done:", "  ret void", "}", "",
    ])  # fmt: skip


_loop: list[tuple[Any, dict[int, Address]]] = []  # the engine, for as long as this process lives, and addresses in it


def loop_address(pointers: int = 0) -> Address:
    """(f, count, u, du, p, dp, out, dout): f(u + i du, p + i dp, out + i dout) for i < count; count >= 1.

    With `pointers`, 4 to `MOST_POINTERS`: (f, count, places), see `_loop_of`.
    """
    if not _loop:
        import llvmlite.binding as llvm

        with _lock:
            if not _loop:  # two threads may ask at once: code made twice would be freed under the feet of one of them
                _prepare(llvm)
                several = range(4, MOST_POINTERS + 1)
                engine = _loaded(llvm, _LOOP + "".join(_loop_of(k) for k in several), 2)
                names = {0: "many", **{k: f"each{k}" for k in several}}
                _loop.append((engine, {k: int(engine.get_function_address(name)) for k, name in names.items()}))
    return _loop[0][1][pointers]


def _loaded(llvm: ModuleType, text: str, level: int) -> Any:
    """An engine that holds the machine code of a module."""
    code = object_of(text, level, lambda: _compiled(llvm, text, level))
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), target.machine(level))
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    return engine


def _compiled(llvm: ModuleType, text: str, level: int) -> bytes:
    """An object file, from the code generator alone.

    LLVM's optimiser finds nothing in a tape: the same bits and times a call with and without it, a third of the time
    of compiling, and it keeps some memory of everything it ever ran on (0.3 MB for 1,000 instructions).
    """
    machine, module = _code_generator(level), llvm.parse_assembly(text)
    module.triple = machine.triple
    return bytes(machine.emit_object(module))


@cache
def _code_generator(level: int) -> Any:
    """Kept: one that is made for every module sets up its tables again, a third of the time of a short module."""
    return target.object_machine(level=level)


def _prepare(llvm: ModuleType) -> None:
    """Targets, and the C library's functions by address where the process does not export them by name (Windows)."""
    global _ready
    if _ready:
        return
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    library: ctypes.CDLL | None = None
    for name in RUNTIME:
        if llvm.address_of_symbol(name) is not None:
            continue
        if library is None:
            library = _c_library()
        if hasattr(library, name):
            llvm.add_symbol(name, ctypes.cast(getattr(library, name), ctypes.c_void_p).value)
    _ready = True


def _c_library() -> ctypes.CDLL:
    if sys.platform == "win32":
        return ctypes.CDLL("ucrtbase")
    return ctypes.CDLL(ctypes.util.find_library("c"))
