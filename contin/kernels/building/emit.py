"""One kernel to an object file: numba's passes, our entry, LLVM's optimiser, one target."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, Final

import llvmlite.binding as llvm
from numba.core import compiler
from numba.core.registry import cpu_target

from contin.kernels.building import references
from contin.kernels.building.entry import entry
from contin.kernels.building.functions import REGISTRY, KernelFunction, symbol
from contin.kernels.building.lean import LeanCompiler
from contin.kernels.building.targets import BuildTarget
from contin.kernels.signature import Tuple, Type
from contin.machine.elementary import FUNCTIONS
from contin.machine.elementary import symbol as elementary_symbol

if TYPE_CHECKING:
    from llvmlite.binding import TargetMachine
    from numba.core.codegen import CodeLibrary

FAST: Final = {"contract", "reassoc", "nsz"}
EXACT: Final = ("sqrt", "fabs", "floor", "ceil")  # instructions, not calls


@dataclass(frozen=True)
class Emitted:
    """Machine code of one kernel for one target."""

    name: str
    needs: tuple[str, ...]
    """Symbols of others that it calls."""
    code: bytes


@dataclass(frozen=True)
class Translated:
    """A kernel in LLVM's assembly, before it is optimised for any target."""

    name: str
    text: str


def translate(kernel: KernelFunction, called: bool = True) -> Translated:
    """numba's part: types, passes, lowering. The module calls other kernels by symbol.

    called : with the function by which Python calls it, where it can.
    """
    declaration, signature = kernel.declaration, kernel.numba_signature
    flags = compiler.Flags()
    flags.error_model = "numpy"
    flags.no_compile = flags.no_cpython_wrapper = flags.no_cfunc_wrapper = True
    flags.nrt = declaration.allocating
    if declaration.vector:
        flags.fastmath = FAST
    result = compiler.compile_extra(
        cpu_target.typing_context, cpu_target.target_context, declaration.function, signature.args,
        signature.return_type, flags, {}, pipeline_class=LeanCompiler,
    )  # fmt: skip
    library, descriptor = result.library, result.fndesc
    module = library._final_module
    for linked in _all(library._linking_libraries):
        if linked.name == "nrt":
            module.link_in(llvm.parse_assembly(references.TEXT))
        else:
            module.link_in(linked._final_module, preserve=True)
    for name in _inlined(module, declaration.name):
        module.link_in(_body(name), preserve=True)
    for function in module.functions:
        if not function.is_declaration and function.name != descriptor.llvm_func_name:
            function.linkage = "internal"
    module.get_function(descriptor.llvm_func_name).name = symbol(declaration.name)
    text = _ours(str(module))
    if called and _can_be_called(kernel):
        result = cpu_target.target_context.call_conv.get_return_type(descriptor.restype).pointee
        text += entry(entry_symbol(declaration.name), symbol(declaration.name), kernel.signature, str(result))
    return Translated(declaration.name, text)


def _inlined(module: Any, own: str) -> list[str]:
    """Kernels whose code is put in place of their calls in the module; what they call so themselves is in it."""
    names = [f.name.removeprefix("contin.") for f in module.functions if f.is_declaration]
    return [name for name in names if name != own and name in REGISTRY and REGISTRY[name].declaration.inlined]


def _body(name: str) -> Any:
    """A module with the code of a kernel to be put in place."""
    module = llvm.parse_assembly(translation(name, called=False).text)
    module.get_function(symbol(name)).add_function_attribute("alwaysinline")
    return module


@cache
def translation(name: str, called: bool = True) -> Translated:
    """`translate`, once a process: what is put in place is wanted by several others."""
    return translate(REGISTRY[name], called)


def emit(translated: Translated, target: BuildTarget) -> Emitted:
    """LLVM's part."""
    machine = target.machine()
    module = llvm.parse_assembly(_for(translated.text, target, machine))
    options = llvm.create_pipeline_tuning_options(speed_level=3)
    options.loop_vectorization = True
    passes = llvm.create_pass_builder(machine, options)
    passes.getModulePassManager().run(module, passes)
    needs = tuple(sorted(f.name for f in module.functions if f.is_declaration and not f.name.startswith("llvm.")))
    return Emitted(translated.name, needs, machine.emit_object(module))


def entry_symbol(name: str) -> str:
    """The symbol of the function that takes words (`contin.machine.bridge`)."""
    return f"entry.{name}"


def _all(libraries: Sequence[CodeLibrary]) -> list[CodeLibrary]:
    """Libraries and those that they need, each once."""
    found: list[CodeLibrary] = []
    for library in libraries:
        if library not in found:
            found.append(library)
            found += [inner for inner in _all(list(library._linking_libraries)) if inner not in found]
    return found


def _ours(text: str) -> str:
    """Square roots as instructions, and elementary functions as ours: the C library's differ between machines."""
    for name in EXACT:
        text = re.sub(rf"@{name}(?=\()", f"@llvm.{name}.f64", text)
    for name in FUNCTIONS:
        text = re.sub(rf"@{name}(?=\()|@llvm\.{name}\.f64(?=\()", f"@{elementary_symbol(name)}", text)
    seen: set[str] = set()
    return "\n".join(line for line in text.splitlines() if not _repeats(line, seen)) + "\n"


def _repeats(line: str, seen: set[str]) -> bool:
    """Whether a line declares what another line has declared: a function that had two names before."""
    declared = re.match(r"declare [^@]*@([\w.]+)\(", line)
    if declared is None:
        return False
    known = declared[1] in seen
    seen.add(declared[1])
    return known


def _for(text: str, target: BuildTarget, machine: TargetMachine) -> str:
    """The module for another target than the one that numba wrote it for."""
    text = re.sub(r'target triple = "[^"]*"', f'target triple = "{target.triple}"', text)
    return re.sub(r'target datalayout = "[^"]*"', f'target datalayout = "{machine.target_data}"', text)


def _can_be_called(kernel: KernelFunction) -> bool:
    """Whether Python can make the arguments: there are no arrays of complex numbers among them."""

    def plain(kind: Type) -> bool:
        return all(plain(item) for item in kind.items) if isinstance(kind, Tuple) else kind.code in "iufb"

    return all(plain(kind) for kind in kernel.signature.arguments)
