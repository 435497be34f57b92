"""Machine code of kernels when they are called: from the wheel, else from the user's cache, else made now.

A kernel is loaded together with all kernels that it calls. What is missing is made by processes of their own
(`contin.kernels.building`), as many at once as there are processors, and kept for every other environment with the same
sources and versions; this process never imports numba, so a result does not depend on who compiled what, and when.
"""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from importlib import import_module
from typing import Any, Final

from contin.kernels import sources
from contin.kernels.callees import called_by, declared
from contin.kernels.clock import CLOCK
from contin.kernels.mode import Declaration
from contin.kernels.signature import Array, Scalar, Tuple, Type, parse, words
from contin.machine import bridge, kept, memory, target
from contin.machine.elementary import FUNCTIONS, addresses, symbol
from contin.machine.engine import ENGINE
from contin.machine.folder import folder
from contin.machine.freed import keep_freed
from contin.machine.objects import MachineCode

_CODES: Final = {"i": bridge.INTEGER, "u": bridge.INTEGER, "f": bridge.REAL, "b": bridge.TRUTH}
_DTYPES: Final = {"i": "int64", "u": "uint64", "f": "float64", "b": "bool"}

_FOLLOWED: Final = ("defining", "rest_of_step.is_clear", "rows_in_doubt", "steering.is_dip")
NEXT: Final = {
    "grading": ("algebraic", *_FOLLOWED), "eigen": ("algebraic", *_FOLLOWED), "algebraic": _FOLLOWED,
}  # fmt: skip
"""Modules, or kernels, that are needed soon after others: whoever asks for an equilibrium's eigenvalues follows it
next, and meets special points. Processes that make kernels take a second to begin. Of these modules, kernels that are
put in place where others call them are not made by themselves: few are called from Python, and those are named."""

_lock = threading.RLock()
_loaded: set[str] = set()
_ready = False


def callable_of(declaration: Declaration) -> Callable[..., Any]:
    """A function that runs the kernel."""
    with CLOCK.standing(), _lock:
        if declaration.name not in _loaded:
            _load(declaration)
    signature = parse(declaration.signature)
    arguments = bridge.codes_of([_codes(kind) for kind in signature.arguments])
    results = signature.result.items if isinstance(signature.result, Tuple) else (signature.result,)
    codes = tuple(_CODES[kind.code] for kind in results if isinstance(kind, Scalar))
    plan = bridge.Plan(arguments, sum(words(kind) for kind in signature.arguments), codes)
    return bridge.make_call(declaration.name, ENGINE.address(f"entry.{declaration.name}"), plan)


def _load(declaration: Declaration) -> None:
    wanted = {d.name: d for d in _called_by_symbol(declaration) if d.name not in _loaded}
    machine_codes = {n: p for n, d in wanted.items() if (p := known(d)) is not None}
    missing = {n: d for n, d in wanted.items() if n not in machine_codes}
    if missing:
        together = {d.name: d for d in _companions(declaration)} | missing  # needed soon, and begun once is cheaper
        made = provide({n: d for n, d in together.items() if n not in _loaded})
        machine_codes |= {machine_code.name: machine_code for machine_code in made if machine_code.name in wanted}
    global _ready
    if not _ready:
        ENGINE.add_text(memory.TEXT, optimise=False)
        keep_freed()
        _ready = True
    _define(machine_codes.values())
    ENGINE.add_objects([machine_codes[name].code for name in sorted(machine_codes)])
    _loaded.update(machine_codes)


def _called_by_symbol(declaration: Declaration) -> Iterable[Declaration]:
    """The kernel and all that it needs: the code of those that are put in place is in their callers'."""
    return (d for d in called_by(declaration).values() if d is declaration or not d.inlined)


def _companions(declaration: Declaration) -> Iterable[Declaration]:
    """The other kernels of its module and of those that are needed next, with all that they need."""
    own = declaration.function.__module__
    for other in _declared_in(own):
        yield from _called_by_symbol(other)
    for name in NEXT.get(module_of(declaration), ()):
        module, _, single = name.partition(".")
        for other in _declared_in(import_module(sources.BASE + module).__name__):
            if other.name == name if single else not other.inlined:
                yield from _called_by_symbol(other)


def _declared_in(module: str) -> Iterator[Declaration]:
    """The kernels of a module that is imported."""
    for value in vars(sys.modules[module]).values():
        found = declared(value)
        if found is not None and found.function.__module__ == module:
            yield found


def module_of(declaration: Declaration) -> str:
    """`piecewise.flight`"""
    return declaration.function.__module__.removeprefix(sources.BASE)


def file_name(declaration: Declaration) -> str:
    """The name of its file in the user's cache: what it was made from is part of it."""
    return f"{declaration.name}-{sources.key(module_of(declaration), target.name())}"


def known(declaration: Declaration) -> MachineCode | None:
    """Its machine code, if the wheel or the cache has it."""
    return kept.find(declaration.name, sources.text_key(module_of(declaration)), file_name(declaration))


def complete(wanted: dict[str, Declaration]) -> list[tuple[MachineCode, ...]]:
    """Machine code of all these kernels, for this process's target; what is missing is made."""
    have = {n: p for n, d in wanted.items() if (p := known(d)) is not None}
    made = provide({n: d for n, d in wanted.items() if n not in have})
    return [(machine_code,) for machine_code in (*have.values(), *made)]


def provide(wanted: dict[str, Declaration]) -> Sequence[MachineCode]:
    """Machine code of these kernels, those that another process finishes meanwhile included."""
    from contin.kernels.pool import make  # not before: it starts processes

    place = folder()
    if place is None:
        return [machine_code for (machine_code,) in make(list(wanted.values()))]
    others = []
    with place.building(lambda: all(known(d) is not None for d in wanted.values())):
        for name, declaration in list(wanted.items()):
            machine_code = known(declaration)
            if machine_code is not None:
                others.append(machine_code)
                del wanted[name]
        names = {d.name: file_name(d) for d in wanted.values()}
        made = make(
            list(wanted.values()), lambda machine_codes: kept.keep(machine_codes[0], names[machine_codes[0].name])
        )
    return [*others, *(machine_code for (machine_code,) in made)]


def _define(machine_codes: Collection[MachineCode]) -> None:
    """Elementary functions that they need. LLVM ends the process where a symbol is missing: none may be."""
    have = {f"contin.{name}" for name in _loaded} | {f"contin.{p.name}" for p in machine_codes} | OUTSIDE
    needed = {
        symbol: machine_code.name
        for machine_code in machine_codes
        for symbol in machine_code.needs
        if symbol not in have
    }
    ours = {symbol(name): name for name in FUNCTIONS}
    for wanted, name in needed.items():
        if wanted not in ours:
            raise RuntimeError(f"{name} needs {wanted}, which nothing defines")
    for defined, address in addresses([ours[wanted] for wanted in needed]).items():
        ENGINE.define(defined, address)


OUTSIDE: Final = frozenset({"NRT_MemInfo_alloc_aligned", "NRT_MemInfo_call_dtor"})


def _codes(kind: Type) -> tuple[int, ...]:
    if isinstance(kind, Tuple):
        return bridge.codes_of([_codes(item) for item in kind.items])
    if isinstance(kind, Array):
        return bridge.array_codes(_DTYPES[kind.code], kind.axes)
    return (_CODES[kind.code],)
