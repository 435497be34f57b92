"""Calls of a user's functions: what goes wrong inside is said in words, with the line of the user's file."""

from __future__ import annotations

import traceback
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from contin.abi import Vector
from contin.errors import UserFunctionError


def called(what: str, function: Callable[..., Any], *arguments: object) -> Any:
    """function(*arguments); UserFunctionError, which names the error and its line, where that raises."""
    try:
        with np.errstate(all="ignore"):  # what is not finite is told where it matters
            return function(*arguments)
    except Exception as error:  # somebody else's code may raise anything
        frames = traceback.extract_tb(error.__traceback__)[1:]  # the first is this one
        place = f" ({Path(frames[0].filename).name}, line {frames[0].lineno})" if frames else ""
        raise UserFunctionError(f"the {what} raised {type(error).__name__}: {error}{place}") from error


def vector(what: str, value: object, n: int) -> Vector:
    """`value` as an array (n,) of its own, for a function may fill one array again and again; UserFunctionError where
    it is something else."""
    array = np.array(value)
    if array.shape != (n,):
        raise UserFunctionError(
            f"the {what} must return {n} numbers, one for each state; got "
            + (f"shape {array.shape}" if array.dtype.kind in "biufc" else f"{type(value).__name__}")
        )
    if array.dtype.kind not in "biufc":
        raise UserFunctionError(f"the {what} must return numbers; got {array.dtype} entries")
    return array


def numbers(what: str, value: object) -> dict[str, float]:
    """`value`, a mapping of names to numbers, as one; UserFunctionError where it is something else."""
    if not isinstance(value, Mapping):
        raise UserFunctionError(f"{what} must return a mapping of names to numbers; got {type(value).__name__}")
    for name, entry in value.items():
        if not isinstance(name, str) or np.ndim(entry) != 0 or np.asarray(entry).dtype.kind not in "biuf":
            shown = f"shape {np.shape(entry)}" if np.ndim(entry) else repr(entry)
            raise UserFunctionError(f"{what} must return a mapping of names to numbers; {name!r} has {shown}")
    return {name: float(entry) for name, entry in value.items()}


def as_array(matrix: Any) -> Any:
    """A Jacobian as an array, also where the function gives it sparse or as products."""
    from scipy.sparse import issparse
    from scipy.sparse.linalg import LinearOperator

    if issparse(matrix):
        return matrix.toarray()
    return matrix @ np.eye(matrix.shape[1]) if isinstance(matrix, LinearOperator) else matrix
