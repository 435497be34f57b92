"""Machine code of the elementary functions: made when first asked for, kept in the user's folder as that of kernels."""

from __future__ import annotations

import hashlib
import threading
from collections.abc import Callable, Iterable
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

from contin.machine import objects, target
from contin.machine.elementary.names import FUNCTIONS, symbol
from contin.machine.folder import folder
from contin.machine.objects import Piece

_lock = threading.Lock()
_addresses: dict[str, int] = {}
_engines: list[Any] = []  # own the code, for as long as this process lives


def llvm_text(names: Iterable[str] = tuple(FUNCTIONS)) -> str:
    """LLVM text of a module that defines `contin_NAME` for each name and needs no symbol from outside."""
    from contin.machine.elementary.translate import module_text  # not before: most processes need no translation

    return module_text([source(name) for name in names])


def addresses(names: Iterable[str] = tuple(FUNCTIONS)) -> dict[str, int]:
    """Address of each function in this process, valid until its end, by its symbol `contin_NAME`.

    From then on LLVM finds the symbol by name too, in all code that it links in this process.
    """
    return {symbol(name): _address(name, symbol(name)) for name in names}


def loop_address(name: str) -> int:
    """Address of contin_NAME_many(n, x, out), or (n, x, y, out): the function over arrays."""
    return _address(name, f"{symbol(name)}_many")


def _address(name: str, wanted: str) -> int:
    if wanted not in _addresses:
        with _lock:
            if wanted not in _addresses:
                _compile(name, wanted)
    return _addresses[wanted]


def _compile(name: str, wanted: str) -> None:
    """Load a function's code from the user's folder, or make it and put it there."""
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    machine = target.machine(2)
    kept, file = folder(), f"{wanted}-{_key()}"
    data = kept.read(file) if kept else None
    piece = objects.from_bytes(data) if data is not None else None
    if piece is None or (piece.name, piece.key) != (wanted, _key()):
        piece = Piece(wanted, _key(), (), _object_code(name, wanted, machine))
        if kept:
            kept.write(file, objects.to_bytes(piece))
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)
    engine.add_object_file(llvm.ObjectFileRef.from_data(piece.code))
    engine.finalize_object()
    _engines.append(engine)
    _addresses[wanted] = int(engine.get_function_address(wanted))
    if wanted == symbol(name):
        llvm.add_symbol(wanted, _addresses[wanted])


def _object_code(name: str, wanted: str, machine: Any) -> bytes:
    import llvmlite.binding as llvm

    from contin.machine.elementary.translate import module_text  # not before: most processes need no translation

    function = source(name)
    looped = wanted != symbol(name)
    module = llvm.parse_assembly(module_text([] if looped else [function], [function] if looped else []))
    builder = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=2))
    builder.getModulePassManager().run(module, builder)
    return bytes(machine.emit_object(module))


@cache
def _key() -> str:
    """Hash of all that machine code is made from: these sources, LLVM, the processor level and the system."""
    import llvmlite

    found = hashlib.sha256(f"{llvmlite.__version__} {target.label()}".encode())
    for path in sorted(Path(__file__).parent.glob("*.py")):
        found.update(path.name.encode() + path.read_bytes())
    return found.hexdigest()[:32]


def source(name: str) -> Callable[..., Any]:
    """The function as it is written in Python."""
    if name not in FUNCTIONS:
        raise KeyError(f"no elementary function {name!r}; there are {', '.join(FUNCTIONS)}")
    found: Callable[..., Any] = getattr(import_module(f"{__package__}.{FUNCTIONS[name]}"), name)
    return found
