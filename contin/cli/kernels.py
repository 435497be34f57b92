"""`contin kernels`: the machine code of the numerical kernels, where it is, and making it beforehand."""

from __future__ import annotations

from contin.errors import InputError
from contin.kernels import sources
from contin.kernels.catalogue import every
from contin.kernels.library import complete, known, module_of
from contin.machine import packed, target
from contin.machine.folder import COMPILED, DERIVED, MACHINE_CODE, folder, place

ACTIONS = ("status", "build", "clear", "where")


def kernels(action: str) -> int:
    """Carry out one of the actions."""
    actions = {"status": _status, "build": _build, "clear": _clear, "where": _where}
    if action not in actions:
        raise InputError(f"contin kernels {action}: write one of {', '.join(ACTIONS)}")
    actions[action]()
    return 0


def _status() -> None:
    declared = every()
    shipped = [n for n, d in declared.items() if packed.find(n, sources.text_key(module_of(d))) is not None]
    present = [n for n, d in declared.items() if n in shipped or known(d) is not None]
    made_by = ", ".join(f"{name} {version}" for name, version in sources.versions().items())
    print(f"target      {target.label()}")
    print(f"kernels     {len(declared)}: {len(shipped)} came with contin, {len(present) - len(shipped)} made here")
    print(f"missing     {len(declared) - len(present)}, made when they are first needed, or by `contin kernels build`")
    print(f"made with   {made_by}")
    _where()


def _build() -> None:
    print(f"{len(complete(every()))} kernels are there")


def _clear() -> None:
    removed = 0
    for kept in (folder(MACHINE_CODE), folder(DERIVED), folder(COMPILED)):
        for name in kept.names() if kept else []:
            if kept:
                kept.remove(name)
                removed += 1
    print(f"removed {removed} files")


def _where() -> None:
    kept = folder()
    print(f"kept in     {kept.path if kept else f'memory alone ({place()} is not a folder of this user alone)'}")
    archive = packed.path(target.label())
    print(f"came with   {archive if archive.is_file() else 'nothing: this is no wheel that holds machine code'}")
