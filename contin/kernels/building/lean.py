"""numba's compiler without what kernels do not need: half of the time to compile them is its own Python.

Passes are left out that change nothing in functions without closures, `with`, generators, literal arguments and
arithmetic of whole arrays; lifetimes of variables are found once, before lowering, not after every pass; types of
operations on numbers, sizes of types and orders of templates are looked up once a process. The code is the same; where
a number and a literal of its type took two copies of a numba function, they share one.
"""

from __future__ import annotations

import sys
from typing import Any

from numba.core import ir, ssa, types, utils
from numba.core.base import BaseContext
from numba.core.compiler import CompilerBase
from numba.core.compiler_machinery import PassManager
from numba.core.imputils import lower_builtin
from numba.core.postproc import PostProcessor
from numba.core.transforms import canonicalize_cfg
from numba.core.typed_passes import (
    IRLegalization,
    NativeLowering,
    NoPythonBackend,
    NopythonTypeInference,
    PreLowerStripPhis,
)
from numba.core.types.misc import unliteral
from numba.core.typing import signature, templates
from numba.core.untyped_passes import (
    DeadBranchPrune,
    FixupArgs,
    GenericRewrites,
    InlineInlinables,
    IRProcessing,
    ReconstructSSA,
    RewriteSemanticConstants,
    TranslateByteCode,
)

PASSES = (
    TranslateByteCode, FixupArgs, IRProcessing, RewriteSemanticConstants, GenericRewrites, InlineInlinables,
    ReconstructSSA, DeadBranchPrune, NopythonTypeInference, PreLowerStripPhis, IRLegalization,
    NativeLowering, NoPythonBackend,
)  # fmt: skip


class LeanCompiler(CompilerBase):  # type: ignore[misc,unused-ignore]  # numba has no types
    """The passes of `numba.core.compiler.Compiler` that kernels need."""

    def define_pipelines(self) -> list[Any]:
        manager = PassManager("lean")
        for one in PASSES:
            manager.add_pass(one, one.__name__)
        manager.finalize()
        return [manager]


def _chosen(builder: Any, args: Any, compare: Any) -> Any:
    """The first number, or a later one that compares with what was chosen before: as numba does, and Python."""
    result = args[0]
    for value in args[1:]:
        result = builder.select(compare(builder, value, result), value, result)
    return result


def _larger(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    if isinstance(sig.return_type, types.Float):
        return _chosen(builder, args, lambda b, v, r: b.fcmp_ordered(">", v, r))
    return _chosen(builder, args, lambda b, v, r: b.icmp_signed(">", v, r))


def _smaller(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    if isinstance(sig.return_type, types.Float):
        return _chosen(builder, args, lambda b, v, r: b.fcmp_ordered("<", v, r))
    return _chosen(builder, args, lambda b, v, r: b.icmp_signed("<", v, r))


_OWN = {max: "contin.max", min: "contin.min"}
for _kind in (types.Float, types.Integer):
    for _count in (2, 3, 4):
        lower_builtin("contin.max", *[_kind] * _count)(_larger)
        lower_builtin("contin.min", *[_kind] * _count)(_smaller)


def _of_like_numbers(self: Any, args: Any) -> Any:
    """The signature of min and max of several float64 or int64, which numba would compile a function for."""
    plain = [unliteral(a) for a in args]
    if not (2 <= len(plain) <= 4 and plain[0] in (types.float64, types.int64) and all(p == plain[0] for p in plain)):
        return None
    found = signature(plain[0], *plain)
    self._impl_keys[found.args] = _OWN[self.typing_key]
    return found


_PLAIN = (types.Integer, types.Float, types.Boolean, types.Complex, types.IntegerLiteral)
_known: dict[Any, Any] = {}
_original = types.Function.get_call_type


def _get_call_type(self: Any, context: Any, args: Any, kws: Any) -> Any:
    """In place of numba's: types of a builtin function of numbers are known from an earlier call with the same ones."""
    if kws or not all(isinstance(a, _PLAIN) for a in args):
        return _original(self, context, args, kws)
    key = (self, args)
    found = _known.get(key) or (_of_like_numbers(self, args) if self.typing_key in _OWN else None)
    if found is None:
        found = _known[key] = _original(self, context, args, kws)
    return found


_LEAVES = (str, int, float, bool, complex, type(None), ir.Loc)
_VARIABLE, _INSTRUCTION, _SEQUENCE, _TABLE, _LEAF = range(5)
_sorts: dict[type, int] = dict.fromkeys(_LEAVES, _LEAF)


def _sort(kind: type) -> int:
    """What numba's IR may hold variables in."""
    kinds = ((ir.Var, _VARIABLE), (ir.Inst, _INSTRUCTION), ((list, tuple), _SEQUENCE), (dict, _TABLE))
    found = _sorts[kind] = next((sort for known, sort in kinds if issubclass(kind, known)), _LEAF)
    return found


def _variables(self: Any, value: Any) -> list[Any]:
    """In place of numba's: the variables in a statement, in order. It is asked for a million times."""
    kind = type(value)
    sort = _sorts.get(kind)
    if sort is None:
        sort = _sort(kind)
    if sort == _LEAF:
        return []
    if sort == _VARIABLE:
        return [value]
    if sort == _INSTRUCTION:
        return list(value.list_vars())
    found: list[Any] = []
    for item in value.values() if sort == _TABLE else value:
        kind = type(item)
        sort = _sorts.get(kind)
        if sort == _VARIABLE:
            found.append(item)
        elif sort != _LEAF:
            found += _variables(self, item)
    return found


_whole = PostProcessor.run


def _needed(self: Any, emit_dels: bool = False, extend_lifetimes: bool = False) -> None:
    """In place of numba's: between passes only the graph of blocks is made anew: the next one reads no more."""
    if emit_dels or self.func_ir.is_generator:
        _whole(self, emit_dels, extend_lifetimes)
    else:
        self.func_ir.blocks = canonicalize_cfg(self.func_ir.blocks)


def _registered(context: BaseContext) -> tuple[int, ...]:
    """How much numba could have been told of since it looked last: modules, and entries of all its tables."""
    typed = templates.builtin_registry
    lowered = sum(
        len(table)
        for one in context._registries
        for table in (one.functions, one.getattrs, one.setattrs, one.casts, one.constants)
    )
    return len(sys.modules), len(typed.functions), len(typed.attributes), len(typed.globals), lowered


_refresh = BaseContext.refresh
_seen: dict[int, tuple[int, ...]] = {}


def _refresh_if_new(self: Any) -> None:
    """In place of numba's: it goes through all its tables whenever a function's first name for an operation is none.

    What is known stands in one table, which the contexts of all kernels share; they themselves come and go. What is
    registered while the tables are gone through is not in it yet: the next question goes through them again.
    """
    state = _registered(self)
    if _seen.get(id(self._defns)) != state:
        _refresh(self)
        _seen[id(self._defns)] = state


_sizes: dict[str, int] = {}
_size_of = BaseContext.get_abi_sizeof


def _get_abi_sizeof(self: Any, kind: Any) -> Any:
    """In place of numba's, which has LLVM read a module for every question; the answer is that of one layout."""
    name = str(kind)
    if "%" in name:  # a type with a name, whose members may not be known yet
        return _size_of(self, kind)
    known = _sizes.get(name)
    if known is None:
        known = _sizes[name] = _size_of(self, kind)
    return known


_order = utils.order_by_target_specificity
_orders: dict[Any, Any] = {}


def _ordered(target: Any, found: Any, fnkey: Any = "") -> Any:
    """In place of numba's: the order of a function's templates is known from its last call."""
    key = (target, tuple(found))
    known = _orders.get(key)
    if known is None:
        known = _orders[key] = _order(target, found, fnkey)
    return known


class _Silent:
    """In place of the log of numba's form of single assignment, to which every statement is told."""

    def debug(self, *_: object) -> None: ...


ssa._logger = _Silent()  # type: ignore[assignment,unused-ignore]
BaseContext.refresh = _refresh_if_new  # type: ignore[method-assign,unused-ignore]
BaseContext.get_abi_sizeof = _get_abi_sizeof  # type: ignore[method-assign,unused-ignore]
utils.order_by_target_specificity = _ordered
ir.Inst._rec_list_vars = _variables  # type: ignore[method-assign,unused-ignore]
PostProcessor.run = _needed  # type: ignore[method-assign,unused-ignore]
types.Function.get_call_type = _get_call_type  # type: ignore[method-assign,unused-ignore]
