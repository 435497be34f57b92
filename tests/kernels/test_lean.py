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


def lowered_elsewhere():
    # whether a function is found whose code is registered in another table than numba's own, after the last look
    from numba.core.imputils import builtin_registry
    from numba.core.registry import cpu_target
    from numba.core.typing import signature

    context = cpu_target.target_context
    context.refresh()
    other = next(one for one in context._registries if one is not builtin_registry)
    other.lower("elsewhere", types.float64)(lambda context, builder, sig, args: args[0])
    return context.get_function("elsewhere", signature(types.float64, types.float64)) is not None


def text(name):
    return re.sub(r"NumbaEnv\\w+", "", translate(REGISTRY[name]).text)  # names count what was translated before


names = "dense.lu_factor", "grading.grade", "eigen.hessenberg", "collocation._product"
for name in names:
    import_module("contin.kernels." + name.partition(".")[0])
found = lowered_elsewhere()
ours = [text(name) for name in names]
assert len(ours) == len(names)

ir.Inst._rec_list_vars, PostProcessor.run = numbas[:2]
BaseContext.refresh, BaseContext.get_abi_sizeof, utils.order_by_target_specificity = tables
at = lean.PASSES.index(lean.IRLegalization)
lean.PASSES = (*lean.PASSES[:at], NopythonRewrites, *lean.PASSES[at:])
print(found, [one == text(name) for name, one in zip(names, ours)], *map(len, ours), sep=";")
"""


@pytest.fixture(scope="module")
def compared():
    pytest.importorskip("numba")
    done = subprocess.run([sys.executable, "-c", COMPARE], capture_output=True, text=True, check=True)
    return done.stdout.strip().split(";")


def test_what_numba_does_between_passes_and_looks_up_again_changes_no_line(compared):
    _, same, *sizes = compared
    assert same == "[True, True, True, True]"
    assert min(map(int, sizes)) > 1000


def test_code_that_is_registered_in_any_table_after_the_last_look_is_found(compared):
    assert compared[0] == "True"
