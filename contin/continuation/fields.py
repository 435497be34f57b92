"""The fields of a discretised partial differential equation at a row or point of a branch."""

from __future__ import annotations

from collections.abc import Callable, Mapping

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


def has_fields(problem: object) -> bool:
    """True where `fields_of` gives fields."""
    return hasattr(getattr(getattr(problem, "system", None), "model", None), "profile")
