"""Signatures as numba types."""

from __future__ import annotations

from typing import Any, Final

from numba import types

from contin.kernels.signature import Array, Scalar, Tuple, Type

SCALARS: Final = {
    "i": types.int64, "u": types.uint64, "f": types.float64, "b": types.boolean, "c": types.complex128,
}  # fmt: skip


def numba_type(kind: Type | None) -> Any:
    """The numba type of a value; of no result, `none`."""
    if kind is None:
        return types.none
    if isinstance(kind, Scalar):
        return SCALARS[kind.code]
    if isinstance(kind, Array):
        return types.Array(SCALARS[kind.code], kind.axes, "C")
    assert isinstance(kind, Tuple)
    items = [numba_type(item) for item in kind.items]
    if kind.kind is None:
        return types.Tuple(items)
    if len(set(items)) == 1:
        return types.NamedUniTuple(items[0], len(items), kind.kind)
    return types.NamedTuple(items, kind.kind)
