"""Machine code of the elementary functions: compiled when first asked for, each one once per process."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable
from importlib import import_module
from typing import Any

from contin.machine import target
from contin.machine.elementary.names import FUNCTIONS, symbol

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
    import llvmlite.binding as llvm

    from contin.machine.elementary.translate import module_text

    function = source(name)
    looped = wanted != symbol(name)
    text = module_text([] if looped else [function], [function] if looped else [])
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    machine = target.machine(2)
    module = llvm.parse_assembly(text)
    builder = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=2))
    builder.getModulePassManager().run(module, builder)
    engine = llvm.create_mcjit_compiler(module, machine)
    engine.finalize_object()
    _engines.append(engine)
    _addresses[wanted] = int(engine.get_function_address(wanted))
    if not looped:
        llvm.add_symbol(wanted, _addresses[wanted])


def source(name: str) -> Callable[..., Any]:
    """The function as it is written in Python."""
    if name not in FUNCTIONS:
        raise KeyError(f"no elementary function {name!r}; there are {', '.join(FUNCTIONS)}")
    found: Callable[..., Any] = getattr(import_module(f"{__package__}.{FUNCTIONS[name]}"), name)
    return found
