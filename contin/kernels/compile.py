"""How kernels are compiled: the `kernel` decorator, its cache folder, and calls through function pointers.

numba's own cache looks only at the file of the decorated function: edit a callee in another file and the old machine
code still runs. So the cache lives in a folder whose name is a hash of *all* kernel sources, the versions of numba,
llvmlite and numpy, and the processor; an edit anywhere in the package starts a fresh folder.
"""

from __future__ import annotations

import hashlib
import os
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

import llvmlite
import numba
import numpy as np
from llvmlite import binding, ir
from numba import types
from numba.core import cgutils, event
from numba.core.caching import _CacheLocator
from numba.core.compiler_lock import global_compiler_lock
from numba.extending import intrinsic

from contin.kernels.clock import CLOCK
from contin.kernels.turns import WAITING, turn


def user_cache_folder() -> Path:
    """The platform's cache folder for contin; `CONTIN_CACHE_DIR` overrides it."""
    chosen = os.environ.get("CONTIN_CACHE_DIR")
    if chosen:
        return Path(chosen)
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA", Path.home() / "AppData" / "Local"))
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Caches"
    else:
        base = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache"))
    return base / "contin"


def fingerprint(sources: Path) -> str:
    """Hash of every kernel source below `sources`, the compiler's versions and the processor."""
    digest = hashlib.sha256()
    for path in sorted(sources.rglob("*.py")):
        digest.update(path.name.encode())
        digest.update(path.read_bytes())
    features = sorted(name for name, present in binding.get_host_cpu_features().items() if present)
    for text in (numba.__version__, llvmlite.__version__, np.__version__, sys.version, binding.get_host_cpu_name()):
        digest.update(text.encode())
    digest.update(",".join(features).encode())
    return digest.hexdigest()[:20]


@cache
def kernel_cache_folder() -> str:
    """Folder of this version's compiled kernels; a temporary one where the user's cache cannot be written."""
    name = "kernels-" + fingerprint(Path(__file__).parent)
    for base in (
        user_cache_folder(),
        Path(tempfile.gettempdir()) / f"contin-{os.getuid() if hasattr(os, 'getuid') else 0}",
    ):
        folder = base / name
        try:
            folder.mkdir(parents=True, exist_ok=True, mode=0o700)
            probe = folder / f".write-{os.getpid()}"
            probe.touch()
            probe.unlink()
        except OSError:
            continue
        return str(folder)
    return tempfile.mkdtemp(prefix="contin-kernels-")


@contextmanager
def telling(tell: Callable[[str], None]) -> Iterator[None]:
    """Call `tell` with the name of its module whenever a kernel begins to be compiled, here or by another process."""

    class Listener(event.Listener):  # type: ignore[misc]  # numba has no types
        def on_start(self, event: Any) -> None:
            if CLOCK.depth == 1:  # not a kernel that another one calls
                tell(event.data["dispatcher"].py_func.__module__)

        def on_end(self, event: Any) -> None:
            pass

    with event.install_listener("numba:compile", Listener()), event.install_listener(WAITING, Listener()):
        yield


class ByContent(_CacheLocator):  # type: ignore[misc]  # numba has no types
    """Where a kernel is kept: the folder's name is the hash of all sources, so paths and dates say nothing."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self._module = function.__module__

    def get_cache_path(self) -> str:
        return kernel_cache_folder()

    def get_source_stamp(self) -> int:
        return 0

    def get_disambiguator(self) -> str:
        return hashlib.sha256(self._module.encode()).hexdigest()[:8]

    @classmethod
    def from_function(cls, function: Callable[..., Any], _file: str) -> ByContent:
        return cls(function)


FAST = {"contract", "reassoc", "nsz"}


def _compiled(function: Callable[..., Any], **options: Any) -> Any:
    """A dispatcher with its cache in our folder and, whatever constants a caller writes, one signature.

    Compiling and loading it does not count as computing time.
    """
    before = numba.config.CACHE_LOCATOR_CLASSES
    numba.config.CACHE_LOCATOR_CLASSES = f"{__name__}.{ByContent.__name__}"
    try:
        dispatcher = numba.njit(cache=True, nogil=True, error_model="numpy", **options)(function)
    finally:
        numba.config.CACHE_LOCATOR_CLASSES = before
    load, template_of = dispatcher.compile, dispatcher.get_call_template

    name = f"{function.__module__}.{function.__qualname__}"

    def compile_(signature: Any) -> Any:
        if dispatcher.signatures:
            return load(signature)
        with CLOCK.standing(), global_compiler_lock, turn(kernel_cache_folder(), name, dispatcher):
            return load(signature)

    def get_call_template(args: Sequence[types.Type], kws: Mapping[str, types.Type]) -> Any:
        return template_of([types.unliteral(a) for a in args], {name: types.unliteral(a) for name, a in kws.items()})

    dispatcher.compile = compile_
    dispatcher.get_call_template = get_call_template  # numba compiles a function anew for every constant argument
    return dispatcher


def kernel(function: Callable[..., Any]) -> Any:
    """Compile on first call, without the interpreter lock, cached on disk. Every kernel has exactly one signature.

    Its memory comes from the caller: a kernel makes no arrays. Counting references to them makes machine code, and the
    time to compile it, several times larger; `allocating` is for those that need it.
    """
    return _compiled(function, _nrt=False)


def allocating(function: Callable[..., Any]) -> Any:
    """A kernel that makes arrays of its own."""
    return _compiled(function, _nrt=True)  # said outright: numba would take it over from the first caller


def vector_kernel(function: Callable[..., Any]) -> Any:
    """A kernel whose sums may be reordered and whose products be fused with them: its loops become vector instructions.

    Only for plain linear algebra. Loops over unsigned ranges, `range(np.uint64(a), np.uint64(b))`: for a signed index
    numba tests whether it counts from the end, and with that test no loop is vectorised.
    """
    return _compiled(function, fastmath=FAST, _nrt=False)


def allocating_vector_kernel(function: Callable[..., Any]) -> Any:
    """... that makes arrays of its own."""
    return _compiled(function, fastmath=FAST, _nrt=True)


def part(function: Callable[..., Any]) -> Any:
    """A part of one kernel: put in place where it is called, not compiled by itself.

    numba optimises the machine code of every callee again in each caller, so a tower of kernels is compiled as many
    times as it has storeys; parts keep the tower low.
    """
    return numba.njit(inline="always", error_model="numpy")(function)


def _pointer_call(count: int) -> Any:
    """Intrinsic that calls the machine code at an address with the data pointers of `count` float64 arrays."""
    byte_pointer = ir.IntType(8).as_pointer()

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        function_type = ir.FunctionType(ir.VoidType(), [byte_pointer] * count)
        function = builder.inttoptr(args[0], function_type.as_pointer())
        pointers = []
        for array_type, array in zip(signature.args[1:], args[1:], strict=True):
            data = cgutils.create_struct_proxy(array_type)(context, builder, array).data
            pointers.append(builder.bitcast(data, byte_pointer))
        builder.call(function, pointers)
        return context.get_dummy_value()

    return codegen


@intrinsic
def call3(typing_context: Any, address: Any, a: Any, b: Any, c: Any) -> Any:
    """Call `void f(double*, double*, double*)` at `address`."""
    return types.void(types.intp, a, b, c), _pointer_call(3)


@intrinsic
def call4(typing_context: Any, address: Any, a: Any, b: Any, c: Any, d: Any) -> Any:
    """Call `void f(double*, double*, double*, double*)` at `address`."""
    return types.void(types.intp, a, b, c, d), _pointer_call(4)


@intrinsic
def call5(typing_context: Any, address: Any, a: Any, b: Any, c: Any, d: Any, e: Any) -> Any:
    """Call `void f(double*, ...)` with five pointers at `address`."""
    return types.void(types.intp, a, b, c, d, e), _pointer_call(5)


@intrinsic
def call6(typing_context: Any, address: Any, a: Any, b: Any, c: Any, d: Any, e: Any, f: Any) -> Any:
    """Call `void f(double*, ...)` with six pointers at `address`."""
    return types.void(types.intp, a, b, c, d, e, f), _pointer_call(6)
