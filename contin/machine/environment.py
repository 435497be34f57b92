"""What numpy, scipy and the libraries under them choose by the processor, fixed before they are loaded.

OpenBLAS and MKL have kernels for each processor, numpy has loops for each vector width: their last digits differ, and
with threads they depend on how many there are. So the command `contin` gives all of them one level, that of
`contin.machine.target`, and one thread, whatever the environment says. They read it once, when numpy is imported;
in a process that imported numpy before, nothing can be fixed any more.
"""

from __future__ import annotations

import ctypes
import os
import platform
import sys
from typing import Final

from contin.machine import target

THREADS: Final = (
    "OMP_NUM_THREADS OPENBLAS_NUM_THREADS GOTO_NUM_THREADS MKL_NUM_THREADS BLIS_NUM_THREADS VECLIB_MAXIMUM_THREADS"
).split()

ABOVE_V3: Final = (
    "X86_V4 AVX512F AVX512CD AVX512_KNL AVX512_KNM AVX512_SKX AVX512_CLX AVX512_CNL AVX512_ICL AVX512_SPR"
).split()
ABOVE_V2: Final = ["X86_V3", "AVX", "F16C", "FMA3", "FMA4", "XOP", "AVX2", *ABOVE_V3]
ABOVE_ARMV8: Final = "ASIMDHP ASIMDDP ASIMDFHM SVE".split()

LIBRARIES: Final = {
    "x86-64-v3": ("Haswell", "AVX2", ABOVE_V3),
    "x86-64-v2": ("Nehalem", "SSE4_2", ABOVE_V2),
    "x86-64": ("Prescott", "COMPATIBLE", ABOVE_V2),
    "aarch64": ("ARMV8", "COMPATIBLE", ABOVE_ARMV8),
}
"""For each level: OpenBLAS's core type, MKL's branch, and the loops that numpy must not choose."""

AVX2, FMA, OSXSAVE = 1 << 5, 1 << 12, 1 << 27  # bits of cpuid: leaf 7 ebx, leaf 1 ecx, leaf 1 ecx

_state = {"fixed": False}
_given = os.environ.get("OMP_NUM_THREADS", "")


def fix() -> None:
    """Set the environment of this process; without effect once numpy is there."""
    if "numpy" in sys.modules:
        return
    for name in THREADS:
        os.environ[name] = "1"
    os.environ["OMP_DYNAMIC"] = os.environ["MKL_DYNAMIC"] = "FALSE"
    _state["fixed"] = True
    level = _level()
    if level in LIBRARIES and sys.platform != "darwin":
        core, branch, disabled = LIBRARIES[level]
        os.environ["OPENBLAS_CORETYPE"] = core
        os.environ["MKL_CBWR"] = branch
        os.environ["NPY_DISABLE_CPU_FEATURES"] = ",".join(disabled)
        os.environ.pop("NPY_ENABLE_CPU_FEATURES", None)


def fixed() -> bool:
    """Whether numpy and the libraries under it were loaded with one level and one thread."""
    return _state["fixed"]


def asked() -> int | None:
    """The number of threads in the environment's OMP_NUM_THREADS before anything was fixed; None where it has none."""
    return max(1, int(_given)) if _given.isdigit() else None


def _level() -> str:
    """The level of `target.name()`, found without loading LLVM where that is possible."""
    wanted = os.environ.get("CONTIN_TARGET", "")
    if platform.machine().lower() not in ("x86_64", "amd64"):
        return target.name()
    if wanted in ("x86-64-v2", "x86-64"):  # which every machine has that numpy's wheels run on
        return wanted
    try:
        leaf = ctypes.CDLL(None).__x86_get_cpuid_feature_leaf  # glibc, since 2.33
    except (AttributeError, OSError, TypeError):
        return target.name()
    leaf.restype, leaf.argtypes = ctypes.POINTER(ctypes.c_uint * 8), [ctypes.c_uint]
    # eax, ebx, ecx, edx of leaves 1 and 7: what the processor has, not what glibc's tunables leave of it
    first, seventh = leaf(0).contents, leaf(1).contents
    modern = first[2] & FMA and first[2] & OSXSAVE and seventh[1] & AVX2
    return "x86-64-v3" if modern and wanted in ("", "x86-64-v3") else target.name()
