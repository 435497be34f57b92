"""The processor level that machine code is made for: one name a family of processors, not the one processor at hand.

The numbers of a run depend on the level (vector widths order some sums), so it is the same on all machines that have
it, and result files state it. `CONTIN_TARGET` chooses a lower level than the machine's, for tests and comparisons.
"""

from __future__ import annotations

import os
import platform
import sys
from functools import cache
from typing import Any, Final

from contin.errors import InputError

LEVELS: Final = {
    "x86-64-v3": "avx avx2 bmi bmi2 f16c fma lzcnt movbe xsave cx16 popcnt sahf sse4.2".split(),
    "x86-64-v2": "cx16 popcnt sahf sse4.2".split(),
    "x86-64": [],
}
"""x86-64 levels, best first, with LLVM's names of the features they need (System V ABI, 3.1.1)."""

MACHINES: Final = {"amd64": "x86-64", "x86_64": "x86-64", "arm64": "aarch64"}


@cache
def name() -> str:
    """Level that machine code is made for here: x86-64-v3 where the processor has it, else -v2; aarch64; and so on."""
    best = _of_this_machine()
    wanted = os.environ.get("CONTIN_TARGET", "")
    if not wanted or wanted == best:
        return best
    levels = list(LEVELS)
    if wanted not in levels or best not in levels or levels.index(wanted) < levels.index(best):
        possible = levels[levels.index(best) :] if best in levels else [best]
        raise InputError(f"CONTIN_TARGET: this machine runs code for {' or '.join(possible)}; got {wanted!r}")
    return wanted


def _of_this_machine() -> str:
    machine = platform.machine().lower()
    machine = MACHINES.get(machine, machine)
    if machine != "x86-64":
        return machine
    import llvmlite.binding as llvm

    has = llvm.get_host_cpu_features()
    return next(level for level, needed in LEVELS.items() if all(has.get(feature, False) for feature in needed))


def label() -> str:
    """`x86-64-v3-linux`, say: the level on this kind of system, after which files of machine code are named."""
    return f"{name()}-{sys.platform if sys.platform in ('linux', 'darwin', 'win32') else 'linux'}"


def processor() -> str:
    """LLVM's name of the processor to compile for."""
    return name() if name() in LEVELS else "generic"


def object_machine(triple: str = "", cpu: str = "", level: int = 3) -> Any:
    """LLVM's target machine for object files that are loaded anywhere in memory; for this process, or as said."""
    import llvmlite.binding as llvm

    if triple:
        llvm.initialize_all_targets()
        llvm.initialize_all_asmprinters()
    else:
        llvm.initialize_native_target()
        llvm.initialize_native_asmprinter()
    return llvm.Target.from_triple(triple or llvm.get_process_triple()).create_target_machine(
        cpu=cpu or processor(), features="", opt=level, reloc="static", codemodel="large", jit=True
    )


def machine(level: int) -> Any:
    """LLVM's target machine for this process at the fixed level, optimising at 0 to 3."""
    import llvmlite.binding as llvm

    return llvm.Target.from_default_triple().create_target_machine(cpu=processor(), features="", opt=level)
