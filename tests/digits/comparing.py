"""Runs of the command in processes of their own, under other choices of processor, threads and hashes."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
RUNS = [ROOT / "examples" / "metronome-pair.yaml", *sorted((Path(__file__).parent / "runs").glob("*.yaml"))]

NO_FMA = "glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2,-AVX2_Usable,-FMA_Usable,-AVX512F,-AVX512VL"
CHOICES: dict[str, dict[str, str]] = {
    "as it is": {},
    "eight threads": dict.fromkeys(["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"], "8"),
    "two threads": dict.fromkeys(["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"], "2"),
    "OpenBLAS for Zen": {"OPENBLAS_CORETYPE": "Zen"},
    "OpenBLAS for Haswell": {"OPENBLAS_CORETYPE": "Haswell"},
    "OpenBLAS for SkylakeX": {"OPENBLAS_CORETYPE": "SkylakeX"},
    "OpenBLAS for Nehalem": {"OPENBLAS_CORETYPE": "Nehalem"},
    "numpy without AVX-512": {"NPY_DISABLE_CPU_FEATURES": "X86_V4,AVX512_ICL,AVX512_SPR"},
    "numpy without AVX2": {"NPY_DISABLE_CPU_FEATURES": "X86_V3,X86_V4,AVX512_ICL,AVX512_SPR"},
    "libc without FMA": {"GLIBC_TUNABLES": NO_FMA},
    "hashes 1": {"PYTHONHASHSEED": "1"},
    "hashes 2": {"PYTHONHASHSEED": "2"},
    "everything": {
        "OMP_NUM_THREADS": "8",
        "OPENBLAS_NUM_THREADS": "8",
        "OPENBLAS_CORETYPE": "Nehalem",
        "NPY_DISABLE_CPU_FEATURES": "X86_V3,X86_V4,AVX512_ICL,AVX512_SPR",
        "GLIBC_TUNABLES": NO_FMA,
        "PYTHONHASHSEED": "3",
    },
}


def unfixed() -> dict[str, str]:
    """The environment without what `tests/conftest.py` fixed in it: another processor chooses for itself."""
    chosen = ("OPENBLAS_CORETYPE", "MKL_CBWR", "NPY_DISABLE_CPU_FEATURES")
    return {k: v for k, v in os.environ.items() if k not in chosen and not k.endswith("NUM_THREADS")}


def results(run: Path, environment: Mapping[str, str], folder: Path, python: Sequence[str] = (sys.executable,)) -> str:
    """The results of a run as text, times left out; AssertionError with what the command said where it failed."""
    copy = Path(shutil.copy(run, folder))  # its outputs are written beside it
    out = folder / "results.json"
    ended = subprocess.run(
        [*python, "-m", "contin", "run", str(copy), "--json", str(out), "--quiet"],
        env={**unfixed(), "PYTHONPATH": str(ROOT), **environment}, cwd=folder,
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert ended.returncode in (0, 1), ended.stderr
    return without_times(json.loads(out.read_text(encoding="utf-8")))


def without_times(document: dict[str, Any]) -> str:
    """The document as text without what differs between two runs of one machine."""
    kept = {key: value for key, value in document.items() if key not in ("timing", "sha256")}
    kept["branches"] = [{k: v for k, v in branch.items() if k != "seconds"} for branch in document["branches"]]
    return json.dumps(kept, indent=0)


def first_difference(a: str, b: str) -> str:
    """Where two results differ, for a person to read."""
    for k, (x, y) in enumerate(zip(a.splitlines(), b.splitlines(), strict=False)):
        if x != y:
            return f"line {k}: {x!r} and {y!r}"
    return f"{len(a)} and {len(b)} characters"
