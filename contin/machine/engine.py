"""The one engine of this process that holds machine code: modules, object files, and symbols from outside."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from typing import Any

from contin.abi import Address
from contin.machine import target


class Engine:
    """MCJIT through llvmlite. What is added is linked with what was added before, by symbol, and lives to the end."""

    def __init__(self) -> None:
        self._lock = threading.RLock()
        self._engine: object = None
        self._defined: set[str] = set()

    def define(self, symbol: str, address: Address) -> None:
        """Make a function outside known by name."""
        import llvmlite.binding as llvm

        with self._lock:
            self._ready()
            llvm.add_symbol(symbol, address)
            self._defined.add(symbol)

    def add_text(self, text: str, *, optimise: bool) -> None:
        """Compile a module of LLVM assembly for this process's target."""
        import llvmlite.binding as llvm

        with self._lock:
            engine = self._ready()
            module = llvm.parse_assembly(text)
            if optimise:
                options = llvm.create_pipeline_tuning_options(speed_level=2)
                passes = llvm.create_pass_builder(target.machine(2), options)
                passes.getModulePassManager().run(module, passes)
            engine.add_module(module)
            engine.finalize_object()

    def add_objects(self, objects: Sequence[bytes]) -> None:
        """Load object files. Each may need symbols of any other, or of what is there already, and of nothing else."""
        import llvmlite.binding as llvm

        with self._lock:
            engine = self._ready()
            for data in objects:
                engine.add_object_file(llvm.ObjectFileRef.from_data(data))
            engine.finalize_object()

    def address(self, symbol: str) -> Address:
        """Where a symbol's code is."""
        with self._lock:
            found = int(self._ready().get_function_address(symbol))
        if not found:
            raise KeyError(symbol)
        return found

    def _ready(self) -> Any:
        if self._engine is None:
            import llvmlite.binding as llvm

            llvm.initialize_native_target()
            llvm.initialize_native_asmprinter()
            self._engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), target.machine(2))
        return self._engine


ENGINE = Engine()
