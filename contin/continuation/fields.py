"""The fields of a discretised partial differential equation at a row or point of a branch."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from contin.abi import Array
from contin.errors import InputError

Fields = dict[str, Array]
"""The coordinates of each axis (points,), and each field on the grid, (points,) or (points, points)."""


def fields_of(problem: object, z: Array, values: Mapping[str, float], where: str) -> Fields:
    """The fields that z stands for, at the parameters in `values`; InputError where there are none."""
    system = getattr(problem, "system", None)
    profile: Callable[[Array, Mapping[str, float]], Fields] | None = getattr(
        getattr(system, "model", None), "profile", None
    )
    if system is None or profile is None:
        raise InputError(f"{where} has no fields: they are at the rows and points of models of kind: pde")
    return profile(z[: system.n], {name: float(values[name]) for name in system.parameter_names})


def fields_along(problem: Any, rows: Array, values: Mapping[str, float]) -> Fields:
    """The coordinates, and each field at several states `rows` (K, n): (K, points) or (K, points, points)."""
    p = {name: float(values[name]) for name in problem.system.parameter_names}
    found = [problem.system.model.profile(row, p) for row in rows]
    axes = problem.system.model.axes
    return {name: x if name in axes else np.array([f[name] for f in found]) for name, x in found[0].items()}


def has_fields(problem: object) -> bool:
    """True where `fields_of` gives fields."""
    return hasattr(getattr(getattr(problem, "system", None), "model", None), "profile")
