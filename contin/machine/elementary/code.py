"""Machine code of the elementary functions: compiled when first asked for, each one once per process."""

from __future__ import annotations

import hashlib
import threading
from collections.abc import Callable, Iterable
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

from contin.machine import kept, target
from contin.machine.elementary.names import FUNCTIONS, PREFIX, symbol
from contin.machine.engine import ENGINE
from contin.machine.objects import MachineCode

_lock = threading.Lock()
_addresses: dict[str, int] = {}


def llvm_text(names: Iterable[str] = tuple(FUNCTIONS)) -> str:
    """LLVM text of a module that defines `contin_NAME` for each name and needs no symbol from outside."""
    from contin.machine.elementary.translate import module_text  # not before: most processes need no translation

    return module_text([source(name) for name in names])


def addresses(names: Iterable[str] = tuple(FUNCTIONS)) -> dict[str, int]:
    """Address of each function in this process, valid until its end, by its symbol `contin_NAME`.

    From then on LLVM finds the symbol by name too, in all code that it links in this process.
    """
    return {symbol(name): _address(name, symbol(name)) for name in names}


def is_loaded(name: str) -> bool:
    """Whether the function's machine code is in this process."""
    return symbol(name) in _addresses


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
    """Load the code of one function, or of its loop over arrays: from the wheel, or the user's folder, or made here."""
    import llvmlite
    import llvmlite.binding as llvm

    code_name = f"elementary.{wanted.removeprefix(PREFIX)}"
    made_with = f"{text_key()}\n{llvmlite.__version__}\n{target.label()}"
    file = f"{code_name}-{hashlib.sha256(made_with.encode()).hexdigest()[:24]}"
    found = kept.find(code_name, text_key(), file)
    if found is None:
        found = machine_code(name, target.object_machine(), looped=wanted != symbol(name))
        kept.keep(found, file)
    ENGINE.add_objects([found.code])
    _addresses[wanted] = ENGINE.address(wanted)
    if wanted == symbol(name):
        llvm.add_symbol(wanted, _addresses[wanted])


def machine_code(name: str, machine: Any, *, looped: bool) -> MachineCode:
    """Machine code of a function for one of LLVM's target machines; `looped`: of the function over arrays."""
    import llvmlite.binding as llvm

    from contin.machine.elementary.translate import module_text

    function = source(name)
    module = llvm.parse_assembly(module_text([] if looped else [function], [function] if looped else []))
    module.triple = machine.triple
    passes = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=2))
    passes.getModulePassManager().run(module, passes)
    return MachineCode(f"elementary.{name}{'_many' if looped else ''}", text_key(), (), machine.emit_object(module))


@cache
def text_key() -> str:
    """Hash of the text that all elementary functions are made from."""
    files = sorted(Path(__file__).parent.glob("*.py"))
    return hashlib.sha256(b"".join(file.name.encode() + file.read_bytes() for file in files)).hexdigest()


def source(name: str) -> Callable[..., Any]:
    """The function as it is written in Python."""
    if name not in FUNCTIONS:
        raise KeyError(f"no elementary function {name!r}; there are {', '.join(FUNCTIONS)}")
    found: Callable[..., object] = getattr(import_module(f"{__package__}.{FUNCTIONS[name]}"), name)
    return found
