"""Object files of models, by the text they are made from: in this process, and in the user's folder for the next one.

The same few models are lowered again and again, in the runs of a file and in tests. Compiling takes most of the time of
lowering. Files are checked as those of kernels are (`contin.machine.objects`); one that is not what it should be is
made anew.
"""

from __future__ import annotations

import hashlib
import time
from collections import OrderedDict
from collections.abc import Callable
from typing import Final

from contin.machine import objects, progress, target
from contin.machine.folder import COMPILED, folder
from contin.machine.objects import MachineCode

MOST: Final = 300  # object files in memory
MOST_FILES: Final = 10_000  # 75 MB; the tests alone make 3,000, and the first are the first to go
LARGEST: Final = 200_000  # bytes of one that is kept
WORTH_KEEPING: Final = 0.005  # seconds of compiling
EVERY: Final = 40  # files after which the oldest are looked for

_known: OrderedDict[str, bytes] = OrderedDict()
_written = 0


def object_of(text: str, level: int, make: Callable[[], bytes]) -> bytes:
    """The object file of a module of LLVM assembly, optimised at this level, or `make()` where it is not known."""
    key = _key(text, level)
    code = _known.pop(key, None) or _read(key)
    if code is None:
        began = time.process_time()
        code = make()
        if time.process_time() - began > WORTH_KEEPING and len(code) <= LARGEST:
            _keep(key, code)
    if len(code) <= LARGEST:
        _known[key] = code
    if len(_known) > MOST:
        _known.popitem(last=False)
    return code


def _key(text: str, level: int) -> str:
    import llvmlite

    made_with = f"{llvmlite.__version__}\n{target.label()}\n{level}\n"
    return hashlib.sha256((made_with + text).encode()).hexdigest()


def _read(key: str) -> bytes | None:
    place = folder(COMPILED)
    data = place.read(key[:32]) if place else None
    if place is None or data is None:
        return None
    machine_code = objects.from_bytes(data)
    if machine_code is None or machine_code.key != key:
        progress.note(f"{place.path / key[:32]} was damaged: it is made anew")
        place.remove(key[:32])
        return None
    return machine_code.code


def _keep(key: str, code: bytes) -> None:
    global _written
    place = folder(COMPILED)
    if place is not None and place.write(key[:32], objects.to_bytes(MachineCode("model", key, (), code))):
        _written += 1
        if (_written - 1) % EVERY == 0:
            place.thin_out(MOST_FILES)
