"""What numba's compiler leaves out for kernels changes no line of their code."""

import subprocess
import sys

import pytest

COMPARE = """
import re
from numba.core import ir, types, utils
from numba.core.base import BaseContext
from numba.core.postproc import PostProcessor

numbas = ir.Inst._rec_list_vars, PostProcessor.run, types.Function.get_call_type
tables = BaseContext.refresh, BaseContext.get_abi_sizeof, utils.order_by_target_specificity

from importlib import import_module
from contin.kernels import mode
from contin.kernels.building.functions import REGISTRY, NumbaCompiler

mode.compiler = NumbaCompiler()
from numba.core.typed_passes import NopythonRewrites
from contin.kernels.building import lean
from contin.kernels.building.emit import translate


def text(name):
    return re.sub(r"NumbaEnv\\w+", "", translate(REGISTRY[name]).text)  # names count what was translated before


names = "dense.lu_factor", "grading.grade", "eigen.hessenberg", "collocation._product"
for name in names:
    import_module("contin.kernels." + name.partition(".")[0])
ours = [text(name) for name in names]
assert len(ours) == len(names)

ir.Inst._rec_list_vars, PostProcessor.run = numbas[:2]
BaseContext.refresh, BaseContext.get_abi_sizeof, utils.order_by_target_specificity = tables
at = lean.PASSES.index(lean.IRLegalization)
lean.PASSES = (*lean.PASSES[:at], NopythonRewrites, *lean.PASSES[at:])
print([one == text(name) for name, one in zip(names, ours)], *map(len, ours))
"""


def test_what_numba_does_between_passes_and_looks_up_again_changes_no_line():
    pytest.importorskip("numba")
    done = subprocess.run([sys.executable, "-c", COMPARE], capture_output=True, text=True, check=True)
    same, _, sizes = done.stdout.strip().rpartition("] ")
    assert same == "[True, True, True, True"
    assert min(map(int, sizes.split())) > 1000
